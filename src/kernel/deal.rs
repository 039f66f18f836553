//! Dealing particles out to processes: each has the particles of its tiles.

use super::tiles::Order;
use crate::model::lattice::Lattice;
use crate::model::particles::Particles;
use crate::parallel::partition::{Census, Partition, imbalance};
use crate::parallel::{Exchange, Ranks};
use crate::world::Solid;

/// Tiles are dealt out anew when the fullest process has so many times the mean number of particles,
/// and so much more than when they were dealt out last.
const UNEVEN: f64 = 1.1;

/// Who owns which tiles.
#[derive(Default)]
pub struct Deal {
    /// Of each lattice; lattices over one box share theirs.
    partitions: Vec<Partition>,
    /// Cells along a side of a tile when they were dealt out.
    side: usize,
    /// Imbalance when they were dealt out.
    imbalance: f64,
    /// Where each particle goes; empty if there is one process.
    owners: Vec<u32>,
    /// The number of this process.
    own: u32,
}

/// What the sort knows of the particles.
pub struct Scene<'a> {
    /// The order of cells of each lattice.
    pub orders: &'a [Order],
    /// The lattices.
    pub lattices: &'a [Lattice],
    /// The solids.
    pub solids: &'a [Solid],
    /// Particles belong to reference places, each solid to a lattice of its own.
    pub total: bool,
    /// Cells along a side of a tile.
    pub side: usize,
    /// The cells of an earlier sort, which count in place of those of the places.
    pub cells: Option<&'a [[u32; 3]]>,
}

impl Scene<'_> {
    /// Lattice and tile of a particle.
    fn tile(&self, particles: &Particles, p: usize) -> (usize, [usize; 2]) {
        let lattice = self.solids[particles.solid[p] as usize].lattice;
        let order = &self.orders[lattice];
        let (cells, places) = (&self.lattices[lattice].cells, particles.places(self.total));
        let cell = order.sorted_cell(cells, places, self.cells, p);
        (lattice, order.tile_of(cell))
    }
}

impl Deal {
    /// The process that owns a tile of a lattice.
    pub fn owner(&self, lattice: usize, tile: [usize; 2]) -> usize {
        self.partitions[lattice.min(self.partitions.len() - 1)].owner(tile)
    }

    /// Brings every particle to the process that owns its tile.
    pub fn deal(&mut self, particles: &mut Particles, scene: &Scene<'_>, ranks: &Ranks) {
        self.owners.clear();
        let Some(exchange) = ranks.exchange() else { return };
        self.divide(particles, scene, exchange);
        self.own = exchange.rank() as u32;
        for p in 0..particles.len() {
            let (lattice, tile) = scene.tile(particles, p);
            let owner = self.owner(lattice, tile);
            self.owners.push(owner as u32);
        }
        let dealt = particles.len() - particles.undealt;
        let own = self.own;
        let exist = present_records(particles, ranks);
        let mut places = vec![Vec::new(); exchange.size()];
        for (p, owner) in self.owners[..dealt].iter().enumerate().filter(|(_, r)| **r != own) {
            places[*owner as usize].push(p);
        }
        let letters: Vec<Vec<u8>> =
            places.iter().map(|places| pack(particles, &exist, places)).collect();
        let keep: Vec<bool> = self.owners.iter().map(|owner| *owner == own).collect();
        particles.retain(&keep);
        for letter in exchange.swap(letters) {
            unpack(particles, &exist, &letter);
        }
        particles.undealt = 0;
    }

    /// Of what stands for each particle in all processes, that which stayed here.
    pub fn kept<T: Copy>(&self, all: &[T]) -> Vec<T> {
        match self.owners.is_empty() {
            true => all.to_vec(),
            false => {
                let pairs = all.iter().zip(&self.owners);
                pairs.filter(|(_, owner)| **owner == self.own).map(|(one, _)| *one).collect()
            }
        }
    }

    /// Particles of each process whose tiles have been dealt out.
    fn loads(&self, particles: &Particles, scene: &Scene<'_>, exchange: &dyn Exchange) -> Vec<i64> {
        let known = |solid: &u16| {
            !scene.total || scene.solids[*solid as usize].lattice < self.partitions.len()
        };
        let dealt = &particles.solid[..particles.len() - particles.undealt];
        let mut loads = vec![0; exchange.size()];
        loads[exchange.rank()] = dealt.iter().filter(|solid| known(solid)).count() as i64;
        exchange.sum(&mut loads);
        loads
    }

