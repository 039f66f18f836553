//! Results of finished runs in a file, so that an interrupted study goes on where it stopped.

use crate::output::number;
use std::collections::HashMap;
use std::fs::OpenOptions;
use std::io::{self, Write};
use std::path::PathBuf;

/// What is kept of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// The number that was taken from it.
    pub value: f64,
    /// Seconds by the clock.
    pub wall: f64,
    /// Seconds of all cores.
    pub cpu: f64,
    /// Largest memory in bytes.
    pub memory: f64,
    /// Steps.
    pub steps: f64,
    /// Steps times particles.
    pub particle_steps: f64,
    /// Seconds of the loops over steps.
    pub seconds: f64,
}

/// A finished run, or why it failed.
pub type Entry = Result<Kept, String>;

/// FNV-1a, 64 bits.
pub fn hash(parts: &[&[u8]]) -> u64 {
    let mut sum = 0xcbf2_9ce4_8422_2325;
    for part in parts {
        // The length keeps two parts from looking like one.
        for byte in (part.len() as u64).to_le_bytes().iter().chain(*part) {
            sum = (sum ^ u64::from(*byte)).wrapping_mul(0x100_0000_01b3);
        }
    }
    sum
}

/// The file; without a path nothing is kept.
pub struct Results {
    path: Option<PathBuf>,
    known: HashMap<u64, Entry>,
    /// The last line of the file has no end.
    torn: bool,
}

impl Results {
    /// Opens the file; `again` forgets what is in it. Lines that cannot be read are skipped: the
    /// last one may be torn.
    ///
    /// # Errors
    /// The file is there and cannot be read.
    pub fn open(path: Option<PathBuf>, again: bool) -> io::Result<Self> {
        let mut known = HashMap::new();
        let mut torn = false;
        if let Some(path) = &path {
            match std::fs::read_to_string(path) {
                Ok(text) => {
                    torn = !text.is_empty() && !text.ends_with('\n');
                    if !again {
                        known.extend(text.lines().filter_map(read));
                    }
                }
                Err(reason) if reason.kind() == io::ErrorKind::NotFound => {}
                Err(reason) => return Err(reason),
            }
        }
        Ok(Self { path, known, torn })
    }

    /// What is known of a run.
    pub fn get(&self, key: u64) -> Option<&Entry> {
        self.known.get(&key)
    }

    /// Keeps a run.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn add(&mut self, key: u64, label: &str, entry: Entry) -> io::Result<()> {
        if let Some(path) = &self.path {
            let mut file = OpenOptions::new().create(true).append(true).open(path)?;
            let end = if std::mem::take(&mut self.torn) { "\n" } else { "" };
            file.write_all(format!("{end}{}", line(key, label, &entry)).as_bytes())?;
        }
        self.known.insert(key, entry);
        Ok(())
    }
}

fn line(key: u64, label: &str, entry: &Entry) -> String {
    let flat = |text: &str| text.replace(['\t', '\n', '\r'], " ");
    let rest = match entry {
        Ok(k) => {
            let numbers = [k.value, k.wall, k.cpu, k.memory, k.steps, k.particle_steps, k.seconds];
            numbers.map(number::text).join("\t")
        }
        Err(reason) => format!("failed\t{}", flat(reason)),
    };
    format!("{key:016x}\t{}\t{rest}\n", flat(label))
}

fn read(line: &str) -> Option<(u64, Entry)> {
    let mut fields = line.split('\t');
    let key = u64::from_str_radix(fields.next()?, 16).ok()?;
    fields.next()?;
    let rest: Vec<&str> = fields.collect();
    if let ["failed", reason] = rest[..] {
        return Some((key, Err(reason.to_string())));
    }
    let numbers: Vec<f64> = rest.iter().map_while(|word| word.parse().ok()).collect();
    let [value, wall, cpu, memory, steps, particle_steps, seconds] = numbers[..] else {
        return None;
    };
    Some((key, Ok(Kept { value, wall, cpu, memory, steps, particle_steps, seconds })))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(value: f64) -> Kept {
        Kept {
            value,
            wall: 1.5,
            cpu: 1.25,
            memory: 8e6,
            steps: 10.0,
            particle_steps: 1e3,
            seconds: 1.0,
        }
    }

    #[test]
    fn runs_are_found_again_and_torn_lines_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.study");
        let mut results = Results::open(Some(path.clone()), false).unwrap();
        results.add(7, "h=1\t2", Ok(kept(0.1))).unwrap();
        results.add(8, "h=2", Err("left\nthe box".to_string())).unwrap();
        let mut text = std::fs::read_to_string(&path).unwrap();
        text.push_str("0000000000000009\th=3\t0.5\t1");
        std::fs::write(&path, text).unwrap();
        let mut again = Results::open(Some(path.clone()), false).unwrap();
        assert_eq!(again.get(7), Some(&Ok(kept(0.1))));
        assert_eq!(again.get(8), Some(&Err("left the box".to_string())));
        assert_eq!(again.get(9), None);
        again.add(10, "h=4", Ok(kept(0.4))).unwrap();
        let third = Results::open(Some(path.clone()), false).unwrap();
        assert_eq!(third.get(10), Some(&Ok(kept(0.4))), "on a line of its own");
        assert_eq!(Results::open(Some(path), true).unwrap().get(7), None);
    }

    #[test]
    fn hashes_differ_with_every_part() {
        let hashes = [hash(&[b"ab", b"c"]), hash(&[b"a", b"bc"]), hash(&[b"abc"]), hash(&[])];
        assert!((0..4).all(|a| (0..a).all(|b| hashes[a] != hashes[b])));
    }
}
