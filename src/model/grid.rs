//! The background grid: a dense window of nodes around the bodies.
//!
//! The nodes of the whole box are numbered (i ny + j) nz + k with z fastest. Only a window of
//! them around the bodies is in memory, and only its active runs (nodes a particle can reach
//! before the next re-fit) are ever touched, so that cost follows the matter and not the box.

use super::domain::Domain;
use super::group::{GroupId, Groups, Members};
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

/// Window of nodes in memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Window {
    /// Index of its first node in the whole grid.
    pub lower: [usize; 3],
    /// Nodes per axis.
    pub size: [usize; 3],
}

impl Window {
    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.size.iter().product()
    }

    /// Is there no node?
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Place in memory of a node of the whole grid, if the window holds it.
    pub fn local(&self, node: [usize; 3]) -> Option<usize> {
        let mut local = 0;
        for axis in 0..3 {
            let offset = node[axis].checked_sub(self.lower[axis])?;
            if offset >= self.size[axis] {
                return None;
            }
            local = local * self.size[axis] + offset;
        }
        Some(local)
    }

    /// The node of the whole grid at a place in memory.
    pub fn node(&self, local: usize) -> [usize; 3] {
        let [_, ny, nz] = self.size;
        let node = [local / (ny * nz), local / nz % ny, local % nz];
        std::array::from_fn(|axis| node[axis] + self.lower[axis])
    }
}

/// The nodes around the bodies.
#[derive(Clone, Default)]
pub struct Grid {
    /// Which nodes are in memory.
    pub window: Window,
    /// First half of a step: momentum, mass, force; v*, v* - v.
    pub nodes: Vec<Node>,
    /// Second mapping: momentum, then velocity.
    pub mapped: Vec<[f64; 4]>,
    /// External forces mb \[M L/T^2\]; empty unless the scene reports them.
    pub external: Vec<[f64; 4]>,
    /// The scene reports external forces.
    pub separate_external: bool,
    /// Runs of active nodes in memory, ascending.
    pub runs: Vec<Range<usize>>,
    /// First run of each block of nodes, and one past the last run.
    pub first_run: Vec<usize>,
    /// Active nodes of each group, ascending.
    members: Vec<Vec<u32>>,
    /// Nodes with less mass are empty.
    pub mass_cutoff: f64,
}

impl Grid {
    /// Active nodes of a group, as places in memory.
    pub fn of_group(&self, group: GroupId) -> &[u32] {
        self.members.get(group.0).map_or(&[], Vec::as_slice)
    }

    /// Finds the active nodes of every node group again.
    pub fn gather_groups(&mut self, domain: &Domain, groups: &Groups) {
        self.members.resize(groups.0.len(), Vec::new());
        for (list, group) in self.members.iter_mut().zip(&groups.0) {
            list.clear();
            let regions = match &group.members {
                Members::All => &[][..],
                Members::Nodes { regions } => regions,
                Members::Particles { .. } => continue,
            };
            let all = matches!(group.members, Members::All);
            for local in self.runs.iter().cloned().flatten() {
                let place = domain.node(self.window.node(local));
                if all || regions.iter().any(|region| region.contains(place)) {
                    list.push(local as u32);
                }
            }
        }
    }

    /// The active nodes of a group and, apart from them, the nodal values.
    pub fn split(&mut self, group: GroupId) -> (&[u32], Nodal<'_>) {
        let members = self.members.get(group.0).map_or(&[][..], Vec::as_slice);
        let nodal = Nodal {
            nodes: &mut self.nodes,
            mapped: &mut self.mapped,
            external: &mut self.external,
            mass_cutoff: self.mass_cutoff,
        };
        (members, nodal)
    }
}

/// Nodal values, for fixes.
pub struct Nodal<'a> {
    nodes: &'a mut [Node],
    mapped: &'a mut [[f64; 4]],
    external: &'a mut [[f64; 4]],
    mass_cutoff: f64,
}

impl Nodal<'_> {
    /// Mass of a node \[M\]; 0 if it is empty.
    pub fn mass(&self, node: usize) -> f64 {
        let mass = self.nodes[node].motion[3];
        if mass > self.mass_cutoff { mass } else { 0.0 }
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

    /// Prescribes one component of the velocity of the second mapping (H6).
    pub fn prescribe_mapped(&mut self, node: usize, axis: usize, velocity: f64) {
        self.mapped[node][axis] = velocity;
    }
}
