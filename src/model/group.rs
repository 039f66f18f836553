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
    /// Lattices that count, by number; `None`: all.
    pub lattices: Option<Vec<usize>>,
}

impl NodePart {
    /// Does a lattice count?
    pub fn includes(&self, lattice: usize) -> bool {
        self.lattices.as_ref().is_none_or(|list| list.contains(&lattice))
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
