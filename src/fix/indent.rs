//! A spherical indenter.

use super::push::{Numbers, Pushed, Thrust};
use super::{BuildFix, Fix, GroupKind, Target};
use crate::fault::Fault;
use crate::model::checkpoint::Checkpoint;
use crate::plan::Plan;
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::formula::Formula;
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::world::World;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "indent",
    usage: "sphere, K, x, y, z, R",
    summary: "a sphere pushes particles out",
    manual: "\
H1: particles with r < R from the centre are pushed outward with K (R - r)^2, K [M/(L T^2)], R > 0 [L].
Values may be formulas of time; coordinates beyond the dimension are ignored. Limits an adaptive dt
to 0.2 sqrt(m/k), k = 2 K (R - r).
Publishes the total force in ID_x, ID_y, ID_z and the work done so far in ID_s:
sum F.dx, dx the mean of the ways before and after, as in the energy ledger.
Old form: `indent, group, x, y, z, R, K`. Source: the fix of this name in LAMMPS.",
    build: Some(|args, target| {
        target.require("indent", &[GroupKind::Particles, GroupKind::All])?;
        Ok(Box::new(Indent::read(args, target)?))
    }),
};

/// K (R - r)^2 outward on particles with r < R.
pub struct Indent {
    id: String,
    dimension: usize,
    /// K, x, y, z, R.
    values: Numbers<5>,
    /// The same in the order x, y, z, R, K.
    old: bool,
    pushed: Pushed,
}

impl Indent {
    fn read(args: &mut Args<'_>, target: &Target) -> Result<Self, Diagnostic> {
        let old = args.peek() != Some("sphere") && args.remaining() == 5;
        let names = if old {
            let given: Vec<&str> = (0..5).map_while(|ahead| args.peek_at(ahead)).collect();
            let (stiffness, sphere) = (given[4], given[..4].join(", "));
            let modern =
                format!("fix({}, indent, group, sphere, {stiffness}, {sphere})", target.id);
            args.old_form(&modern);
            ["x", "y", "z", "R", "K"]
        } else {
            args.choice("a shape", &["sphere"])?;
            ["K", "x", "y", "z", "R"]
        };
        let span = args.next_span();
        let values = Numbers::read(args, &target.id, names)?;
        let (id, dimension) = (target.id.clone(), target.dimension);
        let indent = Self { id, dimension, values, old, pushed: Pushed::new(target.group) };
        if let Some(values) = indent.values.constants()
            && indent.ordered(values)[4] <= 0.0
        {
            let message = "the radius R of the indenter must be greater than 0";
            return Err(Diagnostic::error(Code::Range, span, message));
        }
        Ok(indent)
    }

    /// K, x, y, z, R.
    fn ordered(&self, values: [f64; 5]) -> [f64; 5] {
        match (self.old, values) {
            (true, [x, y, z, radius, stiffness]) => [stiffness, x, y, z, radius],
            (false, values) => values,
        }
    }
}

impl Fix for Indent {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::InitialIntegrate, Stage::FinalIntegrate]
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        Pushed::needs(plan, dimension);
    }

    fn formulas(&self) -> Vec<&Formula> {
        self.values.formulas()
    }

    fn apply(&mut self, stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        if stage == Stage::FinalIntegrate {
            self.pushed.work(step.world);
            return Ok(());
        }
        let values = self.values.now(step.board, &step.clock)?;
        let [stiffness, x, y, z, radius] = self.ordered(values);
        let (centre, dimension) = ([x, y, z], self.dimension);
        if radius <= 0.0 {
            return Err(Fault::run(format!(
                "fix `{}`: the radius of the indenter is {radius} at step {}, time {:.6e}",
                self.id, step.clock.step, step.clock.time
            )));
        }
        self.pushed.push(step.world, step.clock.dt, |world, p| {
            let mut away = [0.0; 3];
            let mut square = 0.0;
            for axis in 0..dimension {
                away[axis] = world.particles.position[p][axis] - centre[axis];
                square += away[axis] * away[axis];
            }
            // At the centre itself there is no outward.
            if !(square < radius * radius && square > 0.0) {
                return None;
            }
            let distance = square.sqrt();
            let depth = radius - distance;
            let force = stiffness * depth * depth;
            Some(Thrust {
                force: away.map(|a| force * a / distance),
                stiffness: 2.0 * stiffness * depth,
            })
        });
        Ok(())
    }

    fn largest_step(&self) -> f64 {
        self.pushed.largest_step()
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        self.pushed.keep(checkpoint);
    }

    fn results(&self, world: &World) -> [f64; 4] {
        self.pushed.results(&world.ranks)
    }
}
