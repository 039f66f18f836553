//! Notices when several processes were started.

/// Variables in which MPI launchers tell the number of processes.
const COUNTS: [&str; 4] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MV2_COMM_WORLD_SIZE", "PMIX_SIZE"];

/// A refusal, if a launcher has started more than one copy of this program.
pub fn several_processes() -> Option<String> {
    let count = COUNTS.iter().find_map(|name| std::env::var(name).ok()?.parse::<u64>().ok())?;
    (count > 1).then(|| {
        format!(
            "error: started as {count} processes, but this program was built without MPI: \
             each would run the whole script. Start it once; it uses all cores of the machine."
        )
    })
}
