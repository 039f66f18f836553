//! The background grid: dense windows of nodes around the bodies.
//!
//! Updated Lagrangian methods have one lattice for all bodies but those with a contact, total
//! Lagrangian ones a lattice for each. Only a window of each lattice is in memory, one behind the other, and only its active runs
//! (nodes a particle can reach before the next re-fit) are ever touched, so that cost follows the
//! matter and not the box.

use super::contact::{CANDIDATES, Couple};
use super::group::{GroupId, Groups, Members};
use super::lattice::Lattice;
use std::ops::Range;

/// A node during the first half of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct Node {
    /// After P2G momentum, after the update v*; then the mass.
    pub motion: [f64; 4],
    /// After P2G force f + mb, after the update v* - v; the last entry is unused.
    pub change: [f64; 4],
}

/// The nodes around the bodies.
#[derive(Clone, Default)]
pub struct Grid {
    /// The lattices, in the order of their windows in memory.
    pub lattices: Vec<Lattice>,
    /// First half of a step: momentum, mass, force; v*, v* - v.
    pub nodes: Vec<Node>,
    /// Second mapping: momentum, then velocity.
    pub mapped: Vec<[f64; 4]>,
    /// External forces mb \[M L/T^2\]; empty unless the scene reports them.
    pub external: Vec<[f64; 4]>,
    /// Displacement of the nodes \[L\]; empty unless something reads places of moving nodes.
    pub displaced: Vec<[f64; 4]>,
    /// XPIC: the filtered velocity less v; empty for other transfers.
    pub filtered: Vec<[f64; 4]>,
    /// XPIC: nodes and axes whose velocity is prescribed in this step.
    pub held: Vec<(usize, usize)>,
    /// Velocity of rigid bodies \[L/T\] and sum N V of their particles; empty without them.
    pub rigid: Vec<[f64; 4]>,
    /// F-bar: m tr L of the particles, then the average of tr L; empty otherwise.
    pub dilation: Vec<f64>,
    /// Conduction of heat: sum N m cp T, then T_I \[K\], after the update T*_I; T*_I - T_I; unused;
    /// C_I = sum N m cp \[M L^2/(T^2 K)\]. Empty unless heat is conducted.
    pub temperature: Vec<[f64; 4]>,
    /// sum V q . grad N \[M L^2/T^3\], what conduction brings to a node; empty likewise.
    pub heating: Vec<f64>,
    /// Multi-field contact: pairs of nodes at one place, pair by pair of lattices.
    pub couples: Vec<Couple>,
    /// The first couple of each node, counted from 1; 0: it has none. Empty without contact.
    pub coupled: Vec<u32>,
    /// sum w dN/dr and sum w N of the body around a node in a couple; empty likewise.
    pub outward: Vec<[f64; 4]>,
    /// How far the two bodies of each couple reach along and against its possible normals \[L\].
    pub extents: Vec<[[f64; CANDIDATES]; 2]>,
    /// Optional arrays that the scene needs.
    pub keeps: Keeps,
    /// Runs of active nodes in memory, ascending.
    pub runs: Vec<Range<usize>>,
    /// First run of each block of nodes, and one past the last run.
    pub first_run: Vec<usize>,
    /// Active nodes of each group, ascending.
    members: Vec<Vec<u32>>,
    /// Nodes with less mass are empty.
    pub mass_cutoff: f64,
    /// Nodes that another process counts in sums over all nodes; empty if there is one process.
    pub counted_elsewhere: Vec<bool>,
}

/// Which optional arrays a grid has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Keeps {
    /// External forces apart from internal ones.
    pub external: bool,
    /// Displacements of nodes.
    pub displaced: bool,
    /// Filtered velocities.
    pub filtered: bool,
    /// Velocities of rigid bodies.
    pub rigid: bool,
    /// Averages of tr L.
    pub dilation: bool,
    /// Temperatures.
    pub temperature: bool,
    /// Surfaces of bodies in contact.
    pub contact: bool,
}

impl Grid {
    /// Active nodes of a group, as places in memory.
    pub fn of_group(&self, group: GroupId) -> &[u32] {
        self.members.get(group.0).map_or(&[], Vec::as_slice)
    }

    /// Does this process count the node in sums over all nodes?
    pub fn counts(&self, node: usize) -> bool {
        !self.counted_elsewhere.get(node).is_some_and(|elsewhere| *elsewhere)
    }

    /// Nodes in memory.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Is no node in memory?
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// Where nodes are.
    pub fn places(&self) -> Places<'_> {
        Places { lattices: &self.lattices, displaced: &self.displaced }
    }

    /// Finds the active nodes of every node group again.
    pub fn gather_groups(&mut self, groups: &Groups) {
        self.members.resize(groups.0.len(), Vec::new());
        for (list, group) in self.members.iter_mut().zip(&groups.0) {
            list.clear();
            if matches!(group.members, Members::Particles { .. }) {
                continue;
            }
            let mut active = self.runs.iter().cloned().flatten().peekable();
            for (number, lattice) in self.lattices.iter().enumerate() {
                while let Some(place) = active.next_if(|place| *place < lattice.window.places().end)
                {
                    let node = lattice.place(lattice.window.node(place));
                    if group.members.holds_node(number, node) {
                        list.push(place as u32);
                    }
                }
            }
        }
    }

    /// The active nodes of a group and, apart from them, the nodal values and places.
    pub fn split(&mut self, group: GroupId) -> (&[u32], Nodal<'_>, Places<'_>) {
        let members = self.members.get(group.0).map_or(&[][..], Vec::as_slice);
        let nodal = Nodal {
            nodes: &mut self.nodes,
            mapped: &mut self.mapped,
            external: &mut self.external,
            held: if self.filtered.is_empty() { None } else { Some(&mut self.held) },
            temperature: &mut self.temperature,
            mass_cutoff: self.mass_cutoff,
            counted_elsewhere: &self.counted_elsewhere,
        };
        let places = Places { lattices: &self.lattices, displaced: &self.displaced };
        (members, nodal, places)
    }
}

