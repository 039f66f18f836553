//! The table of particles.

use super::checkpoint::Checkpoint;
use super::column::{COLUMNS, Column, ColumnSet};
use super::group::{GroupId, Groups, Members};
use crate::geometry::element::MOST_CORNERS;

/// Most records of the domain of a particle: the corners of a hexahedron.
pub const DOMAIN_RECORDS: usize = MOST_CORNERS;

/// Most words of group bits that a checkpoint may have.
const MOST_MASKS: u64 = 1 << 16;

/// All particles, one row each; columns of the same length or empty where the scene needs none.
#[derive(Clone, Default)]
pub struct Particles {
    /// x, y, z \[L\] and mass \[M\].
    pub position: Vec<[f64; 4]>,
    /// Velocity \[L/T\] and reference volume V0 \[L^d\].
    pub velocity: Vec<[f64; 4]>,
    /// Displacement of the step under way \[L\]; the last entry is unused.
    pub displacement: Vec<[f64; 4]>,
    /// x0, y0, z0 \[L\] and mass \[M\], in total Lagrangian methods; otherwise empty.
    pub reference: Vec<[f64; 4]>,
    /// Columns of the matrix \[1/T\] that P2G reads around a particle (C of affine transfers, L of
    /// `gradient-enhanced`): as many as dimensions, or all empty.
    pub matrix: [Vec<[f64; 4]>; 3],
    /// Records \[L\] of the domain of each particle that its weights depend on, as many as the
    /// footprint has: half sizes of `gimp`, half edges or corners of CPDI; the others are empty.
    pub domain: [Vec<[f64; 4]>; DOMAIN_RECORDS],
    /// What the step under way adds to the records of domains \[L\]; empty where they stay.
    pub carried: [Vec<[f64; 4]>; DOMAIN_RECORDS],
    /// Optional scalar columns, in the order of [`Column`]; an absent one is empty.
    pub columns: Vec<Vec<f64>>,
    /// Global ids from 1.
    pub id: Vec<u32>,
    /// Number of the solid, from 0.
    pub solid: Vec<u16>,
    /// Group membership: bit `b` is bit `b % 64` of word column `b / 64`.
    pub masks: Vec<Vec<u64>>,
    /// The columns that exist.
    pub present: ColumnSet,
    /// Particles at the end of the table that every process still has: those read from a restart
    /// file, until a sort deals them out.
    pub undealt: usize,
    /// Another process counts those.
    pub counted_elsewhere: bool,
}

