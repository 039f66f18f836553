//! Problems with known answers: error and observed order, invariants, published numbers.
//!
//! Numbers and tolerances are those of the verification list; the reason for each tolerance
//! stands beside it. Every test also runs a broken variant and sees it fail.

mod axisymmetric;
mod axisymmetric_heat;
mod axisymmetric_waves;
mod bar;
mod cold_spray;
mod combinations;
mod contact;
mod convergence;
mod dam;
mod damping;
mod domains;
mod fields;
mod fixes;
mod gas;
mod granular;
mod heat;
mod hertz;
mod inputs;
mod invariants;
mod ledger;
mod locking;
mod machining;
mod manufactured;
mod mirror;
mod penetration;
mod rigid;
mod rolling;
mod scene;
mod script;
mod shapes;
mod shock;
mod taylor;
mod time_step;
mod tools;
mod two_disks;
mod upsetting;
mod vortex;
mod walls;
mod way;
