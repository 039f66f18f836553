//! Groups of particles and of nodes.

use crate::region::Region;
use std::sync::Arc;

/// Index of a group; [`GroupId::ALL`] is the predefined `all`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GroupId(pub usize);

impl GroupId {
    /// Every particle and every node.
    pub const ALL: GroupId = GroupId(0);
}

/// What a group holds.
#[derive(Clone)]
pub enum Members {
    /// Every particle and every node.
    All,
    /// Particles: those with bit `bit` of their mask set.
    Particles { bit: usize },
    /// Grid nodes whose place lies in any of the parts (a repeated `group` adds one).
    Nodes { parts: Vec<NodePart> },
}

/// Nodes inside a region.
#[derive(Clone)]
pub struct NodePart {
    /// The region, in reference places.
    pub region: Arc<dyn Region>,
    /// Solids whose nodes count, by number; `None`: all.
    pub solids: Option<Vec<usize>>,
    /// The lattices of these solids.
    pub lattices: Vec<usize>,
}

impl NodePart {
    /// Does a lattice count?
    pub fn includes(&self, lattice: usize) -> bool {
        self.solids.is_none() || self.lattices.contains(&lattice)
    }
}

impl Members {
    /// Is a node of a lattice, at its reference place, a member?
    pub fn holds_node(&self, lattice: usize, place: [f64; 3]) -> bool {
        match self {
            Members::All => true,
            Members::Particles { .. } => false,
            Members::Nodes { parts } => {
                parts.iter().any(|part| part.includes(lattice) && part.region.contains(place))
            }
        }
    }
}

/// A named group.
#[derive(Clone)]
pub struct Group {
    /// Its ID in the script.
    pub name: String,
    /// What it holds.
    pub members: Members,
}

/// All groups of a simulation; the first is `all`.
#[derive(Clone)]
pub struct Groups(pub Vec<Group>);

impl Groups {
    /// Finds the lattices of the solids that parts of groups are bound to.
    pub fn bind(&mut self, lattice_of: &[usize]) {
        for group in &mut self.0 {
            let Members::Nodes { parts } = &mut group.members else { continue };
            for NodePart { solids, lattices, .. } in parts {
                lattices.clear();
                lattices.extend(solids.iter().flatten().filter_map(|s| lattice_of.get(*s)));
            }
        }
    }
}

impl Default for Groups {
    fn default() -> Self {
        Self(vec![Group { name: "all".to_string(), members: Members::All }])
    }
}

impl std::ops::Index<GroupId> for Groups {
    type Output = Group;
    fn index(&self, id: GroupId) -> &Group {
        &self.0[id.0]
    }
}
