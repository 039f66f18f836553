//! Material point method simulator driven by Karamelo-style scripts.
//!
//! # Reading tour
//!
//! A script becomes statements and formulas in [`script`]. [`command`] reads each statement twice:
//! in the rehearsal, which finds all mistakes before anything happens, and when the script is
//! performed on a [`simulation::Simulation`]. Its loop over steps is in `simulation/run.rs`; one
//! step is the algorithm box of [`scheme::musl`]; the loops over particles and nodes behind it are
//! in [`kernel`], the laws in [`material`]. What leaves the program goes through [`output`]. Restart
//! files: the format in [`output::restart`], the state in `simulation/restart.rs`, the scene in
//! [`command::restart`].
//!
//! Styles are rows of tables ([`style`]): [`command::COMMANDS`], [`region::REGIONS`],
//! [`material::MATERIALS`] and the parts of a composite law ([`eos::EOS`], [`strength::STRENGTH`],
//! [`damage::DAMAGE`], [`temperature::TEMPERATURE`]), [`fix::FIXES`], [`compute::COMPUTES`],
//! [`output::DUMPS`]. A style is one file and one row.
//!
//! # Layers
//!
//! Each imports only to its left: math, fault, geometry -> script, parallel -> style -> model, region, shape ->
//! material -> world -> plan, step -> kernel -> fix, compute -> measure -> scheme -> output ->
//! simulation -> command, cli. `tests/layers.rs` fails on an arrow that runs back.
//!
//! # Symbols
//!
//! | symbol | meaning | dimension |
//! | --- | --- | --- |
//! | x, x0, v | position, reference position, velocity of a particle | L, L, L/T |
//! | m, V0, J | mass, reference volume, volume ratio det F | M, L^d, 1 |
//! | F, L | deformation gradient, velocity gradient | 1, 1/T |
//! | sigma (s11 ...) | Cauchy stress, positive in tension | P = M/(L T^2) |
//! | N, grad N | weight of a node at a particle and its gradient | 1, 1/L |
//! | v, v* | nodal velocity before and after the update | L/T |
//! | h, dt | cell size, time step | L, T |

pub mod cli;
pub mod command;
pub mod compare;
pub mod compute;
pub mod damage;
pub mod eos;
pub mod error;
pub mod fault;
pub mod fix;
pub mod geometry;
pub mod interrupt;
pub mod kernel;
pub mod material;
pub mod math;
pub mod measure;
pub mod memory;
pub mod method;
pub mod model;
pub mod output;
pub mod parallel;
pub mod plan;
pub mod region;
pub mod scheme;
pub mod script;
pub mod shape;
pub mod simulation;
pub mod step;
pub mod strength;
pub mod study;
pub mod style;
pub mod temperature;
pub mod time_step;
pub mod timing;
pub mod transfer;
pub mod verify;
pub mod watch;
pub mod world;
