//! Nodes that particles of several processes reach, and how their sums pass from one to the next.
//!
//! Tiles of one colour share no node. So after each colour the process whose tile has added to a
//! node knows its sum so far, and sends it to the others, which put it in the place of theirs. After
//! the last colour all have what one process alone would have, bit for bit, in as many messages as
//! there are colours with tiles at the border. Tiles at borders are done first and the others while
//! messages are under way.

use super::deal::Deal;
use super::shared::Shared;
use super::sort::Reach;
use super::tiles::{COLOURS, Order};
use crate::model::grid::{Grid, Node};
use crate::model::lattice::Lattice;
use crate::parallel::{Exchange, Parcel, Ranks};
use std::ops::Range;

/// Numbers that stand on a node.
pub trait Record {
    /// How many.
    const WIDTH: usize;

    /// Appends them.
    fn put(&self, out: &mut Vec<f64>);

    /// Takes them over.
    fn take(&mut self, numbers: &[f64]);
}

impl Record for f64 {
    const WIDTH: usize = 1;

    fn put(&self, out: &mut Vec<f64>) {
        out.push(*self);
    }

    fn take(&mut self, numbers: &[f64]) {
        *self = numbers[0];
    }
}

impl Record for [f64; 4] {
    const WIDTH: usize = 4;

    fn put(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(self);
    }

    fn take(&mut self, numbers: &[f64]) {
        self.copy_from_slice(numbers);
    }
}

impl Record for Node {
    const WIDTH: usize = 7;

    fn put(&self, out: &mut Vec<f64>) {
        out.extend_from_slice(&self.motion);
        out.extend_from_slice(&self.change[..3]);
    }

    fn take(&mut self, numbers: &[f64]) {
        self.motion.copy_from_slice(&numbers[..4]);
        self.change[..3].copy_from_slice(&numbers[4..]);
    }
}

/// An array over nodes to which a sweep adds.
pub trait NodeArray: Sync {
    /// Numbers on each node.
    fn width(&self) -> usize;

    /// Appends those of a node.
    ///
    /// # Safety
    /// Nobody writes to the node meanwhile.
    unsafe fn put(&self, node: usize, out: &mut Vec<f64>);

    /// Replaces those of a node.
    ///
    /// # Safety
    /// Nobody uses the node meanwhile.
    unsafe fn take(&self, node: usize, numbers: &[f64]);
}

impl<T: Record + Send> NodeArray for Shared<'_, T> {
    fn width(&self) -> usize {
        if self.is_empty() { 0 } else { T::WIDTH }
    }

    unsafe fn put(&self, node: usize, out: &mut Vec<f64>) {
        if !self.is_empty() {
            // SAFETY: the caller promises that nobody writes to the node.
            unsafe { self.part(node..node + 1)[0].put(out) }
        }
    }

    unsafe fn take(&self, node: usize, numbers: &[f64]) {
        if !self.is_empty() {
            // SAFETY: the caller promises that nobody uses the node.
            unsafe { self.part(node..node + 1)[0].take(numbers) }
        }
    }
}

/// A process with which nodes are shared.
#[derive(Clone, Debug, Default)]
struct Peer {
    rank: usize,
    /// Nodes that a tile of this process reaches, by colour of the tile, as places in memory.
    sent: [Vec<u32>; COLOURS],
    /// Nodes that a tile of the other reaches.
    received: [Vec<u32>; COLOURS],
}

/// The shared nodes of this process; empty if there is one process.
#[derive(Clone, Default)]
pub struct Ghosts {
    ranks: Ranks,
    peers: Vec<Peer>,
    /// Tiles at borders and the others, by colour.
    pub tiles: [[Vec<u32>; 2]; COLOURS],
    sent: Vec<Parcel>,
    received: Vec<Parcel>,
    /// What has been sent.
    pub traffic: Traffic,
}

/// What a process has sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Traffic {
    /// Sweeps that added to nodes.
    pub sweeps: usize,
    /// Messages.
    pub messages: usize,
    /// Nodes in them.
    pub nodes: usize,
    /// Bytes.
    pub bytes: usize,
}

/// A tile of this process.
pub struct OwnTile {
    /// Number of its lattice.
    pub lattice: usize,
    /// Its index on both axes.
    pub index: [usize; 2],
    /// Its colour.
    pub colour: usize,
}

impl OwnTile {
    /// Columns of nodes that its particles can reach before the next sort, on the first two axes from
    /// the start of the window.
    pub fn columns(&self, lattice: &Lattice, order: &Order, reach: &Reach) -> [Range<usize>; 2] {
        let counts = lattice.cells.cells();
        [0, 1].map(|axis| {
            let (lower, size) = (lattice.window.lower[axis], lattice.window.size[axis]);
            if axis >= lattice.cells.dimension {
                return 0..size;
            }
            let [first, last] = reach.nodes(order.cells_of(self.index, axis), counts[axis]);
            first.saturating_sub(lower).min(size)..(last + 1).saturating_sub(lower).min(size)
        })
    }
}

