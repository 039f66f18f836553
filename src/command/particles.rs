//! Commands that remove, move and replace the particles of solids.

use super::Action;
use super::scene::{Scene, SolidEntry};
use super::session::Stop;
use super::solid::check_memory;
use crate::fix::components::Components;
use crate::fix::{GroupKind, Target};
use crate::geometry::{Point, Points};
use crate::model::group::GroupId;
use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::simulation::fill::Filling;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Reads `solid|all`: the number of the solid, `None` for all.
fn solid_or_all(args: &mut Args<'_>, scene: &Scene) -> Result<Option<usize>, Diagnostic> {
    if args.keyword("all") {
        return Ok(None);
    }
    let name = args.word("a solid ID or `all`")?;
    Ok(Some(scene.solids.find(&name)?.0))
}

fn nothing_left(region: &Name, label: &str) -> Diagnostic {
    Diagnostic::error(Code::NothingLeft, region.span, "no particle of the solid is left")
        .label(label)
}

/// `delete_particles(solid|all, region, ID)`
pub fn delete_particles(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let solid = solid_or_all(args, scene)?;
    args.choice("way to choose particles", &["region"])?;
    let name = args.word("a region ID")?;
    let region = scene.regions.find(&name)?.1.clone();
    let nothing_left = nothing_left(&name, "holds all of them");
    Ok(Box::new(move |session| match session.simulation.delete_particles(solid, region.as_ref()) {
        true => Ok(()),
        false => Err(Stop::Script(vec![nothing_left])),
    }))
}

/// `translate_particles(solid|all, region, ID, dx, dy, dz)`
pub fn translate_particles(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let solid = solid_or_all(args, scene)?;
    args.choice("way to choose particles", &["region"])?;
    let name = args.word("a region ID")?;
    let region = scene.regions.find(&name)?.1.clone();
    if scene.method.is_some_and(|choice| choice.method.total) && scene.runs > 0 {
        let message = "in total Lagrangian methods particles cannot be moved after the first run";
        return Err(Diagnostic::error(Code::Order, args.command.span, message)
            .label("too late: put it above the first run"));
    }
    let target = Target {
        id: args.command.text.clone(),
        group: GroupId::ALL,
        kind: GroupKind::Particles,
        span: name.span,
        dimension: scene.need_domain(args.command)?.dimension,
        conducts_heat: scene.conducts_heat(),
        solids: [0; 2],
    };
    let by = Components::read(args, &target, ["dx", "dy", "dz"])?;
    let moved_out = Diagnostic::error(Code::Range, name.span, "a particle would leave the box")
        .label("holds a particle that is moved too far");
    Ok(Box::new(move |session| {
        session.simulation.quantities.clone_from(&session.quantities);
        match session.simulation.translate_particles(solid, region.as_ref(), &by)? {
            true => Ok(()),
            false => Err(Stop::Script(vec![moved_out])),
        }
    }))
}

/// `populate_cylindrical_coordinates(solid, region, [axis,] c1, c2, R, [lo, hi, Nx,] Nr, Ntheta,
/// T0)`
pub fn populate(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    scene.before_runs(args.command)?;
    let domain = scene.need_domain(args.command)?;
    if domain.dimension == 1 {
        let message = "rings of particles need two or three dimensions";
        return Err(Diagnostic::error(Code::DimensionMismatch, args.span, message)
            .label("the problem has one dimension"));
    }
    let solid = args.word("a solid ID")?;
    let number = scene.solids.find(&solid)?.0;
    let name = args.word("a region ID")?;
    let region = scene.regions.find(&name)?.1.clone();
    let span = args.next_span();
    let rings = Rings::read(args, domain.dimension)?;
    let temperature = args.number("the initial temperature T0")?.value;
    check_memory(args, rings.count(), span)?;
    let total = scene.method.is_some_and(|choice| choice.method.total);
    let mut points = rings.points();
    points
        .list
        .retain(|point| region.contains(point.place) && (total || domain.contains(point.place)));
    if points.list.is_empty() && rings.is_known() {
        return Err(nothing_left(&name, "holds no particle of the rings"));
    }
    let points = Arc::new(points);
    let filling = Filling::Points(points.clone());
    let known = scene.solids.find(&solid)?.1;
    let entry = SolidEntry { filling, cells: known.cells, rigid: known.rigid };
    scene.solids.set(&solid.text, entry);
    Ok(super::action(move |session| {
        session.simulation.replace_particles(number, &points);
        session.simulation.heat_solid(number, temperature);
    }))
}

