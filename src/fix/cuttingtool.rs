//! A wedge-shaped cutting tool.

use super::push::{Numbers, Pushed, Thrust};
use super::{BuildFix, Fix, GroupKind, Target};
use crate::fault::Fault;
use crate::model::checkpoint::Checkpoint;
use crate::model::column::Column;
use crate::plan::Plan;
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::formula::Formula;
use crate::step::{Stage, Step};
use crate::style::Style;
use crate::world::{Solid, World};
use std::f64::consts::FRAC_PI_2;

/// The row of the table.
pub const STYLE: Style<BuildFix> = Style {
    name: "cuttingtool",
    usage: "K, xT, yT, zT, vxT, vyT, vzT, xA, yA, xB, yB (or xT, yT, xA, yA, xB, yB)",
    summary: "a wedge between the lines TA and TB pushes particles out",
    manual: "\
H1. p1, p2 = signed distances of a particle to the lines TA and TB, positive on the side of the other
end point. Where both are >= 0 the particle is pushed along the outward normal of the face with the
smaller distance p. Eleven values: F = K G p (1 - D). Six values: F = (PI/2) G (1 + nu)/(1 - nu^2)
p^1.5, as printed in the paper (it lacks the root of a length). Values may be formulas of time; zT and
the velocity of the tip do not enter the force. In three dimensions the wedge reaches along z.
Limits an adaptive dt to 0.2 sqrt(m/k), k = dF/dp.
Publishes the total force in ID_x, ID_y, ID_z and the work done so far in ID_s:
sum F.dx, dx the mean of the ways before and after, as in the energy ledger.
Source: de Vaucorbeil et al. 2020, eqs 4.2 to 4.5.",
    build: Some(|args, target| {
        target.require("cuttingtool", &[GroupKind::Particles, GroupKind::All])?;
        if target.dimension == 1 {
            let message = "a cutting tool needs two or three dimensions";
            return Err(Diagnostic::error(Code::DimensionMismatch, args.span, message));
        }
        Ok(Box::new(CuttingTool::read(args, target)?))
    }),
};

/// The numbers of the wedge in the script.
enum Values {
    /// K and the tip, its velocity, A and B.
    Linear(Numbers<11>),
    /// The tip, A and B.
    Root(Numbers<6>),
}

/// The wedge at one time.
struct Shape {
    factor: Option<f64>,
    points: [[f64; 2]; 3],
}

impl Shape {
    /// The linear law: K, the tip, its velocity, A and B.
    fn linear([k, x, y, _, _, _, _, ax, ay, bx, by]: [f64; 11]) -> Self {
        Self { factor: Some(k), points: [[x, y], [ax, ay], [bx, by]] }
    }

    /// The law of the paper: the tip, A and B.
    fn root([x, y, ax, ay, bx, by]: [f64; 6]) -> Self {
        Self { factor: None, points: [[x, y], [ax, ay], [bx, by]] }
    }

    /// Its half planes; `None` if the points lie on one line.
    fn wedge(&self) -> Option<Wedge> {
        let [tip, a, b] = self.points;
        Wedge::new(tip, a, b)
    }
}

/// Two half planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wedge {
    /// The tip T \[L\].
    pub tip: [f64; 2],
    /// Unit normals of TA and TB, into the wedge.
    pub inward: [[f64; 2]; 2],
}

impl Wedge {
    /// The wedge between TA and TB; `None` if the three points lie on a line.
    pub fn new(tip: [f64; 2], a: [f64; 2], b: [f64; 2]) -> Option<Self> {
        let [to_a, to_b] = [a, b].map(|end| [end[0] - tip[0], end[1] - tip[1]]);
        let normal = |along: [f64; 2], other: [f64; 2]| {
            let cross = along[0] * other[1] - along[1] * other[0];
            let length = along[0].hypot(along[1]);
            (cross != 0.0).then(|| [-along[1], along[0]].map(|c| cross.signum() * c / length))
        };
        Some(Self { tip, inward: [normal(to_a, to_b)?, normal(to_b, to_a)?] })
    }

    /// The smaller distance \[L\] and the outward normal of its face, for a place inside.
    pub fn nearest(&self, place: [f64; 2]) -> Option<(f64, [f64; 2])> {
        let from_tip = [place[0] - self.tip[0], place[1] - self.tip[1]];
        let [first, second] = self.inward.map(|n| n[0] * from_tip[0] + n[1] * from_tip[1]);
        if !(first >= 0.0 && second >= 0.0) {
            return None;
        }
        let face = usize::from(second < first);
        Some((first.min(second), self.inward[face].map(|n| -n)))
    }
}

/// The tool.
pub struct CuttingTool {
    id: String,
    values: Values,
    pushed: Pushed,
    /// K G or (PI/2) G (1 + nu)/(1 - nu^2) of each solid.
    stiffness: Vec<f64>,
}

