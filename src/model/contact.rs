//! Multi-field contact: which solids have velocities of their own on the grid, and where they meet.

use super::checkpoint::Checkpoint;
use crate::math::exact_sum::{ExactSum, VectorSum};

/// What happens at a node where two bodies approach each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rule {
    /// They share one velocity, approaching or not: what a single grid does by itself.
    Welded,
    /// They go on with one velocity until they part.
    Stick,
    /// They slide without friction.
    Slip,
    /// They slide with Coulomb friction mu.
    Frictional(f64),
}

/// A contact of the script.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// Its ID.
    pub name: String,
    /// What it does.
    pub rule: Rule,
    /// Numbers of its two solids; `None`: every two solids.
    pub solids: Option<[usize; 2]>,
    /// Bodies meet where their surfaces touch; otherwise where they share nodes.
    pub touching: bool,
    /// Force on the first solid in the last step \[M L/T^2\].
    pub force: VectorSum,
    /// Heat of friction so far \[M L^2/T^2\].
    pub heat: ExactSum,
}

/// Two fields that meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Their lattices.
    pub lattices: [usize; 2],
    /// What happens.
    pub rule: Rule,
    /// Bodies meet where their surfaces touch; otherwise where they share nodes.
    pub touching: bool,
    /// Number of the contact; `None` for bodies that no contact names together.
    pub contact: Option<usize>,
    /// Part of the force on the first field that the contact publishes: 1, -1 or 0.
    pub counts: f64,
}

/// Number of directions that are tried as the normal of a couple.
pub const CANDIDATES: usize = 3;

/// Two nodes at one place, each of the lattice of one body of a pair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Couple {
    /// Number of the pair.
    pub pair: u32,
    /// The nodes, as places in memory.
    pub nodes: [u32; 2],
    /// Number of the node in its lattice, which is the same in both.
    pub number: u64,
    /// The next couple of each node, counted from 1; 0: there is none.
    pub next: [u32; 2],
    /// What may be the normal.
    pub candidates: [[f64; 3]; CANDIDATES],
    /// Unit vector out of the first body; zero where there is no surface.
    pub normal: [f64; 3],
    /// Distance of the surfaces along the normal \[L\]; 0 where touching does not count.
    pub gap: f64,
    /// Momentum that the second body has got from the first in this step \[M L/T\].
    pub impulse: [f64; 3],
    /// The part of it that friction has given along the surface.
    pub drag: [f64; 3],
    /// v1 - v2 of the bodies at the start of the step \[L/T\].
    pub slip: [f64; 3],
    /// Internal forces at the nodes \[M L/T^2\], if the energy ledger is open.
    pub internal: [[f64; 3]; 2],
}

/// All contacts of a scene.
#[derive(Clone, Debug, Default)]
pub struct Contacts {
    /// In order of definition.
    pub list: Vec<Contact>,
    /// Pairs of fields: those that no contact names first, then the others in order of definition.
    pub pairs: Vec<Pair>,
    /// Normals and gaps of the step are known.
    pub ready: bool,
}

impl Contacts {
    /// Puts what the contacts have done into a checkpoint, or takes it from there.
    pub fn keep(&mut self, checkpoint: &mut Checkpoint) {
        for contact in &mut self.list {
            checkpoint.within(&contact.name, |inside| {
                inside.vector("force", &mut contact.force);
                inside.sum("heat", &mut contact.heat);
            });
        }
    }

    /// Is every body on the one grid?
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// The lattice of each of `count` solids: a solid that a contact names has its own, all others
    /// share one. Lattices are numbered by their first solid.
    pub fn fields(&self, count: usize) -> Vec<usize> {
        let named = |solid: usize| {
            self.list.iter().any(|contact| match contact.solids {
                Some(pair) => pair.contains(&solid),
                None => true,
            })
        };
        let (mut fields, mut shared) = (0, None);
        let mut new = || {
            fields += 1;
            fields - 1
        };
        (0..count)
            .map(|solid| match named(solid) {
                true => new(),
                false => *shared.get_or_insert_with(&mut new),
            })
            .collect()
    }

