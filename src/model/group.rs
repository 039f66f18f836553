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
    /// Grid nodes whose place lies in any of the regions (a repeated `group` adds one).
    Nodes { regions: Vec<Arc<dyn Region>> },
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