impl CuttingTool {
    fn read(args: &mut Args<'_>, target: &Target) -> Result<Self, Diagnostic> {
        let id = target.id.clone();
        let span = args.next_span();
        let values = if args.remaining() > 6 {
            let names = ["K", "xT", "yT", "zT", "vxT", "vyT", "vzT", "xA", "yA", "xB", "yB"];
            Values::Linear(Numbers::read(args, &id, names)?)
        } else {
            let names = ["xT", "yT", "xA", "yA", "xB", "yB"];
            Values::Root(Numbers::read(args, &id, names)?)
        };
        let shape = match &values {
            Values::Linear(numbers) => numbers.constants().map(Shape::linear),
            Values::Root(numbers) => numbers.constants().map(Shape::root),
        };
        if shape.is_some_and(|shape| shape.wedge().is_none()) {
            let message = "the points T, A and B of the tool lie on one line";
            return Err(Diagnostic::error(Code::Range, span, message).label("not a wedge"));
        }
        Ok(Self { id, values, pushed: Pushed::new(target.group), stiffness: Vec::new() })
    }

    fn shape(&self, step: &Step<'_>) -> Result<(Option<f64>, Wedge), Fault> {
        let shape = match &self.values {
            Values::Linear(numbers) => Shape::linear(numbers.now(step.board, &step.clock)?),
            Values::Root(numbers) => Shape::root(numbers.now(step.board, &step.clock)?),
        };
        shape.wedge().map(|wedge| (shape.factor, wedge)).ok_or_else(|| {
            Fault::run(format!(
                "fix `{}`: the points T, A and B of the tool lie on one line at step {}, time {:.6e}",
                self.id, step.clock.step, step.clock.time
            ))
        })
    }
}

/// K G, or (PI/2) G (1 + nu)/(1 - nu^2) = (PI/2) G/(1 - nu).
fn stiffness(solid: &Solid, factor: Option<f64>) -> f64 {
    if solid.rigid {
        return 0.0;
    }
    let [bulk, shear] = solid.law.moduli();
    if shear == 0.0 {
        return 0.0;
    }
    let nu = (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear));
    factor.map_or(FRAC_PI_2 * shear / (1.0 - nu), |k| k * shear)
}

impl Fix for CuttingTool {
    fn stages(&self) -> &'static [Stage] {
        &[Stage::InitialIntegrate, Stage::FinalIntegrate]
    }

    fn needs(&self, plan: &mut Plan, dimension: usize) {
        Pushed::needs(plan, dimension);
    }

    fn formulas(&self) -> Vec<&Formula> {
        match &self.values {
            Values::Linear(numbers) => numbers.formulas(),
            Values::Root(numbers) => numbers.formulas(),
        }
    }

    fn apply(&mut self, stage: Stage, step: &mut Step<'_>) -> Result<(), Fault> {
        if stage == Stage::FinalIntegrate {
            self.pushed.work(step.world);
            return Ok(());
        }
        let (factor, wedge) = self.shape(step)?;
        self.stiffness.clear();
        self.stiffness.extend(step.world.solids.iter().map(|solid| stiffness(solid, factor)));
        let stiffness = &self.stiffness;
        self.pushed.push(step.world, step.clock.dt, |world, p| {
            let particles = &world.particles;
            let [x, y, ..] = particles.position[p];
            let (depth, outward) = wedge.nearest([x, y])?;
            let modulus = stiffness[particles.solid[p] as usize];
            let (force, stiffness) = match factor {
                Some(_) => {
                    let damage = particles.column(Column::Damage).get(p).copied().unwrap_or(0.0);
                    let modulus = modulus * (1.0 - damage);
                    (modulus * depth, modulus)
                }
                None => {
                    let root = depth.sqrt();
                    (modulus * depth * root, 1.5 * modulus * root)
                }
            };
            Some(Thrust { force: [force * outward[0], force * outward[1], 0.0], stiffness })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearer_face_pushes_out() {
        // Tip (0, 0), A (1, 0), B (0, 1): distances 0.3 to TA and 0.1 to TB.
        let wedge = Wedge::new([0.0; 2], [1.0, 0.0], [0.0, 1.0]).unwrap();
        assert_eq!(wedge.nearest([0.1, 0.3]), Some((0.1, [-1.0, 0.0])));
        assert_eq!(wedge.nearest([0.3, 0.1]), Some((0.1, [0.0, -1.0])));
        assert_eq!(wedge.nearest([-0.1, 0.3]), None);
        assert_eq!(wedge.nearest([0.1, -0.3]), None);
        assert_eq!(wedge.nearest([0.0, 0.0]).map(|(depth, _)| depth), Some(0.0));
    }

    #[test]
    fn the_ends_may_be_given_in_either_order() {
        let (a, b) = ([2.0, 1.0], [1.0, 3.0]);
        let wedge = Wedge::new([1.0, 1.0], a, b).unwrap();
        let turned = Wedge::new([1.0, 1.0], b, a).unwrap();
        for place in [[1.2, 1.4], [1.5, 1.1], [0.0, 0.0]] {
            assert_eq!(wedge.nearest(place), turned.nearest(place));
        }
    }

    #[test]
    fn three_points_on_a_line_are_no_wedge() {
        assert_eq!(Wedge::new([0.0; 2], [1.0, 1.0], [2.0, 2.0]), None);
        assert_eq!(Wedge::new([0.0; 2], [0.0; 2], [1.0, 0.0]), None);
    }
}
