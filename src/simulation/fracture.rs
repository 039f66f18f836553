//! Bodies that have come apart because the grid no longer joins their particles.

use super::Simulation;
use crate::model::column::Column;
use crate::shape::ShapeKind;

/// A particle that is stretched beyond what its shape bridges.
pub(super) struct Torn {
    /// Its id.
    id: u32,
    /// Its largest stretch.
    stretch: f64,
    /// How far away its neighbours are then, in cells.
    distance: f64,
    /// How far its shape reaches, in cells.
    reach: f64,
}

/// Cells between equally spaced particles up to which nodes see their volume to 10 %, `half` the half
/// size of a box of GIMP in cells.
///
/// sum_p s N(x - p s) = 1 + 2 sum_k N^(2 pi k/s) cos(2 pi k x/s), where N^(w) = sinc(w/2)^(n+1) for
/// B-splines of degree n: 2 sinc(pi/s)^(n+1) = 0.1 gives s = 1.43 and 1.60. A node with a particle of `gimp`
/// on it sees s N(0) = s (1 - half/2), here to 5 %, because F hardly grows any more when these boxes part;
/// those of `cpgimp` grow as wide as a cell (quadratic splines). Hats leave a cell without any particle as
/// soon as s > 1. Infinite where particles hear of their first neighbours for ever.
fn bridged(shape: ShapeKind, half: f64) -> f64 {
    match shape {
        ShapeKind::Linear => 1.0,
        ShapeKind::Gimp => 1.05 / (1.0 - 0.5 * half),
        ShapeKind::Quadratic | ShapeKind::StretchedGimp => 1.43,
        ShapeKind::Cubic => 1.60,
        ShapeKind::Bernstein | ShapeKind::Corners(_) => f64::INFINITY,
    }
}

impl Torn {
    /// How far beyond its reach.
    fn excess(&self) -> f64 {
        self.distance / self.reach
    }

    /// The worse of two; of two alike the one with the smaller id.
    fn worse(self, other: Torn) -> Torn {
        let (own, others) = (self.excess(), other.excess());
        if own > others || (own == others && self.id < other.id) { self } else { other }
    }
}

impl std::fmt::Display for Torn {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { id, stretch, distance, reach } = self;
        write!(
            f,
            "particle {id} is stretched to {stretch:.2} times, {distance:.2} cells from its neighbours, and \
             its shape bridges {reach:.2} cells: the body may have come apart for the grid alone (numerical \
             fracture); `tlmpm`, `ulcpdi` and more particles per cell hold it together"
        )
    }
}

impl Simulation {
    /// The particle of an elastic body, on any process, that is stretched most beyond what its shape
    /// bridges. Laws without F tell the stretch by the change of volume alone, which may be less.
    pub(super) fn torn(&self) -> Option<Torn> {
        let here = self.torn_here();
        let numbers: Vec<f64> = here
            .iter()
            .flat_map(|torn| [f64::from(torn.id), torn.stretch, torn.distance, torn.reach])
            .collect();
        let all = self.world.ranks.share(&numbers);
        let each = all.as_chunks::<4>().0.iter().copied();
        let torn = |[id, stretch, distance, reach]: [f64; 4]| Torn {
            id: id as u32,
            stretch,
            distance,
            reach,
        };
        each.map(torn).reduce(Torn::worse)
    }

    fn torn_here(&self) -> Option<Torn> {
        let world = &self.world;
        let (particles, shape) = (&world.particles, world.method.shape);
        if world.method.total {
            return None;
        }
        let (volumes, damage) = (particles.column(Column::J), particles.column(Column::Damage));
        let mut worst: Option<Torn> = None;
        for p in particles.counted() {
            let solid = &world.solids[usize::from(particles.solid[p])];
            let [_, shear] = solid.law.moduli();
            let failed = damage.get(p).is_some_and(|damage| *damage >= 1.0);
            if solid.rigid || failed || shear <= 0.0 {
                continue;
            }
            let reach = bridged(shape, 0.5 / solid.particles_per_cell);
            let torn = |stretch: f64| {
                let distance = stretch / solid.particles_per_cell;
                Torn { id: particles.id[p], stretch, distance, reach }
            };
            let least = worst.as_ref().map_or(1.0, Torn::excess);
            // No stretch is larger than sqrt(F : F); most particles are judged by that.
            let has_deformation = solid.columns.contains(Column::F11);
            let most = match has_deformation {
                true => world.deformation(p).norm(),
                false => volumes[p],
            };
            if torn(most).excess() < least {
                continue;
            }
            let stretch = match has_deformation {
                true => world.deformation(p).singular_values()[0],
                false => most,
            };
            if torn(stretch).excess() > 1.0 {
                worst = worst.into_iter().chain([torn(stretch)]).reduce(Torn::worse);
            }
        }
        worst
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A B-spline of degree n and width n + 1 around 0, by its recursion.
    fn spline(degree: usize, x: f64) -> f64 {
        match degree {
            0 => f64::from(u8::from((-0.5..0.5).contains(&x))),
            _ => {
                let (n, half) = (degree as f64, 0.5 * (degree as f64 + 1.0));
                let [low, high] = [0.5, -0.5].map(|shift| spline(degree - 1, x + shift));
                ((half + x) * low + (half - x) * high) / n
            }
        }
    }

    /// A hat seen through a box.
    fn boxed(half: f64, x: f64) -> f64 {
        let parts = (0..400).map(|i| x + half * (f64::from(i) / 199.5 - 1.0));
        parts.map(|x| spline(1, x)).sum::<f64>() / 400.0
    }

    #[test]
    fn nodes_see_volumes_to_ten_percent_up_to_the_reach() {
        // Largest part by which the volume that a node sees is off, for particles so far apart.
        let off = |shape: ShapeKind, spacing: f64| {
            let value = |x: f64| match shape {
                ShapeKind::Quadratic => spline(2, x),
                ShapeKind::Cubic => spline(3, x),
                _ => boxed(0.25, x),
            };
            let volume = |x: f64| -> f64 {
                (-4..=4).map(|p| spacing * value(x - spacing * f64::from(p))).sum()
            };
            let places = (0..100).map(|i| spacing * f64::from(i) / 100.0);
            places.fold(0.0f64, |most, x| most.max((volume(x) - 1.0).abs()))
        };
        let shapes =
            [(ShapeKind::Gimp, 0.05), (ShapeKind::Quadratic, 0.1), (ShapeKind::Cubic, 0.1)];
        for (shape, part) in shapes {
            let at_reach = off(shape, bridged(shape, 0.25));
            // The next term, 2 sinc(2 pi/s)^(n+1), is 0.02 for quadratic splines and less for cubic ones.
            assert!((at_reach - part).abs() < 0.02, "{shape:?}: {at_reach}");
            // Two particles per cell, stretched to four times their length.
            assert!(off(shape, 2.0) > 0.3, "{shape:?}");
        }
    }
}
