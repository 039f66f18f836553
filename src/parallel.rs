//! The processes of a run and what they say to each other.
//!
//! Every process runs the same script. Particles are dealt out by tile (`kernel::deal`);
//! a node that particles of several processes reach has its sums made tile by tile in one order, so
//! that results have the same bits for any number of processes. Everything else a process must know
//! of the others passes through the few collective calls of [`Ranks`].

#[cfg(feature = "mpi")]
pub mod message_passing;
pub mod partition;

use crate::fault::{Fault, FaultKind};
use crate::math::exact_sum::{ExactSum, VectorSum};
use std::sync::{Arc, Mutex, PoisonError};

/// Numbers for or from another process.
#[derive(Clone, Debug, Default)]
pub struct Parcel {
    /// The other process.
    pub rank: usize,
    /// The numbers.
    pub numbers: Vec<f64>,
}

/// Calls that all processes make together, in the same order.
pub trait Exchange: Send + Sync {
    /// Number of this process, from 0.
    fn rank(&self) -> usize;

    /// Number of processes.
    fn size(&self) -> usize;

    /// Number of processes on this machine.
    fn neighbours(&self) -> usize;

    /// Adds up each word over all processes.
    fn sum(&self, words: &mut [i64]);

    /// Finds the largest of each number over all processes; none may be NaN.
    fn largest(&self, numbers: &mut [f64]);

    /// Gives everybody the bytes of process `root`.
    fn broadcast(&self, root: usize, bytes: &mut Vec<u8>);

    /// Brings the bytes of all to process 0, by rank; the others get nothing.
    fn gather(&self, bytes: &[u8]) -> Vec<Vec<u8>>;

    /// Brings the parts of all to process 0, which takes them piece by piece in the order of ranks,
    /// without having them all in memory.
    fn collect(&self, parts: &[Vec<u8>], take: &mut dyn FnMut(&[u8]));

    /// Gives everybody the numbers of all, one after the other by rank.
    fn share(&self, numbers: &[f64]) -> Vec<f64>;

    /// Sends `letters[r]` to process r; gives what came from each.
    fn swap(&self, letters: Vec<Vec<u8>>) -> Vec<Vec<u8>>;

    /// Sends and receives parcels of known sizes, with work done meanwhile.
    fn trade(&self, sent: &[Parcel], received: &mut [Parcel], meanwhile: &mut dyn FnMut());

    /// Ends all processes at once.
    fn abort(&self, code: i32) -> !;
}

/// The processes of a run; by default there is one.
#[derive(Clone, Default)]
pub struct Ranks(Option<Arc<Several>>);

struct Several {
    exchange: Arc<dyn Exchange>,
    /// What they agree on at the end of a step; kept, so that a step allocates nothing.
    numbers: Mutex<Vec<f64>>,
}

impl std::fmt::Debug for Ranks {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "process {} of {}", self.rank(), self.size())
    }
}

impl Ranks {
    /// Several processes.
    pub fn new(exchange: Arc<dyn Exchange>) -> Self {
        let several = |exchange| Arc::new(Several { exchange, numbers: Mutex::default() });
        Self((exchange.size() > 1).then(|| several(exchange)))
    }

    /// How several processes talk; `None` if there is one.
    pub fn exchange(&self) -> Option<&dyn Exchange> {
        self.0.as_ref().map(|several| &*several.exchange)
    }

    /// Is there one process?
    pub fn is_alone(&self) -> bool {
        self.0.is_none()
    }

    /// Number of this process, from 0.
    pub fn rank(&self) -> usize {
        self.exchange().map_or(0, |exchange| exchange.rank())
    }

    /// Number of processes.
    pub fn size(&self) -> usize {
        self.exchange().map_or(1, |exchange| exchange.size())
    }

    /// Does this process write files and speak to the user?
    pub fn is_first(&self) -> bool {
        self.rank() == 0
    }

    /// The values of sums over all processes.
    pub fn totals<const N: usize>(&self, sums: [&ExactSum; N]) -> [f64; N] {
        let Some(exchange) = self.exchange() else { return sums.map(ExactSum::value) };
        let mut words: Vec<i64> = sums.iter().flat_map(|sum| sum.words()).collect();
        exchange.sum(&mut words);
        let (each, _) = words.as_chunks::<{ ExactSum::WORDS }>();
        let mut each = each.iter();
        sums.map(|_| each.next().map_or(0.0, |words| ExactSum::from_words(words).value()))
    }

