//! Owns all parts of a simulation and runs it.

mod agree;
mod alarm;
mod build;
mod describe;
pub mod fill;
mod fracture;
mod noise;
mod overlap;
mod progress;
mod rescue;
mod restart;
mod run;
mod setup;
mod trial;
mod units;

use crate::compute::Compute;
use crate::fix::Fix;
use crate::measure::{self, Captured};
use crate::model::clock::Clock;
use crate::model::contact::Contact;
use crate::output::Outputs;
use crate::plan::Plan;
use crate::scheme::{Loops, Scheme};
use crate::script::formula::{Board, Formula, Quantity};
use crate::script::history::History;
use crate::time_step::{Floor, Limit, TimeStep};
use crate::transfer::Transfer;
use crate::world::World;
use progress::Progress;
use rescue::Rescue;
pub use rescue::Watch;

/// When a run ends.
pub enum Until {
    /// After so many steps.
    Steps(u64),
    /// After so much more time \[T\]; the last step lands on the end.
    Time(f64),
    /// When the condition, tested before each step, is false.
    While(Formula),
    /// When the condition, tested before each step, is true.
    Condition(Formula),
}

/// Everything a simulation owns.
pub struct Simulation {
    /// Everything that has a place.
    pub world: World,
    /// Steps done, time now, size of the last step.
    pub clock: Clock,
    /// How particles take velocities from the grid.
    pub transfer: Transfer,
    /// Constant dt of `set_dt`, or `None`: adaptive.
    pub fixed_dt: Option<f64>,
    /// Factor on the adaptive dt.
    pub dt_factor: f64,
    /// What the scene needs.
    pub plan: Plan,
    /// Values of published quantities.
    pub board: Board,
    /// What each slot of the board holds.
    pub quantities: Vec<Quantity>,
    /// All fixes, in order of definition.
    pub fixes: Vec<(String, Box<dyn Fix>)>,
    /// All computes, in order of definition.
    pub computes: Vec<(String, Box<dyn Compute>)>,
    /// Log, dumps, figures.
    pub outputs: Outputs,
    scheme: &'static dyn Scheme,
    loops: Loops,
    captured: Captured,
    /// Fixes that have had their start.
    started: Vec<String>,
    /// Size of the coming step and what limits it.
    next: Option<TimeStep>,
    /// What limited the step just done.
    bound: Option<Limit>,
    floor: Floor,
    /// Copies and retries, if the script asks for them.
    pub watch: Option<Watch>,
    rescue: Rescue,
    /// The run has been warned that its energy ledger does not close.
    alarmed: bool,
    /// The run that the next one goes on with, unless something has changed since.
    progress: Option<Progress>,
    /// What has been performed, for restart files.
    pub history: History,
    /// Bits of particle groups given out so far.
    bits: usize,
    /// The user has asked some process to stop.
    pub interrupted: bool,
}

impl Simulation {
    /// Current value of a published quantity.
    pub fn measure(&self, quantity: &Quantity) -> f64 {
        measure::value(quantity, &self.world, &self.fixes, &self.computes, &self.captured)
    }

    /// Adds a fix, or replaces the one of that ID in place.
    pub fn add_fix(&mut self, id: &str, fix: Box<dyn Fix>) {
        self.started.retain(|name| name != id);
        match self.fixes.iter_mut().find(|(name, _)| name == id) {
            Some(known) => known.1 = fix,
            None => self.fixes.push((id.to_string(), fix)),
        }
    }

    /// Removes a fix.
    pub fn delete_fix(&mut self, id: &str) {
        self.fixes.retain(|(name, _)| name != id);
        self.started.retain(|name| name != id);
    }

    /// Adds a contact: its solids get velocities of their own.
    pub fn add_contact(&mut self, contact: Contact) {
        self.world.contacts.list.push(contact);
        self.world.grid.couples.clear();
    }

    /// Removes a contact.
    pub fn delete_contact(&mut self, id: &str) {
        self.world.contacts.list.retain(|contact| contact.name != id);
        self.world.grid.couples.clear();
    }

    /// Adds a compute.
    pub fn add_compute(&mut self, id: &str, compute: Box<dyn Compute>) {
        self.computes.push((id.to_string(), compute));
    }

    /// Removes a compute.
    pub fn delete_compute(&mut self, id: &str) {
        self.computes.retain(|(name, _)| name != id);
    }
}
