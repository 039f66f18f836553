//! Meshes, surfaces, lists of particles and restart files, cut off and changed.

use super::random::Random;
use super::{bound_memory, cases};
use karamelo::command::play::{perform, rehearse};
use karamelo::command::session::{Mode, Session};
use karamelo::geometry::{gmsh, list, stl, surface::Surface};
use karamelo::output::{Outputs, restart};
use karamelo::script::source::Source;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

/// A file of some kilobytes that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(5);

/// The files of a folder with an ending.
fn files(folder: &str, ending: &str) -> Vec<(String, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let wanted = paths.into_iter().filter(|path| path.extension().is_some_and(|e| e == ending));
    let read = |path: std::path::PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (name, std::fs::read(path).unwrap())
    };
    wanted.map(read).collect()
}

/// A damaged copy.
fn damaged(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    let mut copy = bytes.to_vec();
    for _ in 0..1 + random.below(3) {
        if copy.is_empty() {
            break;
        }
        let at = random.below(copy.len());
        match random.below(8) {
            0 => copy.truncate(at),
            1 => copy[at] ^= 1 << random.below(8),
            2 => copy[at] = *random.of(b"0123456789-+.eE \n\t$nx\0\xff"),
            3 => {
                let end = (at + random.below(40)).min(copy.len());
                copy.drain(at..end);
            }
            4 => {
                let end = (at + random.below(40)).min(copy.len());
                let part = copy[at..end].to_vec();
                copy.splice(at..at, part);
            }
            5 => {
                let numbers = [&b"0"[..], b"-1", b"1e300", b"nan", b"99999999999", b"4294967295"];
                let end = copy[at..].iter().position(u8::is_ascii_whitespace);
                let end = at + end.unwrap_or(0);
                copy.splice(at..end, random.of(&numbers).iter().copied());
            }
            6 => {
                let end = (at + random.below(40)).min(copy.len());
                copy[at..end].fill(0);
            }
            _ => {
                let noise = random.bytes(8);
                copy.splice(at..at, noise);
            }
        }
    }
    copy
}

