//! How much memory there is.

use std::path::{Path, PathBuf};

/// Bytes that this process can still take: the least of what the system has free, of what the
/// address space of the process allows (`ulimit -v`) and of what its control group allows, as jobs
/// and containers have one. Unlimited where the system does not say.
pub fn available() -> f64 {
    free_of_system().min(free_addresses()).min(free_of_group())
}

fn free_of_system() -> f64 {
    let free = read("/proc/meminfo").and_then(|text| kilobytes(&text, "MemAvailable:"));
    free.unwrap_or(f64::INFINITY)
}

/// The limit of the address space less what is taken.
fn free_addresses() -> f64 {
    let limits = read("/proc/self/limits");
    // "Max address space  SOFT  HARD  bytes"; `unlimited` is no number.
    let limit = limits.and_then(|text| {
        let rest = text.lines().find_map(|line| line.strip_prefix("Max address space"))?;
        rest.split_whitespace().next()?.parse::<f64>().ok()
    });
    let Some(limit) = limit else { return f64::INFINITY };
    let taken = read("/proc/self/status").and_then(|text| kilobytes(&text, "VmSize:"));
    (limit - taken.unwrap_or(0.0)).max(0.0)
}

/// What the control group (version 2) of the process and those around it still allow; pages that
/// only cache files do not count as taken.
fn free_of_group() -> f64 {
    let groups = read("/proc/self/cgroup").unwrap_or_default();
    let Some(path) = groups.lines().find_map(|line| line.strip_prefix("0::/")) else {
        return f64::INFINITY;
    };
    let root = Path::new("/sys/fs/cgroup");
    let own: PathBuf = root.join(path);
    let around = own.ancestors().take_while(|folder| folder.starts_with(root));
    around.filter_map(free_in).fold(f64::INFINITY, f64::min)
}

fn free_in(group: &Path) -> Option<f64> {
    let number = |name: &str| -> Option<f64> {
        std::fs::read_to_string(group.join(name)).ok()?.trim().parse().ok()
    };
    let limit = number("memory.max")?;
    let statistics = std::fs::read_to_string(group.join("memory.stat")).unwrap_or_default();
    let of_files = statistics.lines().find_map(|line| line.strip_prefix("inactive_file "));
    let of_files = of_files.and_then(|bytes| bytes.parse::<f64>().ok()).unwrap_or(0.0);
    Some((limit - number("memory.current")? + of_files).max(0.0))
}

fn read(path: &str) -> Option<String> {
    std::fs::read_to_string(path).ok()
}

/// Bytes in a line such as `VmSize:   1234 kB`.
fn kilobytes(text: &str, name: &str) -> Option<f64> {
    let rest = text.lines().find_map(|line| line.strip_prefix(name))?;
    Some(1024.0 * rest.split_whitespace().next()?.parse::<f64>().ok()?)
}

/// Bytes in words: `1.5 GB`.
pub fn text(bytes: f64) -> String {
    let units = ["B", "kB", "MB", "GB", "TB", "PB"];
    let mut value = bytes;
    let mut unit = 0;
    while value >= 1000.0 && unit + 1 < units.len() {
        value /= 1000.0;
        unit += 1;
    }
    if unit == 0 { format!("{value:.0} B") } else { format!("{value:.1} {}", units[unit]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_put_in_words() {
        assert_eq!(text(999.0), "999 B");
        assert_eq!(text(1.5e9), "1.5 GB");
        assert!(available() > 0.0);
    }

    #[test]
    fn lines_of_the_system_are_read() {
        let status = "Name:\tmpm\nVmSize:\t   2048 kB\n";
        assert_eq!(kilobytes(status, "VmSize:"), Some(2_097_152.0));
        assert_eq!(kilobytes(status, "VmPeak:"), None);
    }
}
