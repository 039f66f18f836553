//! Processes that an MPI launcher has started. The only file that names rsmpi.
//!
//! All calls are made by the main thread, which waits for the workers of a sweep or works with
//! them.

use super::{Exchange, Parcel, Ranks};
use mpi::Threading;
use mpi::collective::SystemOperation;
use mpi::datatype::PartitionMut;
pub use mpi::environment::Universe;
use mpi::request;
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;
use std::sync::{Arc, Mutex, PoisonError};

/// Bytes of one message at most: MPI counts in 31 bits.
const LARGEST: usize = 1 << 30;

/// Bytes of one message at most that process 0 takes in turn.
const PIECE: usize = 1 << 22;

/// Starts message passing; it ends when the universe is dropped. `None` if MPI will not start.
pub fn start() -> Option<(Universe, Ranks)> {
    let (universe, _) = mpi::initialize_with_threading(Threading::Funneled)?;
    let world = universe.world();
    let exchange = Messages {
        rank: world.rank() as usize,
        size: world.size() as usize,
        neighbours: world.split_shared(world.rank()).size() as usize,
        words: Mutex::default(),
        numbers: Mutex::default(),
    };
    Some((universe, Ranks::new(Arc::new(exchange))))
}

/// The processes of MPI_COMM_WORLD.
struct Messages {
    rank: usize,
    size: usize,
    neighbours: usize,
    /// What this process brings to a reduction; kept, so that a step allocates nothing.
    words: Mutex<Vec<i64>>,
    numbers: Mutex<Vec<f64>>,
}

/// Reduces values over all processes; `own` is memory for those of this one.
fn reduce<T: Copy + Equivalence>(
    own: &Mutex<Vec<T>>,
    values: &mut [T],
    operation: SystemOperation,
) {
    let mut own = own.lock().unwrap_or_else(PoisonError::into_inner);
    own.clear();
    own.extend_from_slice(values);
    world().all_reduce_into(&own[..], values, operation);
}

/// All processes. Handles of MPI cannot pass between threads, so each call takes its own.
fn world() -> SimpleCommunicator {
    SimpleCommunicator::world()
}

impl Exchange for Messages {
    fn rank(&self) -> usize {
        self.rank
    }

    fn size(&self) -> usize {
        self.size
    }

    fn neighbours(&self) -> usize {
        self.neighbours
    }

    fn sum(&self, words: &mut [i64]) {
        reduce(&self.words, words, SystemOperation::sum());
    }

    fn largest(&self, numbers: &mut [f64]) {
        reduce(&self.numbers, numbers, SystemOperation::max());
    }

    fn broadcast(&self, root: usize, bytes: &mut Vec<u8>) {
        let world = world();
        let root = world.process_at_rank(root as i32);
        let mut length = bytes.len() as u64;
        root.broadcast_into(&mut length);
        bytes.resize(length as usize, 0);
        for part in bytes.chunks_mut(LARGEST) {
            root.broadcast_into(part);
        }
    }

    fn gather(&self, bytes: &[u8]) -> Vec<Vec<u8>> {
        let world = world();
        let root = world.process_at_rank(0);
        let length = bytes.len() as u64;
        if self.rank != 0 {
            root.gather_into(&length);
            bytes.chunks(LARGEST).for_each(|part| root.send(part));
            return Vec::new();
        }
        let mut lengths = vec![0u64; self.size];
        root.gather_into_root(&length, &mut lengths[..]);
        let mut all = vec![bytes.to_vec()];
        for (rank, length) in lengths.iter().enumerate().skip(1) {
            let mut letter = vec![0; *length as usize];
            let process = world.process_at_rank(rank as i32);
            for part in letter.chunks_mut(LARGEST) {
                process.receive_into(part);
            }
            all.push(letter);
        }
        all
    }

    fn collect(&self, parts: &[Vec<u8>], take: &mut dyn FnMut(&[u8])) {
        let world = world();
        let root = world.process_at_rank(0);
        let pieces = parts.iter().flat_map(|part| part.chunks(PIECE));
        let count = pieces.clone().count() as u64;
        if self.rank != 0 {
            root.gather_into(&count);
            pieces.for_each(|piece| root.send(piece));
            return;
        }
        let mut counts = vec![0u64; self.size];
        root.gather_into_root(&count, &mut counts[..]);
        pieces.for_each(&mut *take);
        let mut room = vec![0; if counts[1..].iter().any(|count| *count > 0) { PIECE } else { 0 }];
        for (rank, count) in counts.iter().enumerate().skip(1) {
            let process = world.process_at_rank(rank as i32);
            for _ in 0..*count {
                let status = process.receive_into(&mut room[..]);
                take(&room[..status.count(u8::equivalent_datatype()) as usize]);
            }
        }
    }

    fn share(&self, numbers: &[f64]) -> Vec<f64> {
        let world = world();
        let mut counts = vec![0i32; self.size];
        world.all_gather_into(&(numbers.len() as i32), &mut counts[..]);
        let starts = counts.iter().scan(0, |next, count| {
            let start = *next;
            *next += count;
            Some(start)
        });
        let starts: Vec<i32> = starts.collect();
        let mut all = vec![0.0; counts.iter().sum::<i32>() as usize];
        let mut parts = PartitionMut::new(&mut all[..], counts, starts);
        world.all_gather_varcount_into(numbers, &mut parts);
        all
    }

    fn swap(&self, mut letters: Vec<Vec<u8>>) -> Vec<Vec<u8>> {
        let world = world();
        let lengths: Vec<u64> = letters.iter().map(|letter| letter.len() as u64).collect();
        let mut coming = vec![0u64; self.size];
        world.all_to_all_into(&lengths[..], &mut coming[..]);
        let mut received: Vec<Vec<u8>> =
            coming.iter().map(|length| vec![0; *length as usize]).collect();
        received[self.rank] = std::mem::take(&mut letters[self.rank]);
        request::scope(|scope| {
            let mut requests = Vec::new();
            for (rank, letter) in received.iter_mut().enumerate() {
                if rank != self.rank {
                    let process = world.process_at_rank(rank as i32);
                    for part in letter.chunks_mut(LARGEST) {
                        requests.push(process.immediate_receive_into(scope, part));
                    }
                }
            }
            let mut sends = Vec::new();
            for (rank, letter) in letters.iter().enumerate() {
                let process = world.process_at_rank(rank as i32);
                for part in letter.chunks(LARGEST) {
                    sends.push(process.immediate_send(scope, part));
                }
            }
            for request in requests {
                request.wait();
            }
            for request in sends {
                request.wait();
            }
        });
        received
    }

    fn trade(&self, sent: &[Parcel], received: &mut [Parcel], meanwhile: &mut dyn FnMut()) {
        let world = world();
        request::scope(|scope| {
            let mut requests = Vec::with_capacity(received.len());
            for parcel in received.iter_mut() {
                let process = world.process_at_rank(parcel.rank as i32);
                requests.push(process.immediate_receive_into(scope, &mut parcel.numbers[..]));
            }
            let mut sends = Vec::with_capacity(sent.len());
            for parcel in sent {
                let process = world.process_at_rank(parcel.rank as i32);
                sends.push(process.immediate_send(scope, &parcel.numbers[..]));
            }
            meanwhile();
            for request in requests {
                request.wait();
            }
            for request in sends {
                request.wait();
            }
        });
    }

    fn abort(&self, code: i32) -> ! {
        world().abort(code)
    }
}