/// Reads damaged copies of files; tells how many were good all the same.
fn torture(
    files: &[(String, Vec<u8>)],
    count: u64,
    read: impl Fn(&[u8]) -> Result<(), String>,
) -> u64 {
    bound_memory();
    assert!(!files.is_empty());
    let (mut good, mut failures) = (0, Vec::new());
    for case in 0..count {
        let mut random = Random::of_case(case);
        let (name, bytes) = random.of(files);
        let bytes = damaged(bytes, &mut random);
        let begin = Instant::now();
        match catch_unwind(AssertUnwindSafe(|| read(&bytes))) {
            Err(_) => failures.push(format!("{case} ({name}) panics")),
            Ok(_) if begin.elapsed() > PATIENCE => failures.push(format!("{case} ({name}) hangs")),
            Ok(Err(words)) if words.trim().is_empty() => {
                failures.push(format!("{case} ({name}) is refused without words"));
            }
            Ok(result) => good += u64::from(result.is_ok()),
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
    good
}

#[test]
fn damaged_meshes_are_refused_or_read() {
    let meshes = files("tests/meshes", "msh");
    for (name, bytes) in &meshes {
        let dimension = (1..=3).find(|d| gmsh::read(bytes, *d).is_ok()).unwrap_or(0);
        assert!(dimension > 0, "{name} is no good mesh");
        // Every cut but one of blanks or of the last word, which says that a section ends.
        for end in (0..bytes.len().saturating_sub(14)).step_by(1 + bytes.len() / 50) {
            let cut = gmsh::read(&bytes[..end], dimension);
            assert!(cut.is_err(), "{name} cut to {end} of {} bytes", bytes.len());
        }
    }
    let count = cases(4000);
    let good = torture(&meshes, count, |bytes| {
        for dimension in 1..=3 {
            let read = gmsh::read(bytes, dimension).and_then(|mesh| mesh.points());
            match read {
                Ok(points) => {
                    let finite = points.list.iter().all(|p| p.volume > 0.0 && p.volume.is_finite());
                    assert!(finite && points.spacing(dimension).is_finite());
                    return Ok(());
                }
                Err(mistake) if dimension == 3 => return Err(mistake.what),
                Err(_) => {}
            }
        }
        Ok(())
    });
    println!("{count} damaged meshes, {good} of them still good");
}

#[test]
fn damaged_surfaces_are_refused_or_read() {
    let count = cases(4000);
    let good = torture(&files("tests/script/files", "stl"), count, |bytes| {
        let surface = stl::read(bytes).and_then(|triangles| Surface::new(&triangles));
        let surface = surface.map_err(|mistake| mistake.what)?;
        for at in [0.1, 0.3, 0.5, -2.0] {
            surface.contains([at, 0.4, at]);
        }
        assert!(surface.volume().is_finite());
        Ok(())
    });
    println!("{count} damaged surfaces, {good} of them still good");
}

#[test]
fn damaged_lists_are_refused_or_read() {
    let mut lists = files("tests/script/files", "txt");
    lists.push((
        "long".to_string(),
        b"0.1 0.2 0.01 # a\n0.3 0.2 0.01\r\n\n-1e-3 +.5 2E-2\n".to_vec(),
    ));
    let count = cases(4000);
    let good = torture(&lists, count, |bytes| {
        let points = list::read(bytes, 2).map_err(|mistake| mistake.what)?;
        assert!(
            points.list.iter().all(|p| p.volume > 0.0 && p.place.iter().all(|x| x.is_finite()))
        );
        Ok(())
    });
    println!("{count} damaged lists, {good} of them still good");
}

/// A restart file after some steps of a scene with contact, history and a fix with a memory.
fn restart_file() -> Vec<u8> {
    let script = "method(ulmpm, APIC, quadratic-spline)\ndimension(2, 0, 1, 0, 1, 0.1)\n\
        region(disk, sphere, 0.5, 0.5, 0.2)\nmaterial(m, neo-hookean, 1000, 1e5, 0.3)\n\
        solid(ball, region, disk, 2, m, 0.1)\nfix(go, initial_velocity_particles, all, 0, -1)\n\
        compute(Ek, kinetic_energy, all)\nlog_modify(custom, dt, time, Ek)\nset_output(1)\nrun(3)\n";
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("a.rst");
    let (script, found) = rehearse(Source::new("in.mpm", script), &[]);
    assert!(found.is_empty(), "{found:?}");
    let mut session = Session::new(Outputs::silent(), Mode::Run);
    assert!(perform(&script, &mut session).is_ok());
    session.simulation.write_restart(&file).unwrap();
    std::fs::read(file).unwrap()
}

/// The checksum at its place, so that what lies behind it is read.
fn signed(mut bytes: Vec<u8>) -> Vec<u8> {
    if bytes.len() > 16 {
        let checksum = crc32fast::hash(&bytes[16..]);
        bytes[12..16].copy_from_slice(&checksum.to_le_bytes());
    }
    bytes
}

/// Goes on from a restart file as `karamelo-rs FILE` does; refused with words or done.
fn gone_on(bytes: &[u8]) -> Result<(), String> {
    let place = tempfile::tempdir().unwrap();
    let file = place.path().join("a.rst");
    std::fs::write(&file, bytes).unwrap();
    let text = format!("read_restart(\"{}\")\nrun(1)\n", file.display());
    let (script, found) = rehearse(Source::new("in.mpm", &text), &[]);
    if let Some(mistake) = found.iter().find(|mistake| mistake.code.number().starts_with('E')) {
        return Err(mistake.message.clone());
    }
    let mut session = Session::new(Outputs::silent(), Mode::Run);
    perform(&script, &mut session).map_err(|stop| format!("{stop:?}"))
}

#[test]
fn damaged_restart_files_are_refused() {
    let good = ("a.rst".to_string(), restart_file());
    assert_eq!(gone_on(&good.1), Ok(()));
    let whole = good.1.clone();
    let count = cases(2000);
    let files = [good];
    let unsigned = torture(&files, count, |bytes| {
        let read = restart::decode(bytes).map(|_| ());
        assert!(read.is_err() || bytes == whole, "a damaged file is accepted");
        read
    });
    // With a right checksum a file may be anything: it is refused, or the run ends with words.
    let signed = torture(&files, cases(300), |bytes| gone_on(&signed(bytes.to_vec())));
    println!(
        "{count} damaged restart files, {unsigned} unchanged; {signed} of {} signed go on",
        cases(300)
    );
}