impl Particles {
    /// An empty table.
    pub fn new() -> Self {
        Self { columns: vec![Vec::new(); COLUMNS], ..Self::default() }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Places in the table of the particles that this process counts in sums over all: its own.
    pub fn counted(&self) -> std::ops::Range<usize> {
        0..self.len() - if self.counted_elsewhere { self.undealt } else { 0 }
    }

    /// Is there no particle?
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// Adds the columns of `set` that are absent, with their initial values.
    pub fn require(&mut self, set: ColumnSet) {
        for column in set.iter().filter(|column| !self.present.contains(*column)) {
            self.columns[column as usize] = vec![column.info().initial; self.id.len()];
        }
        for column in set.iter() {
            self.present.insert(column);
        }
    }

    /// Adds the records of total Lagrangian methods.
    pub fn require_reference(&mut self) {
        let place = |p: usize| {
            let [x, y, z] = self.reference_place(p);
            [x, y, z, self.position[p][3]]
        };
        if self.reference.len() != self.len() {
            self.reference = (0..self.len()).map(place).collect();
        }
    }

    /// Adds the columns of the matrix around each particle, or removes them.
    pub fn require_matrix(&mut self, columns: usize) {
        let count = self.len();
        for (number, records) in self.matrix.iter_mut().enumerate() {
            records.resize(if number < columns { count } else { 0 }, [0.0; 4]);
        }
    }

    /// Gives the particles that have none yet the records of their domains, `count` of them; `of`
    /// says which.
    pub fn add_domains(
        &mut self,
        count: usize,
        of: impl Fn(&Self, usize) -> [[f64; 4]; DOMAIN_RECORDS],
    ) {
        let known = if count > 0 { self.domain[0].len() } else { self.id.len() };
        for p in known..self.id.len() {
            let records = of(self, p);
            for (record, value) in self.domain.iter_mut().zip(records).take(count) {
                record.push(value);
            }
        }
    }

    /// Room for what a step adds to so many records of each domain.
    pub fn require_carried(&mut self, count: usize) {
        let len = self.id.len();
        for (number, record) in self.carried.iter_mut().enumerate() {
            record.resize(if number < count { len } else { 0 }, [0.0; 4]);
        }
    }

    /// All records that exist.
    pub fn records_mut(&mut self) -> impl Iterator<Item = &mut Vec<[f64; 4]>> {
        self.all_records_mut().filter(|records| !records.is_empty())
    }

    /// All records, those that do not exist too.
    pub fn all_records_mut(&mut self) -> impl Iterator<Item = &mut Vec<[f64; 4]>> {
        [&mut self.position, &mut self.velocity, &mut self.displacement, &mut self.reference]
            .into_iter()
            .chain(&mut self.matrix)
            .chain(&mut self.domain)
            .chain(&mut self.carried)
    }

    /// The places that weights belong to: x0, y0, z0 in total Lagrangian methods, else x, y, z.
    #[inline(always)]
    pub fn places(&self, total: bool) -> &[[f64; 4]] {
        if total { &self.reference } else { &self.position }
    }

    /// Reference position of a particle \[L\].
    pub fn reference_place(&self, particle: usize) -> [f64; 3] {
        [Column::X0, Column::Y0, Column::Z0]
            .map(|column| self.column(column).get(particle).copied().unwrap_or(0.0))
    }

    /// A column; empty where it is absent.
    pub fn column(&self, column: Column) -> &[f64] {
        &self.columns[column as usize]
    }

    /// A column to write; empty where it is absent.
    pub fn column_mut(&mut self, column: Column) -> &mut [f64] {
        &mut self.columns[column as usize]
    }

    /// Appends a particle with initial values in its columns.
    pub fn push(&mut self, id: u32, solid: u16, place: [f64; 3], mass: f64, volume: f64) {
        self.position.push([place[0], place[1], place[2], mass]);
        self.velocity.push([0.0, 0.0, 0.0, volume]);
        self.displacement.push([0.0; 4]);
        self.id.push(id);
        self.solid.push(solid);
        for words in &mut self.masks {
            words.push(0);
        }
        for column in self.present.iter() {
            let value = match column {
                Column::X0 => place[0],
                Column::Y0 => place[1],
                Column::Z0 => place[2],
                _ => column.info().initial,
            };
            self.columns[column as usize].push(value);
        }
    }

    /// Makes room for `count` more particles.
    pub fn reserve(&mut self, count: usize) {
        self.position.reserve(count);
        self.velocity.reserve(count);
        self.displacement.reserve(count);
        self.id.reserve(count);
        self.solid.reserve(count);
        for column in self.present.iter() {
            self.columns[column as usize].reserve(count);
        }
    }

    /// Room for the group of bit `bit`.
    pub fn require_mask(&mut self, bit: usize) {
        while self.masks.len() <= bit / 64 {
            self.masks.push(vec![0; self.id.len()]);
        }
    }

    /// Puts a particle into the group of bit `bit`.
    pub fn join(&mut self, particle: usize, bit: usize) {
        self.require_mask(bit);
        self.masks[bit / 64][particle] |= 1 << (bit % 64);
    }

    /// Is the particle in the group? Node groups hold no particle.
    pub fn belongs(&self, particle: usize, members: &Members) -> bool {
        match members {
            Members::All => true,
            Members::Particles { bit } => {
                self.masks.get(bit / 64).is_some_and(|words| words[particle] >> (bit % 64) & 1 == 1)
            }
            Members::Nodes { .. } => false,
        }
    }

    /// Indices of the particles of a group that this process counts, in storage order.
    pub fn of_group<'a>(
        &'a self,
        groups: &'a Groups,
        group: GroupId,
    ) -> impl Iterator<Item = usize> + 'a {
        let members = &groups[group].members;
        self.counted().filter(move |particle| self.belongs(*particle, members))
    }

    /// Removes the particles for which `keep` is false; the order of the others stays.
    pub fn retain(&mut self, keep: &[bool]) {
        fn filter<T>(column: &mut Vec<T>, keep: &[bool]) {
            let mut flags = keep.iter();
            column.retain(|_| flags.next().copied().unwrap_or(true));
        }
        let dealt = self.len() - self.undealt;
        self.undealt = keep[dealt..].iter().filter(|keep| **keep).count();
        for records in self.records_mut() {
            filter(records, keep);
        }
        filter(&mut self.id, keep);
        filter(&mut self.solid, keep);
        for column in self.columns.iter_mut().filter(|column| !column.is_empty()) {
            filter(column, keep);
        }
        for words in &mut self.masks {
            filter(words, keep);
        }
    }

    /// Puts all columns into a checkpoint, or takes them from there. What a step adds to domains
    /// does not outlive it.
    pub fn keep(&mut self, checkpoint: &mut Checkpoint) {
        checkpoint.column("id", &mut self.id);
        checkpoint.column("solid", &mut self.solid);
        checkpoint.records("position", &mut self.position);
        checkpoint.records("velocity", &mut self.velocity);
        checkpoint.records("displacement", &mut self.displacement);
        checkpoint.records("reference", &mut self.reference);
        for (number, records) in self.matrix.iter_mut().enumerate() {
            checkpoint.records(&format!("matrix{number}"), records);
        }
        for (number, records) in self.domain.iter_mut().enumerate() {
            checkpoint.records(&format!("domain{number}"), records);
        }
        for column in Column::ALL {
            checkpoint.column(column.info().name, &mut self.columns[column as usize]);
        }
        let mut count = self.masks.len() as u64;
        checkpoint.number("groups", &mut count);
        self.masks.resize(count.min(MOST_MASKS) as usize, Vec::new());
        for (number, words) in self.masks.iter_mut().enumerate() {
            checkpoint.column(&format!("groups{number}"), words);
        }
        if checkpoint.is_loading() {
            self.carried = Default::default();
            self.undealt = self.id.len();
            self.present = ColumnSet::default();
            let there = |column: &Column| !self.columns[*column as usize].is_empty();
            self.present.extend(&Column::ALL.into_iter().filter(there).collect::<Vec<_>>());
            if !self.is_even() {
                checkpoint.refuse("the columns of the particles differ in length");
            }
        }
    }

    /// Has every column one row for each particle, or none?
    fn is_even(&mut self) -> bool {
        let count = self.len();
        let all = [self.position.len(), self.velocity.len(), self.displacement.len()];
        let same = |length: usize| length == count;
        all.into_iter().chain([self.solid.len()]).all(same)
            && self.records_mut().all(|records| same(records.len()))
            && self.masks.iter().all(|words| same(words.len()))
            && self.columns.iter().all(|column| column.is_empty() || same(column.len()))
    }

    /// Bytes that one particle takes.
    pub fn bytes_each(&self) -> usize {
        let records = 3
            + usize::from(!self.reference.is_empty())
            + self
                .matrix
                .iter()
                .chain(&self.domain)
                .chain(&self.carried)
                .filter(|r| !r.is_empty())
                .count();
        records * 32 + 8 * self.present.iter().count() + 4 + 2 + 8 * self.masks.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_grow_and_shrink_together() {
        let mut set = ColumnSet::default();
        set.extend(&[Column::X0, Column::F11]);
        let mut particles = Particles::new();
        particles.require(set);
        for id in 1..=3 {
            particles.push(id, 0, [id as f64, 0.0, 0.0], 1.0, 2.0);
        }
        particles.join(2, 70);
        particles.retain(&[true, false, true]);
        assert_eq!(particles.id, [1, 3]);
        assert_eq!(particles.column(Column::X0), [1.0, 3.0]);
        assert_eq!(particles.column(Column::F11), [1.0, 1.0]);
        assert!(particles.belongs(1, &Members::Particles { bit: 70 }));
        assert!(!particles.belongs(0, &Members::Particles { bit: 70 }));
    }
}