/// Particles on circles around an axis.
struct Rings {
    dimension: usize,
    /// 0, 1, 2 for x, y, z.
    axis: usize,
    /// Centre on the two other axes, in order \[L\].
    centre: [f64; 2],
    radius: f64,
    /// Ends along the axis \[L\].
    ends: [f64; 2],
    along: u64,
    outwards: u64,
    around: u64,
}

impl Rings {
    fn read(args: &mut Args<'_>, dimension: usize) -> Result<Self, Diagnostic> {
        let axis = match dimension {
            3 => args.choice("the axis", &["x", "y", "z"])?,
            _ => 2,
        };
        let centre = [args.number("c1")?.value, args.number("c2")?.value];
        let radius = args.positive("the radius R")?.value;
        let (mut ends, mut along) = ([0.0, 1.0], 1);
        if dimension == 3 {
            let low = args.number("the lower end lo")?;
            let high = args.number("the upper end hi")?;
            if low.known && high.known && low.value >= high.value {
                return Err(args.out_of_range(&low, "the lower end must lie below the upper one"));
            }
            ends = [low.value, high.value];
            along = args.count("the number of discs Nx", 1)?;
        }
        let outwards = args.count("the number of rings Nr", 1)?;
        let around = args.count("the number of particles of a ring Ntheta", 1)?;
        Ok(Self { dimension, axis, centre, radius, ends, along, outwards, around })
    }

    fn count(&self) -> f64 {
        self.along as f64 * self.outwards as f64 * self.around as f64
    }

    /// Does no number depend on a run?
    fn is_known(&self) -> bool {
        let [[a, b], [c, d]] = [self.centre, self.ends];
        (a + b + c + d + self.radius).is_finite()
    }

    /// r = (i + 1/2) R/Nr, theta = 2 PI k/Ntheta; volume r dr dtheta (dx).
    fn points(&self) -> Points {
        let step = |length: f64, count: u64| length / count as f64;
        let dx = step(self.ends[1] - self.ends[0], self.along);
        let (dr, turn) = (step(self.radius, self.outwards), step(TAU, self.around));
        let across = [[1, 2], [0, 2], [0, 1]][self.axis];
        let mut points = Points::default();
        for i in 0..self.along {
            for j in 0..self.outwards {
                for k in 0..self.around {
                    let radius = (j as f64 + 0.5) * dr;
                    let (sine, cosine) = (k as f64 * turn).sin_cos();
                    let mut place = [0.0; 3];
                    place[across[0]] = self.centre[0] + radius * cosine;
                    place[across[1]] = self.centre[1] + radius * sine;
                    if self.dimension == 3 {
                        place[self.axis] = self.ends[0] + (i as f64 + 0.5) * dx;
                    }
                    points.list.push(Point { place, volume: radius * dr * turn * dx });
                }
            }
        }
        for (axis, centre) in across.into_iter().zip(self.centre) {
            points.lower[axis] = centre - self.radius;
            points.upper[axis] = centre + self.radius;
        }
        if self.dimension == 3 {
            [points.lower[self.axis], points.upper[self.axis]] = self.ends;
        }
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_fill_a_cylinder() {
        for axis in 0..3 {
            let rings = Rings {
                dimension: 3,
                axis,
                centre: [1.0, -2.0],
                radius: 0.5,
                ends: [3.0, 3.4],
                along: 4,
                outwards: 5,
                around: 12,
            };
            let points = rings.points();
            let volume: f64 = points.list.iter().map(|point| point.volume).sum();
            // 240 terms: rounding is below 1e-13 of the sum.
            let exact = std::f64::consts::PI * 0.25 * 0.4;
            assert!((volume - exact).abs() < 1e-13 * exact && points.list.len() == 240);
            let mean =
                |a: usize| points.list.iter().map(|p| p.volume * p.place[a]).sum::<f64>() / volume;
            let expected = [[3.2, 1.0, -2.0], [1.0, 3.2, -2.0], [1.0, -2.0, 3.2]][axis];
            for a in 0..3 {
                assert!((mean(a) - expected[a]).abs() < 1e-13, "axis {axis}");
            }
        }
    }
}