/// Where nodes are.
#[derive(Clone, Copy)]
pub struct Places<'a> {
    lattices: &'a [Lattice],
    displaced: &'a [[f64; 4]],
}

impl Places<'_> {
    /// Number of the lattice of a node.
    pub fn lattice(&self, place: usize) -> usize {
        self.lattices.partition_point(|lattice| lattice.window.places().end <= place)
    }

    /// Current and reference position of a node \[L\].
    pub fn of(&self, place: usize) -> ([f64; 3], [f64; 3]) {
        let lattice = &self.lattices[self.lattice(place)];
        let reference = lattice.place(lattice.window.node(place));
        let current = match self.displaced.get(place) {
            Some(u) => std::array::from_fn(|axis| reference[axis] + u[axis]),
            None => reference,
        };
        (current, reference)
    }
}

/// Nodal values, for fixes.
pub struct Nodal<'a> {
    nodes: &'a mut [Node],
    mapped: &'a mut [[f64; 4]],
    external: &'a mut [[f64; 4]],
    /// The list of prescribed components, if something reads it.
    held: Option<&'a mut Vec<(usize, usize)>>,
    temperature: &'a mut [[f64; 4]],
    mass_cutoff: f64,
    counted_elsewhere: &'a [bool],
}

impl Nodal<'_> {
    /// Does this process count the node in sums over all nodes?
    pub fn counts(&self, node: usize) -> bool {
        !self.counted_elsewhere.get(node).is_some_and(|elsewhere| *elsewhere)
    }

    /// Mass of a node \[M\]; 0 if it is empty.
    pub fn mass(&self, node: usize) -> f64 {
        let mass = self.nodes[node].motion[3];
        if mass > self.mass_cutoff { mass } else { 0.0 }
    }

    /// v of a node before the update \[L/T\] (H2); 0 if it is empty.
    pub fn velocity(&self, node: usize) -> [f64; 3] {
        let mass = self.mass(node);
        let inverse = if mass > 0.0 { 1.0 / mass } else { 0.0 };
        let [x, y, z, _] = self.nodes[node].motion;
        [x, y, z].map(|momentum| inverse * momentum)
    }

    /// f + mb of a node so far \[M L/T^2\] (H2).
    pub fn force(&self, node: usize) -> [f64; 3] {
        let [x, y, z, _] = self.nodes[node].change;
        [x, y, z]
    }

    /// Adds an external force to a node (H2).
    pub fn add_force(&mut self, node: usize, force: [f64; 3]) {
        for (change, force) in self.nodes[node].change.iter_mut().zip(force) {
            *change += force;
        }
        if let Some(external) = self.external.get_mut(node) {
            for (external, force) in external.iter_mut().zip(force) {
                *external += force;
            }
        }
    }

    /// Prescribes one component of the velocity (H3): `start` replaces v, `end` replaces v*.
    /// Returns the v* it had.
    pub fn prescribe(&mut self, node: usize, axis: usize, start: f64, end: f64) -> f64 {
        if let Some(held) = &mut self.held {
            held.push((node, axis));
        }
        let node = &mut self.nodes[node];
        let free = node.motion[axis];
        node.motion[axis] = end;
        node.change[axis] = end - start;
        free
    }

    /// Prescribes v* alone (H3): v, as it was, stays.
    pub fn prescribe_updated(&mut self, node: usize, axis: usize, end: f64) {
        let node = &mut self.nodes[node];
        node.change[axis] += end - node.motion[axis];
        node.motion[axis] = end;
    }

    /// T_I before conduction and its heat capacity C_I; both 0 where no heat is conducted.
    pub fn temperature(&self, node: usize) -> [f64; 2] {
        self.temperature.get(node).map_or([0.0; 2], |record| [record[0], record[3]])
    }

    /// Prescribes T_I (H2).
    pub fn prescribe_temperature(&mut self, node: usize, value: f64) {
        if let Some(record) = self.temperature.get_mut(node) {
            record[0] = value;
        }
    }

    /// Prescribes T*_I (H3), with `start` as T_I.
    pub fn prescribe_updated_temperature(&mut self, node: usize, start: f64, end: f64) {
        if let Some(record) = self.temperature.get_mut(node) {
            (record[0], record[1]) = (end, end - start);
        }
    }

    /// Prescribes one component of the velocity of the second mapping (H6).
    pub fn prescribe_mapped(&mut self, node: usize, axis: usize, velocity: f64) {
        self.mapped[node][axis] = velocity;
    }
}
