//! Restart files: a JSON header, then columns.
//!
//! | bytes | what |
//! | --- | --- |
//! | 0 .. 8 | [`MAGIC`] |
//! | 8 .. 12 | version of the format, little endian as all numbers |
//! | 12 .. 16 | CRC-32 of everything from byte 16 on |
//! | 16 .. 24 | length of the header |
//! | 24 .. | the header, in JSON, filled up with blanks |
//! | | the columns, each at its `offset` from the end of the header |
//!
//! The header has `program`, `step`, `time`, `solids`, the `script` that built the scene, and
//! `columns`: for each name the numpy type, `rows`, `width` (numbers in a row) and `offset`.

use crate::model::checkpoint::{Checkpoint, Entry};
use crate::script::history::{History, Part};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// The first bytes: no text begins like this, and a transfer as text destroys them.
pub const MAGIC: &[u8; 8] = b"\x89MPMRST\n";

/// The version of the format. Another one means that a column has another meaning.
pub const VERSION: u32 = 1;

/// Bytes before the header.
const START: usize = 24;

/// Where columns begin.
const ALIGNED: usize = 64;

/// When restart files are written.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Every so many steps.
    pub interval: u64,
    /// The file, `*` for the step.
    pub file: String,
    /// The last step with a file.
    pub last: Option<u64>,
}

impl Schedule {
    /// Is one due after this step?
    pub fn due(&self, step: u64) -> bool {
        step.is_multiple_of(self.interval) && self.last != Some(step)
    }
}

/// The file of a pattern at a step.
pub fn path(pattern: &str, step: u64) -> PathBuf {
    PathBuf::from(pattern.replace('*', &step.to_string()))
}

/// What stands in the header for the reader's sake.
pub struct Summary<'a> {
    /// Steps done.
    pub step: u64,
    /// Time \[T\].
    pub time: f64,
    /// Names of the solids, by number.
    pub solids: Vec<&'a str>,
}

/// A restart file that has been read.
pub struct Saved {
    /// How the scene came about.
    pub history: History,
    /// Its state.
    pub checkpoint: Checkpoint,
}

