//! Values of published quantities: results of fixes and computes, group functions.

use crate::compute::Compute;
use crate::fix::Fix;
use crate::math::exact_sum::{ExactSum, VectorSum};
use crate::model::checkpoint::Checkpoint;
use crate::model::group::GroupId;
use crate::parallel::Ranks;
use crate::script::formula::{GroupFunction, Quantity};
use crate::world::World;

/// Largest number of values one compute publishes.
const LARGEST_COMPUTE: usize = 16;

/// Sums of nodal forces over groups, taken while the step passes by.
#[derive(Clone, Debug, Default)]
pub struct Captured {
    sums: Vec<Sum>,
}

#[derive(Clone, Debug)]
struct Sum {
    function: GroupFunction,
    name: String,
    group: GroupId,
    /// Over the nodes of this process.
    value: VectorSum,
}

impl Captured {
    /// Lists the sums that something reads; values known from before are kept.
    pub fn prepare(&mut self, quantities: &[Quantity], world: &World) {
        let mut sums: Vec<Sum> = Vec::new();
        for quantity in quantities {
            let Quantity::Group { function, group: name, .. } = quantity else {
                continue;
            };
            if *function == GroupFunction::Xcm || sums.iter().any(|s| s.is(*function, name)) {
                continue;
            }
            let Some(index) = world.groups.0.iter().position(|group| group.name == *name) else {
                continue;
            };
            let known = self.sums.iter().find(|sum| sum.is(*function, name));
            let value = known.map_or(VectorSum::default(), |sum| sum.value.clone());
            sums.push(Sum {
                function: *function,
                name: name.clone(),
                group: GroupId(index),
                value,
            });
        }
        self.sums = sums;
    }

    /// Puts the sums into a checkpoint, or takes them from there.
    pub fn keep(&mut self, checkpoint: &mut Checkpoint) {
        for sum in &mut self.sums {
            checkpoint.within(&sum.name, |inside| {
                inside.vector(sum.function.word(), &mut sum.value);
            });
        }
    }

    /// Are the sums listed that these quantities read?
    pub fn covers(&self, quantities: &[Quantity]) -> bool {
        quantities.iter().all(|quantity| match quantity {
            Quantity::Group { function: GroupFunction::Xcm, .. } => true,
            Quantity::Group { function, group, .. } => {
                self.sums.iter().any(|sum| sum.is(*function, group))
            }
            _ => true,
        })
    }

    /// Does anything read external forces?
    pub fn reads_external(&self) -> bool {
        self.sums.iter().any(|sum| sum.function == GroupFunction::ExternalForce)
    }

    /// Takes the internal forces: to be called after P2G, before H2.
    pub fn internal(&mut self, world: &World) {
        self.take(GroupFunction::InternalForce, world, |node| world.grid.nodes[node].change);
    }

    /// Takes the external forces: to be called after H2.
    pub fn external(&mut self, world: &World) {
        self.take(GroupFunction::ExternalForce, world, |node| {
            world.grid.external.get(node).copied().unwrap_or_default()
        });
    }

    fn take(&mut self, function: GroupFunction, world: &World, force: impl Fn(usize) -> [f64; 4]) {
        for sum in self.sums.iter_mut().filter(|sum| sum.function == function) {
            sum.value.clear();
            for node in world.grid.of_group(sum.group) {
                if world.grid.counts(*node as usize) {
                    let [x, y, z, _] = force(*node as usize);
                    sum.value.add([x, y, z]);
                }
            }
        }
    }

    fn value(&self, ranks: &Ranks, function: GroupFunction, name: &str, axis: usize) -> f64 {
        let sum = self.sums.iter().find(|sum| sum.is(function, name));
        sum.map_or(0.0, |sum| ranks.total(&sum.value.0[axis]))
    }
}

impl Sum {
    fn is(&self, function: GroupFunction, name: &str) -> bool {
        self.function == function && self.name == name
    }
}

/// The value a quantity has now; 0 for one that does not exist (yet).
pub fn value(
    quantity: &Quantity,
    world: &World,
    fixes: &[(String, Box<dyn Fix>)],
    computes: &[(String, Box<dyn Compute>)],
    captured: &Captured,
) -> f64 {
    match quantity {
        Quantity::Fix { id, component } => {
            let fix = fixes.iter().find(|(name, _)| name == id);
            fix.map_or(0.0, |(_, fix)| fix.results(world)[*component])
        }
        Quantity::Compute { id, component } => {
            let mut values = [0.0; LARGEST_COMPUTE];
            if let Some((_, compute)) = computes.iter().find(|(name, _)| name == id) {
                compute.evaluate(world, &mut values[..compute.suffixes().len()]);
            }
            values[*component]
        }
        Quantity::Contact { id, component } => {
            let contact = world.contacts.list.iter().find(|contact| contact.name == *id);
            contact.map_or(0.0, |contact| {
                let [x, y, z] = contact.force.0.each_ref();
                world.ranks.total([x, y, z, &contact.heat][*component])
            })
        }
        Quantity::Group { function: GroupFunction::Xcm, group, axis } => {
            centre_of_mass(world, group, *axis)
        }
        Quantity::Group { function, group, axis } => {
            captured.value(&world.ranks, *function, group, *axis)
        }
    }
}

/// sum m x / sum m over the particles of a group; sum V x / sum V if none of them has mass, as in a
/// rigid body without density.
fn centre_of_mass(world: &World, group: &str, axis: usize) -> f64 {
    let Some(index) = world.groups.0.iter().position(|known| known.name == group) else {
        return 0.0;
    };
    let mut sums: [ExactSum; 4] = Default::default();
    for p in world.particles.of_group(&world.groups, GroupId(index)) {
        let (position, velocity) = (world.particles.position[p], world.particles.velocity[p]);
        for (sums, weight) in sums.chunks_mut(2).zip([position[3], velocity[3]]) {
            sums[0].add(weight);
            sums[1].add(weight * position[axis]);
        }
    }
    let [mass, of_mass, volume, of_volume] = world.ranks.totals(sums.each_ref());
    let (weight, moment) = if mass > 0.0 { (mass, of_mass) } else { (volume, of_volume) };
    if weight > 0.0 { moment / weight } else { 0.0 }
}