/// Where tiles are, what they reach and whose they are.
pub struct Layout<'a> {
    /// The order of cells of each lattice.
    pub orders: &'a [Order],
    /// What the particles of a tile can reach.
    pub reach: &'a Reach,
    /// Who owns which tiles.
    pub deal: &'a Deal,
}

/// Which tiles reach a column of nodes along the last axis: a bit for each colour.
struct Columns {
    /// Of each lattice, over its window.
    marks: Vec<Vec<u8>>,
}

impl Columns {
    fn new(lattices: &[Lattice]) -> Self {
        let size = |lattice: &Lattice| lattice.window.size[0] * lattice.window.size[1];
        Self { marks: lattices.iter().map(|lattice| vec![0; size(lattice)]).collect() }
    }

    /// Marks the columns that a tile reaches.
    fn mark(&mut self, lattices: &[Lattice], tile: &OwnTile, order: &Order, reach: &Reach) {
        let lattice = &lattices[tile.lattice];
        let [across, along] = tile.columns(lattice, order, reach);
        for i in across {
            for j in along.clone() {
                self.marks[tile.lattice][i * lattice.window.size[1] + j] |= 1 << tile.colour;
            }
        }
    }

    /// The marks of a node of a lattice.
    fn of(&self, number: usize, lattice: &Lattice, node: [usize; 3]) -> u8 {
        let [i, j] = [0, 1].map(|axis| node[axis] - lattice.window.lower[axis]);
        self.marks[number][i * lattice.window.size[1] + j]
    }
}

/// A node in a letter: number of its lattice and its number there, and which tiles of the sender
/// reach it.
#[derive(Clone, Copy, PartialEq)]
struct Known {
    key: u64,
    marks: u8,
    /// Place in memory of the sender.
    place: u32,
}

/// Bit of the marks: particles of the sender reach the node.
const REACHED: u8 = 1 << 7;

const KNOWN_BYTES: usize = 9;

fn write(list: &[Known]) -> Vec<u8> {
    let mut letter = Vec::with_capacity(KNOWN_BYTES * list.len());
    for known in list {
        letter.extend_from_slice(&known.key.to_le_bytes());
        letter.push(known.marks);
    }
    letter
}

fn read(letter: &[u8]) -> impl Iterator<Item = (u64, u8)> {
    letter
        .as_chunks::<KNOWN_BYTES>()
        .0
        .iter()
        .map(|[key @ .., marks]| (u64::from_le_bytes(*key), *marks))
}

impl Ghosts {
    /// Do sweeps run here alone?
    pub fn is_alone(&self) -> bool {
        self.ranks.is_alone()
    }

    /// Finds the nodes that this process shares with others, and which of them it counts.
    /// `reached`: nodes that its own particles reach, if others are in memory too; afterwards those
    /// that particles of any process reach.
    pub fn find(
        &mut self,
        ranks: &Ranks,
        grid: &mut Grid,
        own: &[OwnTile],
        layout: &Layout<'_>,
        reached: &mut [bool],
    ) {
        self.ranks = ranks.clone();
        grid.counted_elsewhere.clear();
        let Some(exchange) = ranks.exchange() else { return };
        let (lattices, Layout { orders, reach, deal }) = (&grid.lattices, layout);
        let mut here = Columns::new(lattices);
        let mut borders: Vec<(usize, Columns)> = Vec::new();
        self.tiles = Default::default();
        for (number, tile) in own.iter().enumerate() {
            let order = &orders[tile.lattice];
            here.mark(lattices, tile, order, reach);
            let mut others: Vec<usize> = neighbours(tile.index)
                .map(|index| deal.owner(tile.lattice, index))
                .filter(|rank| *rank != exchange.rank())
                .collect();
            others.sort_unstable();
            others.dedup();
            self.tiles[tile.colour][usize::from(others.is_empty())].push(number as u32);
            for rank in others {
                let place = borders.iter().position(|(known, _)| *known == rank);
                let place = place.unwrap_or_else(|| {
                    borders.push((rank, Columns::new(lattices)));
                    borders.len() - 1
                });
                // All lattices over one box share their tiles, and contact looks at all of them.
                for lattice in 0..lattices.len() {
                    if lattice == tile.lattice || !reached.is_empty() {
                        let tile = OwnTile { lattice, ..*tile };
                        borders[place].1.mark(lattices, &tile, &orders[lattice], reach);
                    }
                }
            }
        }
        let lists = list_borders(exchange, grid, &here, &borders, reached);
        let letters = exchange.swap(lists.iter().map(|list| write(list)).collect());
        grid.counted_elsewhere.resize(grid.nodes.len(), false);
        self.peers.clear();
        for (rank, (list, letter)) in lists.iter().zip(&letters).enumerate() {
            if rank == exchange.rank() || list.is_empty() || letter.is_empty() {
                continue;
            }
            let mut peer = Peer { rank, ..Peer::default() };
            for (known, theirs) in common(list, letter) {
                for colour in 0..COLOURS {
                    if known.marks >> colour & 1 == 1 {
                        peer.sent[colour].push(known.place);
                    }
                    if theirs >> colour & 1 == 1 {
                        peer.received[colour].push(known.place);
                    }
                }
                grid.counted_elsewhere[known.place as usize] |= rank < exchange.rank();
                if let Some(reached) = reached.get_mut(known.place as usize) {
                    *reached |= theirs & REACHED != 0;
                }
            }
            self.peers.push(peer);
        }
    }

