//! Several processes of one run, as MPI launchers start them.

use crate::parallel::Ranks;

/// Variables in which launchers tell the number of processes.
const COUNTS: [&str; 5] =
    ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE", "PMIX_SIZE", "MPI_LOCALNRANKS"];

/// Variables that show that a launcher is there, though it does not tell the number.
#[cfg(feature = "mpi")]
const RANKS: [&str; 3] = ["PMIX_RANK", "PMI_RANK", "PMI_FD"];

/// What keeps the processes together; the run ends before it is dropped.
#[derive(Default)]
pub struct Launched {
    /// The processes.
    pub ranks: Ranks,
    #[cfg(feature = "mpi")]
    _universe: Option<mpi_universe::Universe>,
}

#[cfg(feature = "mpi")]
use crate::parallel::message_passing as mpi_universe;

/// Number of processes that the launcher tells of.
fn told() -> Option<u64> {
    COUNTS.iter().find_map(|name| std::env::var(name).ok()?.parse().ok())
}

/// Joins the other processes, if a launcher has started some.
///
/// # Errors
/// The program was built without MPI, or MPI does not start.
#[cfg(not(feature = "mpi"))]
pub fn join() -> Result<Launched, String> {
    match told() {
        Some(count) if count > 1 => Err(format!(
            "error: started as {count} processes, but this program was built without MPI: \
             each would run the whole script. Start it once, it uses all cores of the machine; or \
             build it with `cargo build --release --features mpi`."
        )),
        _ => Ok(Launched::default()),
    }
}

/// Joins the other processes, if a launcher has started some.
///
/// # Errors
/// MPI does not start.
#[cfg(feature = "mpi")]
pub fn join() -> Result<Launched, String> {
    let is_set = |name: &str| std::env::var_os(name).is_some();
    if told().is_none() && !RANKS.iter().any(|name| is_set(name)) {
        return Ok(Launched::default());
    }
    let Some((universe, ranks)) = mpi_universe::start() else {
        return Err("error: MPI does not start".to_string());
    };
    abort_on_panic(&ranks);
    Ok(Launched { ranks, _universe: Some(universe) })
}

/// A process that panics takes the others with it: they would wait for it for ever.
#[cfg(feature = "mpi")]
fn abort_on_panic(ranks: &Ranks) {
    let ranks = ranks.clone();
    if ranks.is_alone() {
        return;
    }
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        hook(panic);
        if let Some(exchange) = ranks.exchange() {
            eprintln!("error: process {} has failed; all others are stopped", exchange.rank());
            exchange.abort(101);
        }
    }));
}

/// Threads of this process: of the processor cores that it may use, its share if the processes of a
/// machine may use the same ones. `None`: it is the only process.
pub fn threads(ranks: &Ranks) -> Option<usize> {
    let exchange = ranks.exchange()?;
    if std::env::var_os("RAYON_NUM_THREADS").is_some() {
        return None;
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let allowed = status.lines().find(|line| line.starts_with("Cpus_allowed_list"));
    let number = f64::from(crc32fast::hash(allowed.unwrap_or_default().as_bytes()));
    let [least, most] = ranks.largest([-number, number]);
    let bound = -least != most;
    Some(if bound { cores } else { (cores / exchange.neighbours()).max(1) })
}
