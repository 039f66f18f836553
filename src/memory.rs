//! How much memory there is.

/// Bytes that are free, as the system reports them; unlimited where it does not.
pub fn available() -> f64 {
    let Ok(text) = std::fs::read_to_string("/proc/meminfo") else {
        return f64::INFINITY;
    };
    let line = text.lines().find_map(|line| line.strip_prefix("MemAvailable:"));
    let kilobytes = line.and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.map_or(f64::INFINITY, |kilobytes| 1024.0 * kilobytes)
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
}
