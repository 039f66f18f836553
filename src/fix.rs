//! Fixes: what acts on particles or nodes during a step (language.md 6.6).

pub mod body_force;
pub mod check_solution;
pub mod components;
pub mod contact;
pub mod cuttingtool;
pub mod damping_local_nodes;
pub mod damping_nodes;
pub mod energy;
pub mod force_nodes;
pub mod indent;
pub mod initial_stress;
pub mod initial_velocity_nodes;
pub mod initial_velocity_particles;
pub mod push;
pub mod temperature_nodes;
pub mod temperature_particles;
pub mod velocity_nodes;
pub mod velocity_particles;

use crate::fault::Fault;
use crate::model::checkpoint::Checkpoint;
use crate::model::group::GroupId;
use crate::plan::Plan;
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::formula::Formula;
use crate::script::source::Span;
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::world::World;

/// Something that acts at one or more stages of each step.
pub trait Fix: Send {
    /// The stages at which it acts.
    fn stages(&self) -> &'static [Stage];

    /// What it needs of the scene.
    fn needs(&self, _plan: &mut Plan, _dimension: usize) {}

    /// Formulas it evaluates; the results they read are brought up to date before it acts.
    fn formulas(&self) -> Vec<&Formula> {
        Vec::new()
    }

    /// Acts once, at the start of the first run after its definition.
    ///
    /// # Errors
    /// A formula that is not finite.
    fn start(&mut self, _step: &mut Step<'_>) -> Result<(), Fault> {
        Ok(())
    }

    /// Acts at one stage.
    ///
    /// # Errors
    /// A formula that is not finite, or whatever stops the run.
    fn apply(&mut self, _stage: Stage, _step: &mut Step<'_>) -> Result<(), Fault> {
        Ok(())
    }

    /// The force per mass \[L/T^2\] of a constant field such as gravity.
    fn constant_acceleration(&self) -> Option<f64> {
        None
    }

    /// Particles it cannot act on, in words: for a warning where it is defined.
    fn passes_over(&self, _world: &World) -> Option<String> {
        None
    }

    /// Largest step \[T\] for which the forces of the last step are stable.
    fn largest_step(&self) -> f64 {
        f64::INFINITY
    }

    /// Puts into a checkpoint, or takes from it, what the steps so far have left in it.
    fn keep(&mut self, _checkpoint: &mut Checkpoint) {}

    /// The results `ID_x`, `ID_y`, `ID_z`, `ID_s`.
    fn results(&self, _world: &World) -> [f64; 4] {
        [0.0; 4]
    }
}

/// What kind of members a group has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupKind {
    /// The predefined `all`: particles and nodes.
    All,
    /// Particles.
    Particles,
    /// Nodes.
    Nodes,
}

/// What a fix or compute acts on.
#[derive(Clone, Debug)]
pub struct Target {
    /// ID of the fix or compute.
    pub id: String,
    /// The group.
    pub group: GroupId,
    /// Its kind.
    pub kind: GroupKind,
    /// Where its name stands in the script.
    pub span: Span,
    /// 1, 2 or 3.
    pub dimension: usize,
    /// Nodes have a temperature: heat is conducted.
    pub conducts_heat: bool,
    /// Numbers of the two solids of a fix that acts on solids, which has no group.
    pub solids: [usize; 2],
}

/// Does a fix act on two solids in place of a group?
pub fn acts_on_solids(style: &str) -> bool {
    style.starts_with("contact/")
}

impl Target {
    /// Refuses a group of a kind that the style cannot act on.
    ///
    /// # Errors
    /// The kind is not among the `allowed` ones.
    pub fn require(&self, style: &str, allowed: &[GroupKind]) -> Result<(), Diagnostic> {
        if allowed.contains(&self.kind) {
            return Ok(());
        }
        let word = |kind: &GroupKind| match kind {
            GroupKind::All => "`all`",
            GroupKind::Particles => "a group of particles",
            GroupKind::Nodes => "a group of nodes",
        };
        let wanted: Vec<&str> = allowed.iter().map(word).collect();
        Err(Diagnostic::error(
            Code::GroupKind,
            self.span,
            format!("`{style}` acts on {}", wanted.join(" or ")),
        )
        .label(format!("this is {}", word(&self.kind))))
    }
}

/// Builds a fix from its arguments.
pub type BuildFix = fn(&mut Args<'_>, &Target) -> Result<Box<dyn Fix>, Diagnostic>;

/// All fix styles.
pub const FIXES: &[Style<BuildFix>] = &[
    body_force::STYLE,
    force_nodes::STYLE,
    velocity_nodes::STYLE,
    velocity_particles::STYLE,
    initial_velocity_particles::STYLE,
    initial_velocity_nodes::STYLE,
    initial_stress::STYLE,
    energy::KINETIC,
    energy::STRAIN,
    check_solution::STYLE,
    temperature_nodes::STYLE,
    temperature_particles::STYLE,
    contact::hertz::STYLE,
    contact::minimize_penetration::STYLE,
    reserved("contact/minimize_penetration/plane", "", "contact with a plane"),
    cuttingtool::STYLE,
    indent::STYLE,
    reserved("indent/minimize_penetration", "", "an indenter without overlap"),
    damping_nodes::STYLE,
    damping_local_nodes::STYLE,
    reserved("neumann_bc_mech", "", "surface tractions"),
    reserved("convection_particles", "", "heat convection"),
    reserved("heat_flux_particles", "", "heat flux"),
    reserved("impenetrablesurface", "", "an impenetrable surface"),
    reserved("meldtool", "", "a meld tool"),
];

const fn reserved(
    name: &'static str,
    usage: &'static str,
    summary: &'static str,
) -> Style<BuildFix> {
    Style { name, usage, summary, manual: "", build: None }
}