    /// Finds the pairs of fields for solids on these lattices. A contact of two solids stands before
    /// one of all, whatever their order.
    pub fn pair_up(&mut self, lattices: &[usize]) {
        let fields = lattices.iter().max().map_or(0, |last| last + 1);
        self.pairs.clear();
        if self.list.is_empty() {
            return;
        }
        // A field that several solids share is in no contact.
        let solid_of = |field: usize| lattices.iter().position(|lattice| *lattice == field);
        for first in 0..fields {
            for second in first + 1..fields {
                let [a, b] = [first, second].map(|field| solid_of(field).unwrap_or(0));
                let same = |contact: &Contact| {
                    contact.solids.is_some_and(|pair| pair == [a, b] || pair == [b, a])
                };
                let contact = self.list.iter().position(same);
                let contact =
                    contact.or_else(|| self.list.iter().position(|one| one.solids.is_none()));
                self.pairs.push(match contact {
                    Some(number) => {
                        let Contact { rule, touching, solids, .. } = &self.list[number];
                        let (rule, touching, solids) = (*rule, *touching, *solids);
                        let swapped = solids.is_some_and(|[one, _]| one == b);
                        let counts = if solids.is_some() || a == 0 { 1.0 } else { 0.0 };
                        let lattices = if swapped { [second, first] } else { [first, second] };
                        Pair { lattices, rule, touching, contact, counts }
                    }
                    None => Pair {
                        lattices: [first, second],
                        rule: Rule::Welded,
                        touching: false,
                        contact,
                        counts: 0.0,
                    },
                });
            }
        }
        self.pairs.sort_by_key(|pair| pair.contact.map_or(0, |number| number + 1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact(rule: Rule, solids: Option<[usize; 2]>) -> Contact {
        let name = "c".to_string();
        let (force, heat) = Default::default();
        Contact { name, rule, solids, touching: false, force, heat }
    }

    #[test]
    fn solids_that_no_contact_names_share_a_field() {
        let mut contacts = Contacts::default();
        assert_eq!(contacts.fields(3), [0, 0, 0]);
        contacts.list.push(contact(Rule::Slip, Some([3, 1])));
        assert_eq!(contacts.fields(5), [0, 1, 0, 2, 0]);
        contacts.list.push(contact(Rule::Slip, None));
        assert_eq!(contacts.fields(3), [0, 1, 2]);
    }

    #[test]
    fn pairs_that_no_contact_names_are_welded_and_come_first() {
        let mut contacts = Contacts::default();
        contacts.list.push(contact(Rule::Slip, Some([3, 1])));
        contacts.pair_up(&contacts.fields(4));
        let welded = |lattices| Pair {
            lattices,
            rule: Rule::Welded,
            touching: false,
            contact: None,
            counts: 0.0,
        };
        let slip = Pair { rule: Rule::Slip, contact: Some(0), counts: 1.0, ..welded([2, 1]) };
        assert_eq!(contacts.pairs, [welded([0, 1]), welded([0, 2]), slip]);
    }

    #[test]
    fn a_contact_of_two_solids_stands_before_one_of_all() {
        let mut contacts = Contacts::default();
        contacts.list.push(contact(Rule::Stick, None));
        contacts.list.push(contact(Rule::Slip, Some([0, 1])));
        contacts.pair_up(&contacts.fields(3));
        let rules: Vec<(Rule, [usize; 2], f64)> =
            contacts.pairs.iter().map(|pair| (pair.rule, pair.lattices, pair.counts)).collect();
        let expected =
            [(Rule::Stick, [0, 2], 1.0), (Rule::Stick, [1, 2], 0.0), (Rule::Slip, [0, 1], 1.0)];
        assert_eq!(rules, expected);
    }
}