    /// The value of one sum over all processes.
    pub fn total(&self, sum: &ExactSum) -> f64 {
        let [value] = self.totals([sum]);
        value
    }

    /// The value of a sum of vectors over all processes.
    pub fn vector(&self, sum: &VectorSum) -> [f64; 3] {
        self.totals(sum.0.each_ref())
    }

    /// Counts over all processes.
    pub fn count<const N: usize>(&self, counts: [usize; N]) -> [usize; N] {
        let Some(exchange) = self.exchange() else { return counts };
        let mut words = counts.map(|count| count as i64);
        exchange.sum(&mut words);
        words.map(|count| count as usize)
    }

    /// The largest of each number over all processes; none may be NaN.
    pub fn largest<const N: usize>(&self, mut numbers: [f64; N]) -> [f64; N] {
        if let Some(exchange) = self.exchange() {
            exchange.largest(&mut numbers);
        }
        numbers
    }

    /// The numbers of all processes one after the other, by rank.
    pub fn share(&self, numbers: &[f64]) -> Vec<f64> {
        match self.exchange() {
            Some(exchange) => exchange.share(numbers),
            None => numbers.to_vec(),
        }
    }

    /// Is it true for any process?
    pub fn any(&self, here: bool) -> bool {
        let [any] = self.largest([f64::from(here)]);
        any > 0.0
    }

    /// The fault of the lowest rank that has one becomes everybody's; the numbers become the largest
    /// of all (none may be NaN).
    ///
    /// # Errors
    /// The fault.
    pub fn agree(&self, fault: Option<Fault>, numbers: &mut [f64]) -> Result<(), Fault> {
        let Some(several) = &self.0 else { return fault.map_or(Ok(()), Err) };
        let exchange = &several.exchange;
        let size = exchange.size();
        // The lowest rank has the largest number; without a fault it is 0.
        let rank = if fault.is_some() { (size - exchange.rank()) as f64 } else { 0.0 };
        let first = {
            let mut all = several.numbers.lock().unwrap_or_else(PoisonError::into_inner);
            all.clear();
            all.push(rank);
            all.extend_from_slice(numbers);
            exchange.largest(&mut all);
            numbers.copy_from_slice(&all[1..]);
            all[0]
        };
        if first == 0.0 {
            return Ok(());
        }
        let root = size - first as usize;
        let mut bytes = fault.map(|fault| encode(&fault, root)).unwrap_or_default();
        exchange.broadcast(root, &mut bytes);
        Err(decode(&bytes))
    }
}

/// Parts of a fault in a letter, which has no other zero bytes.
const SEPARATOR: char = '\0';

fn encode(fault: &Fault, rank: usize) -> Vec<u8> {
    let kind = match fault.kind {
        FaultKind::Run => 'r',
        FaultKind::Step => 's',
        FaultKind::File => 'f',
    };
    let cause = fault.cause.as_deref().unwrap_or_default();
    format!("{kind}{} (process {rank}){SEPARATOR}{cause}", fault.what).into_bytes()
}

fn decode(bytes: &[u8]) -> Fault {
    let text = String::from_utf8_lossy(bytes);
    let (what, cause) = text.split_once(SEPARATOR).unwrap_or((&text, ""));
    let mut fault = Fault::run(what.get(1..).unwrap_or_default());
    fault.kind = match what.chars().next() {
        Some('f') => FaultKind::File,
        Some('s') => FaultKind::Step,
        _ => FaultKind::Run,
    };
    fault.cause = (!cause.is_empty()).then(|| cause.to_string());
    fault
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fault_passes_through_a_letter() {
        let fault = Fault::run("lost: é").because("too fast");
        let got = decode(&encode(&fault, 3));
        assert_eq!((got.what.as_str(), got.cause), ("lost: é (process 3)", fault.cause));
        let file = Fault { kind: FaultKind::File, cause: None, ..Fault::run("full") };
        let got = decode(&encode(&file, 0));
        assert_eq!((got.kind, got.cause), (FaultKind::File, None));
    }

    #[test]
    fn alone_nobody_is_asked() {
        let ranks = Ranks::default();
        assert_eq!((ranks.rank(), ranks.size(), ranks.any(true)), (0, 1, true));
        assert_eq!(ranks.total(&ExactSum::of([1.0, 2.0])), 3.0);
        let fault = Fault::run("lost");
        assert_eq!(ranks.agree(Some(fault.clone()), &mut []), Err(fault));
        assert_eq!(ranks.agree(None, &mut [1.0]), Ok(()));
    }
}
