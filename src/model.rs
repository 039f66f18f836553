//! Plain data of a simulation: particles, grid, groups, clock.

pub mod checkpoint;
pub mod clock;
pub mod column;
pub mod contact;
pub mod domain;
pub mod grid;
pub mod group;
pub mod lattice;
pub mod ledger;
pub mod particles;
pub mod rigid;