    /// Sends what this process knows after a colour and takes what others know, with work done
    /// meanwhile.
    pub fn pass(&mut self, colour: usize, arrays: &[&dyn NodeArray], meanwhile: &mut dyn FnMut()) {
        let Self { ranks, peers, sent, received, traffic, .. } = self;
        traffic.sweeps += usize::from(colour == 0);
        let Some(exchange) = ranks.exchange() else { return meanwhile() };
        let width: usize = arrays.iter().map(|array| array.width()).sum();
        let outgoing = peers.iter().filter(|peer| !peer.sent[colour].is_empty());
        let coming = || peers.iter().filter(|peer| !peer.received[colour].is_empty());
        sent.resize_with(outgoing.clone().count(), Parcel::default);
        received.resize_with(coming().count(), Parcel::default);
        for (parcel, peer) in sent.iter_mut().zip(outgoing) {
            traffic.messages += 1;
            traffic.nodes += peer.sent[colour].len();
            traffic.bytes += 8 * width * peer.sent[colour].len();
            parcel.rank = peer.rank;
            parcel.numbers.clear();
            for node in &peer.sent[colour] {
                for array in arrays {
                    // SAFETY: tiles that reach the node are done, others have not begun.
                    unsafe { array.put(*node as usize, &mut parcel.numbers) };
                }
            }
        }
        for (parcel, peer) in received.iter_mut().zip(coming()) {
            parcel.rank = peer.rank;
            parcel.numbers.resize(width * peer.received[colour].len(), 0.0);
        }
        exchange.trade(sent, received, meanwhile);
        for (parcel, peer) in received.iter().zip(coming()) {
            let mut numbers = &parcel.numbers[..];
            for node in &peer.received[colour] {
                for array in arrays {
                    let (these, rest) = numbers.split_at(array.width());
                    // SAFETY: all tiles of the colour are done.
                    unsafe { array.take(*node as usize, these) };
                    numbers = rest;
                }
            }
        }
    }
}

/// The eight tiles around one; beyond the border of the lattice nobody has particles.
fn neighbours([x, y]: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
    let around = move |k: usize| (x + k / 3).checked_sub(1).zip((y + k % 3).checked_sub(1));
    (0..9).filter(|k| *k != 4).filter_map(around).map(|(x, y)| [x, y])
}

/// The active nodes that tiles beside those of other processes reach, by rank.
fn list_borders(
    exchange: &dyn Exchange,
    grid: &Grid,
    here: &Columns,
    borders: &[(usize, Columns)],
    reached: &[bool],
) -> Vec<Vec<Known>> {
    let mut lists = vec![Vec::new(); exchange.size()];
    let mut active = grid.runs.iter().cloned().flatten().peekable();
    for (number, lattice) in grid.lattices.iter().enumerate() {
        while let Some(place) = active.next_if(|place| *place < lattice.window.places().end) {
            let node = lattice.window.node(place);
            let own = reached.get(place).is_none_or(|reached| *reached);
            let marks = here.of(number, lattice, node) | if own { REACHED } else { 0 };
            let key = (number as u64) << 48 | lattice.number(node);
            for (rank, columns) in borders {
                if columns.of(number, lattice, node) != 0 {
                    lists[*rank].push(Known { key, marks, place: place as u32 });
                }
            }
        }
    }
    lists
}

/// The nodes of a list that stand in a letter too, with the marks there; both ascend.
fn common<'a>(list: &'a [Known], letter: &'a [u8]) -> impl Iterator<Item = (&'a Known, u8)> {
    let mut theirs = read(letter).peekable();
    list.iter().filter_map(move |known| {
        while theirs.next_if(|(key, _)| *key < known.key).is_some() {}
        theirs.next_if(|(key, _)| *key == known.key).map(|(_, marks)| (known, marks))
    })
}