/// The bytes of a restart file.
pub fn encode(history: &History, summary: &Summary<'_>, checkpoint: &Checkpoint) -> Vec<u8> {
    let column = |entry: &Entry| {
        let Entry { name, kind, width, rows, offset } = entry;
        let about = json!({ "type": kind, "width": width, "rows": rows, "offset": offset });
        (name.clone(), about)
    };
    let columns: Map<String, Value> = checkpoint.entries().iter().map(column).collect();
    let header = json!({
        "program": concat!("karamelo-rs ", env!("CARGO_PKG_VERSION")),
        "step": summary.step,
        "time": summary.time,
        "solids": summary.solids,
        "script": history.parts.iter().map(part).collect::<Vec<_>>(),
        "columns": columns,
    });
    let mut header = header.to_string();
    let length = (START + header.len()).next_multiple_of(ALIGNED) - START;
    header.extend(std::iter::repeat_n(' ', length - header.len()));
    let data = checkpoint.data();
    let mut bytes = Vec::with_capacity(START + length + data.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&VERSION.to_le_bytes());
    bytes.extend_from_slice(&[0; 4]);
    bytes.extend_from_slice(&(length as u64).to_le_bytes());
    bytes.extend_from_slice(header.as_bytes());
    bytes.extend_from_slice(data);
    let checksum = crc32fast::hash(&bytes[16..]);
    bytes[12..16].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

fn part(part: &Part) -> Value {
    // Numbers as their bits: a measured value may be infinite.
    let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
    let files: Vec<Value> = part.files.iter().map(|(name, sum)| json!([name, sum])).collect();
    json!({
        "name": part.name,
        "text": part.text,
        "variables": part.variables,
        "performed": part.performed,
        "measured": bits(&part.measured),
        "files": files,
    })
}

/// Does a file begin like a restart file?
pub fn is_restart(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Is a file meant as a restart file? One that is damaged at its first bytes has its name to tell.
pub fn is_restart_file(name: &str, bytes: &[u8]) -> bool {
    is_restart(bytes) || Path::new(name).extension().is_some_and(|ending| ending == "rst")
}

fn number<const N: usize>(bytes: &[u8], at: usize) -> Option<[u8; N]> {
    bytes.get(at..at + N)?.try_into().ok()
}

/// Reads a restart file.
///
/// # Errors
/// Why it is none, or none that can be used.
pub fn decode(bytes: &[u8]) -> Result<Saved, String> {
    if !is_restart(bytes) {
        return Err("it is no restart file".to_string());
    }
    let cut = || "it is cut off".to_string();
    let version = u32::from_le_bytes(number(bytes, 8).ok_or_else(cut)?);
    if version != VERSION {
        return Err(format!(
            "it has version {version} of the format; this program reads {VERSION}"
        ));
    }
    let checksum = u32::from_le_bytes(number(bytes, 12).ok_or_else(cut)?);
    let length = u64::from_le_bytes(number(bytes, 16).ok_or_else(cut)?);
    if crc32fast::hash(&bytes[16..]) != checksum {
        return Err("it is damaged or cut off: its checksum is wrong".to_string());
    }
    let length = usize::try_from(length).map_err(|_| cut())?;
    let end = START.checked_add(length).filter(|end| *end <= bytes.len()).ok_or_else(cut)?;
    let header: Value = serde_json::from_slice(&bytes[START..end])
        .map_err(|reason| format!("its header is not JSON: {reason}"))?;
    let incomplete = || "its header is not complete".to_string();
    let parts = header["script"].as_array().ok_or_else(incomplete)?;
    let parts: Option<Vec<Part>> = parts.iter().map(read_part).collect();
    let columns = header["columns"].as_object().ok_or_else(incomplete)?;
    let entries: Option<Vec<Entry>> = columns.iter().map(read_entry).collect();
    let history = History { parts: parts.ok_or_else(incomplete)? };
    let data = bytes[end..].to_vec();
    let checkpoint = Checkpoint::loading(entries.ok_or_else(incomplete)?, data)?;
    Ok(Saved { history, checkpoint })
}

fn count(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|count| usize::try_from(count).ok())
}

fn read_entry((name, about): (&String, &Value)) -> Option<Entry> {
    Some(Entry {
        name: name.clone(),
        kind: about["type"].as_str()?.to_string(),
        width: count(&about["width"]).filter(|width| *width > 0)?,
        rows: count(&about["rows"])?,
        offset: count(&about["offset"])?,
    })
}

fn read_part(part: &Value) -> Option<Part> {
    let text = |value: &Value| value.as_str().map(str::to_string);
    let pair = |pair: &Value| Some((text(&pair[0])?, text(&pair[1])?));
    let file = |file: &Value| Some((text(&file[0])?, u32::try_from(file[1].as_u64()?).ok()?));
    let list = |name: &str| part[name].as_array();
    Some(Part {
        name: text(&part["name"])?,
        text: text(&part["text"])?,
        variables: list("variables")?.iter().map(pair).collect::<Option<_>>()?,
        performed: count(&part["performed"])?,
        measured: list("measured")?
            .iter()
            .map(|bits| bits.as_u64().map(f64::from_bits))
            .collect::<Option<_>>()?,
        files: list("files")?.iter().map(file).collect::<Option<_>>()?,
    })
}

/// The file that an interrupted run leaves: `two-disks.interrupted.rst`, beside the log.
pub fn interrupted(script: &str, log: Option<&Path>) -> PathBuf {
    let stem = Path::new(script).file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let stem = stem.strip_suffix(".interrupted").unwrap_or(&stem);
    log.unwrap_or(Path::new("")).with_file_name(format!("{stem}.interrupted.rst"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parallel::Ranks;

    fn file() -> Vec<u8> {
        let mut checkpoint = Checkpoint::saving(&Ranks::default());
        checkpoint.column("numbers", &mut vec![1.5, -2.0, f64::NAN]);
        let part = Part {
            name: "a.mpm".to_string(),
            text: "a = \"\u{e9}\"\n".to_string(),
            variables: vec![("N".to_string(), "3".to_string())],
            performed: 1,
            measured: vec![f64::INFINITY, 0.1],
            files: vec![("m.msh".to_string(), u32::MAX)],
        };
        let summary = Summary { step: 7, time: 0.25, solids: vec!["ball"] };
        encode(&History { parts: vec![part] }, &summary, &checkpoint)
    }

    #[test]
    fn a_file_comes_back() {
        let mut saved = decode(&file()).unwrap();
        let part = &saved.history.parts[0];
        assert_eq!(part.text, "a = \"\u{e9}\"\n");
        assert_eq!(part.measured, [f64::INFINITY, 0.1]);
        assert_eq!((part.performed, part.variables.len(), part.files[0].1), (1, 1, u32::MAX));
        let mut numbers: Vec<f64> = Vec::new();
        saved.checkpoint.column("numbers", &mut numbers);
        assert_eq!(numbers[..2], [1.5, -2.0]);
        saved.checkpoint.finish().unwrap();
    }

    #[test]
    fn every_cut_and_every_flipped_bit_is_refused() {
        let bytes = file();
        for length in 0..bytes.len() {
            assert!(decode(&bytes[..length]).is_err(), "cut to {length}");
        }
        for bit in 0..8 * bytes.len() {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(decode(&damaged).is_err(), "bit {bit}");
        }
        let mut longer = bytes.clone();
        longer.push(0);
        assert!(decode(&longer).is_err());
    }

    #[test]
    fn an_interrupted_run_leaves_its_file_beside_the_log() {
        let path = |script, log: Option<&str>| interrupted(script, log.map(Path::new));
        assert_eq!(path("inputs/a.mpm", None), Path::new("a.interrupted.rst"));
        assert_eq!(path("a.mpm", Some("out/log.mpm")), Path::new("out/a.interrupted.rst"));
        assert_eq!(path("a.interrupted.rst", None), Path::new("a.interrupted.rst"));
    }
}
