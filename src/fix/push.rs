//! Forces of tools on the particles of a group.

use super::contact::largest_step;
use crate::fault::Fault;
use crate::math::exact_sum::{ExactSum, VectorSum};
use crate::model::checkpoint::Checkpoint;
use crate::model::clock::Clock;
use crate::model::column::Column;
use crate::model::group::GroupId;
use crate::parallel::Ranks;
use crate::plan::Plan;
use crate::script::arguments::{Args, Place};
use crate::script::diagnostic::Diagnostic;
use crate::script::formula::{Board, Formula, Instant};
use crate::world::World;

/// What a tool does to a particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Thrust {
    /// Force \[M L/T^2\].
    pub force: [f64; 3],
    /// Its stiffness \[M/T^2\].
    pub stiffness: f64,
}

/// A group of particles that a tool pushes, and what it came to.
pub struct Pushed {
    group: GroupId,
    members: Vec<usize>,
    /// Ids of the particles that this step pushes, ascending, and the forces on them \[M L/T^2\].
    forces: Vec<(u32, [f64; 3])>,
    total: VectorSum,
    /// Work done on the particles so far \[M L^2/T^2\].
    work: ExactSum,
    /// Largest stiffness over mass \[1/T^2\].
    rate: f64,
    /// Size of the step before \[T\].
    before: f64,
}

impl Pushed {
    /// The particles of a group.
    pub fn new(group: GroupId) -> Self {
        let (members, forces) = (Vec::new(), Vec::new());
        Self {
            group,
            members,
            forces,
            total: VectorSum::default(),
            work: ExactSum::default(),
            rate: 0.0,
            before: f64::INFINITY,
        }
    }

    /// The columns it writes.
    pub fn needs(plan: &mut Plan, dimension: usize) {
        plan.columns.extend(&[Column::Bx, Column::By, Column::Bz][..dimension]);
    }

    /// mbp += what `thrust` gives for each particle of the group; rigid bodies are not pushed.
    ///
    /// Velocities belong to the middle of a step, so that the work of a force F at its start is
    /// F . (dt/dt' dx' + dx)/2 with the ways before and after; here the first half, the other in
    /// [`Pushed::work`]. The velocity of a particle is no measure of its way: it also holds what the
    /// grid cannot see, which forces on single particles feed.
    pub fn push(
        &mut self,
        world: &mut World,
        dt: f64,
        thrust: impl Fn(&World, usize) -> Option<Thrust>,
    ) {
        self.members.clear();
        self.members.extend(world.particles.of_group(&world.groups, self.group));
        self.forces.clear();
        self.forces.reserve(self.members.len());
        self.total.clear();
        self.rate = 0.0;
        for p in self.members.iter().copied() {
            let Some(Thrust { mut force, stiffness }) = thrust(world, p) else { continue };
            if world.solids[world.particles.solid[p] as usize].rigid {
                continue;
            }
            self.rate = self.rate.max(stiffness / world.particles.position[p][3]);
            let columns = [Column::Bx, Column::By, Column::Bz].into_iter().enumerate();
            for (axis, column) in columns {
                match world.particles.column_mut(column).get_mut(p) {
                    Some(sum) => *sum += force[axis],
                    None => force[axis] = 0.0,
                }
            }
            self.total.add(force);
            let before = along(&force, &world.particles.displacement[p]);
            self.work.add(0.5 * dt / self.before * before);
            self.forces.push((world.particles.id[p], force));
        }
        self.forces.sort_unstable_by_key(|(id, _)| *id);
        self.before = dt;
    }

    /// The second half of the work, once the particles have moved: they may have been sorted since,
    /// or have left.
    pub fn work(&mut self, world: &World) {
        self.hear_of_others(&world.ranks);
        if self.forces.is_empty() {
            return;
        }
        let particles = &world.particles;
        for (id, dx) in particles.id.iter().zip(&particles.displacement) {
            if let Ok(place) = self.forces.binary_search_by_key(id, |(id, _)| *id) {
                self.work.add(0.5 * along(&self.forces[place].1, dx));
            }
        }
    }

    /// Particles may have gone to other processes since: everybody gets all forces.
    fn hear_of_others(&mut self, ranks: &Ranks) {
        if ranks.is_alone() {
            return;
        }
        let own = self.forces.iter().flat_map(|(id, [x, y, z])| [f64::from(*id), *x, *y, *z]);
        let all = ranks.share(&own.collect::<Vec<f64>>());
        let (records, _) = all.as_chunks::<4>();
        self.forces.clear();
        self.forces.extend(records.iter().map(|[id, x, y, z]| (*id as u32, [*x, *y, *z])));
        self.forces.sort_unstable_by_key(|(id, _)| *id);
    }

    /// Puts into a checkpoint, or takes from it, what the next step reads. The forces do not live
    /// that long.
    pub fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.vector("total", &mut self.total);
        checkpoint.sum("work", &mut self.work);
        checkpoint.largest("rate", &mut self.rate);
        checkpoint.number("before", &mut self.before);
    }

    /// Largest stable step \[T\].
    pub fn largest_step(&self) -> f64 {
        largest_step(self.rate)
    }

    /// The total force and the work done so far.
    pub fn results(&self, ranks: &Ranks) -> [f64; 4] {
        let [x, y, z] = self.total.0.each_ref();
        ranks.totals([x, y, z, &self.work])
    }
}

/// F . dx.
fn along(force: &[f64; 3], way: &[f64; 4]) -> f64 {
    force.iter().zip(way).map(|(f, dx)| f * dx).sum()
}

/// Numbers of a tool: formulas of time, evaluated at the start of each step.
pub struct Numbers<const N: usize> {
    id: String,
    formulas: [Formula; N],
}

impl<const N: usize> Numbers<N> {
    /// Reads them in the order of their names.
    ///
    /// # Errors
    /// One is missing or reads a place.
    pub fn read(args: &mut Args<'_>, id: &str, names: [&str; N]) -> Result<Self, Diagnostic> {
        let mut formulas = Vec::with_capacity(N);
        for name in names {
            formulas.push(args.formula(name, Place::Nowhere)?);
        }
        let mut formulas = formulas.into_iter();
        let formulas = names.map(|_| formulas.next().unwrap_or_else(|| Formula::constant(0.0)));
        Ok(Self { id: id.to_string(), formulas })
    }

    /// The formulas.
    pub fn formulas(&self) -> Vec<&Formula> {
        self.formulas.iter().collect()
    }

    /// The numbers, if all are constants that are known.
    pub fn constants(&self) -> Option<[f64; N]> {
        let mut values = [0.0; N];
        for (value, formula) in values.iter_mut().zip(&self.formulas) {
            *value = formula.as_constant().filter(|_| formula.is_known())?;
        }
        Some(values)
    }

    /// The numbers at the start of a step.
    ///
    /// # Errors
    /// One is not finite.
    pub fn now(&self, board: &Board, clock: &Clock) -> Result<[f64; N], Fault> {
        let now = Instant::start(clock);
        let mut values = [0.0; N];
        for (value, formula) in values.iter_mut().zip(&self.formulas) {
            *value = formula.value(board, &now);
            if !value.is_finite() {
                return Err(Fault::run(format!(
                    "fix `{}`: `{}` is {value} at step {}, time {:.6e}",
                    self.id,
                    formula.text(),
                    now.step,
                    now.time
                )));
            }
        }
        Ok(values)
    }
}