    /// Deals tiles out, the first time or anew.
    fn divide(&mut self, particles: &Particles, scene: &Scene<'_>, exchange: &dyn Exchange) {
        let trees = if scene.total { scene.lattices.len() } else { 1 };
        if self.side != scene.side {
            self.partitions.clear();
            self.side = scene.side;
        }
        let mut loads = self.loads(particles, scene, exchange);
        let fresh = particles.undealt > 0 && particles.undealt == particles.len();
        if !scene.total {
            let now = imbalance(&loads);
            if fresh || self.partitions.is_empty() || now > UNEVEN * self.imbalance.max(1.0) {
                self.partitions.clear();
                loads.fill(0);
            }
        }
        // Nodes of solids with lattices of their own remember where they are, and so stay.
        for tree in self.partitions.len()..trees {
            let of = if scene.total { Some(tree) } else { None };
            let census = take_census(particles, scene, of, exchange);
            self.partitions.push(Partition::new(&census, &mut loads));
            self.imbalance = imbalance(&loads);
        }
    }
}

/// Counts the particles of every tile of a lattice (`None`: of all), over all processes.
fn take_census(
    particles: &Particles,
    scene: &Scene<'_>,
    of: Option<usize>,
    exchange: &dyn Exchange,
) -> Census {
    let tiles = || {
        let all = particles.counted().map(|p| scene.tile(particles, p));
        all.filter(move |(lattice, _)| of.is_none_or(|of| of == *lattice)).map(|(_, tile)| tile)
    };
    let mut limits = [f64::NEG_INFINITY; 4];
    for [x, y] in tiles().map(|tile| tile.map(|number| number as f64)) {
        for (limit, number) in limits.iter_mut().zip([-x, -y, x, y]) {
            *limit = limit.max(number);
        }
    }
    exchange.largest(&mut limits);
    if limits[0] == f64::NEG_INFINITY {
        return Census::default();
    }
    let lower = [0, 1].map(|axis| -limits[axis] as usize);
    let size = [0, 1].map(|axis| limits[2 + axis] as usize + 1 - lower[axis]);
    let mut census = Census::of_none(lower, size);
    tiles().for_each(|tile| census.add(tile, 1));
    exchange.sum(&mut census.counts);
    census
}

/// Which records of particles exist: a process without particles cannot tell by itself.
pub fn present_records(particles: &mut Particles, ranks: &Ranks) -> Vec<bool> {
    let mut exist: Vec<f64> =
        particles.all_records_mut().map(|records| f64::from(!records.is_empty())).collect();
    if let Some(exchange) = ranks.exchange() {
        exchange.largest(&mut exist);
    }
    exist.into_iter().map(|any| any > 0.0).collect()
}

/// All data of some particles, column by column, 8 bytes each.
pub fn pack(particles: &mut Particles, exist: &[bool], places: &[usize]) -> Vec<u8> {
    let each = 2 + particles.masks.len() + particles.present.iter().count() + 4 * exist.len();
    let mut letter = Vec::with_capacity(8 * each * places.len());
    let mut put = |word: u64| letter.extend_from_slice(&word.to_le_bytes());
    places.iter().for_each(|p| put(u64::from(particles.id[*p])));
    places.iter().for_each(|p| put(u64::from(particles.solid[*p])));
    for words in &particles.masks {
        places.iter().for_each(|p| put(words[*p]));
    }
    for column in particles.present.iter().map(|column| particles.column(column)) {
        places.iter().for_each(|p| put(column[*p].to_bits()));
    }
    for (records, _) in particles.all_records_mut().zip(exist).filter(|(_, exist)| **exist) {
        for number in places.iter().flat_map(|p| records[*p]) {
            put(number.to_bits());
        }
    }
    letter
}

/// Appends the particles of a letter.
pub fn unpack(particles: &mut Particles, exist: &[bool], letter: &[u8]) {
    let present = particles.present;
    let records = exist.iter().filter(|exist| **exist).count();
    let each = 2 + particles.masks.len() + present.iter().count() + 4 * records;
    let count = letter.len() / (8 * each);
    let mut words = letter.as_chunks::<8>().0.iter().map(|bytes| u64::from_le_bytes(*bytes));
    particles.id.extend(words.by_ref().take(count).map(|word| word as u32));
    particles.solid.extend(words.by_ref().take(count).map(|word| word as u16));
    for masks in &mut particles.masks {
        masks.extend(words.by_ref().take(count));
    }
    for column in present.iter() {
        let column = &mut particles.columns[column as usize];
        column.extend(words.by_ref().take(count).map(f64::from_bits));
    }
    for (records, _) in particles.all_records_mut().zip(exist).filter(|(_, exist)| **exist) {
        for _ in 0..count {
            let mut record = [0.0; 4];
            for (number, word) in record.iter_mut().zip(words.by_ref()) {
                *number = f64::from_bits(word);
            }
            records.push(record);
        }
    }
}
