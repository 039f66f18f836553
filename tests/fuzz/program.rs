//! Mutants that are accepted, in the program itself: a few steps end with 0 or with words.

use super::cases;
use super::random::Random;
use super::scripts::{Seed, mutant, seeds};
use assert_cmd::cargo::cargo_bin;
use karamelo::command::play::rehearse;
use karamelo::script::diagnostic::Severity;
use karamelo::script::source::Source;
use karamelo::script::syntax::{self, Statement};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Steps of each run.
const STEPS: usize = 3;

/// A script of so few steps that takes longer hangs.
const PATIENCE: Duration = Duration::from_secs(60);

/// Blocks of 1024 bytes of address space, and of 512 bytes of a file, that a child may take.
const LIMITS: &str = "ulimit -v 3000000; ulimit -f 200000";

/// The script with so few steps, and a dump of what must be finite.
fn shortened(text: &str) -> Option<String> {
    let source = Source::new("mutant", text);
    let (statements, _) = syntax::parse(&source);
    let mut short = source.text.clone();
    let mut runs = 0;
    for statement in statements.iter().rev() {
        let Statement::Call { name, span, .. } = statement else { continue };
        if ["run", "run_time", "run_while", "run_until"].contains(&name.text.as_str()) {
            short.replace_range(span.start..span.end, &format!("run({STEPS})"));
            runs += 1;
        }
    }
    let state = "dump(fuzz_state, all, particle, 1, fuzz_state.*.txt, x, y, z, vx, vy, vz, \
                 s11, s22, s33, s12, ep, T, J)\n";
    let first = short.find(&format!("run({STEPS})"))?;
    short.insert_str(first, state);
    (runs > 0).then_some(short)
}

/// Runs a command in a folder; `None` if it does not end.
fn ended(mut command: Command) -> Option<Output> {
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let (process, begin) = (child.id(), Instant::now());
    let waiting = std::thread::spawn(move || child.wait_with_output().unwrap());
    while !waiting.is_finished() {
        if begin.elapsed() > PATIENCE {
            let _ = Command::new("kill").args(["-9", &process.to_string()]).status();
            let _ = waiting.join();
            return None;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    waiting.join().ok()
}

/// Numbers of the last dump that are not finite.
fn not_finite(folder: &Path) -> usize {
    let entries = std::fs::read_dir(folder).unwrap().filter_map(Result::ok);
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let is_bad = |word: &&str| ["nan", "NaN", "inf", "-inf"].contains(word);
    let count = |name: String| {
        let text = std::fs::read_to_string(folder.join(name)).unwrap_or_default();
        text.split_whitespace().filter(is_bad).count()
    };
    names.filter(|name| name.starts_with("fuzz_state.")).map(count).sum()
}

/// Runs a script as a user would; what is wrong with how it ended, and its exit code.
fn judged(path: &str, text: &str) -> Result<i32, String> {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("scene");
    std::fs::create_dir(&folder).unwrap();
    // The files that it reads lie beside it, or in the folder `files` next to its own.
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let link = std::os::unix::fs::symlink;
    link(root.join("tests/script/files"), place.path().join("files")).unwrap();
    for entry in std::fs::read_dir(Path::new(path).parent().unwrap()).unwrap() {
        let (from, read) = (entry.unwrap().path(), ["msh", "stl", "txt"]);
        if from.extension().is_some_and(|ending| read.iter().any(|known| ending == *known)) {
            std::fs::copy(&from, folder.join(from.file_name().unwrap())).unwrap();
        }
    }
    std::fs::write(folder.join("fuzz-in.mpm"), text).unwrap();
    let program = cargo_bin!("karamelo-rs");
    let line = format!("{LIMITS}; exec '{}' fuzz-in.mpm --threads 1", program.display());
    let mut command = Command::new("sh");
    command.args(["-c", &line]).current_dir(&folder);
    let Some(output) = ended(command) else { return Err("it does not end".to_string()) };
    let said = String::from_utf8_lossy(&output.stderr);
    let last: String =
        said.chars().rev().take(1500).collect::<Vec<_>>().into_iter().rev().collect();
    match output.status.code() {
        _ if said.contains("panicked at") => Err(format!("it panics:\n{last}")),
        None => Err(format!("signal {:?}:\n{last}", output.status.signal())),
        Some(0) if not_finite(&folder) > 0 => Err("it ends with 0 and is not finite".to_string()),
        Some(code @ 0) => Ok(code),
        Some(code @ 1..=3) if said.contains("error") => Ok(code),
        Some(code) => Err(format!("exit code {code}:\n{last}")),
    }
}

/// Is a script accepted by the rehearsal?
fn is_accepted((path, text): &Seed) -> bool {
    let (_, found) = rehearse(Source::new(path.clone(), text), &[]);
    found.iter().all(|mistake| mistake.severity != Severity::Error)
}

#[test]
fn accepted_mutants_end_well_or_with_words() {
    let seeds = seeds();
    let wanted = cases(60);
    let (mut done, mut case, mut codes, mut failures) = (0, 1_000_000, [0; 4], Vec::new());
    while done < wanted {
        case += 1;
        let (path, text) = mutant(&seeds, case);
        let Some(short) = shortened(&text) else { continue };
        let short = (path, short);
        // Short scripts rather than the long ones of three dimensions.
        if Random::of_case(case).one_in(2) || !is_accepted(&short) {
            continue;
        }
        done += 1;
        match judged(&short.0, &short.1) {
            Ok(code) => codes[code as usize] += 1,
            Err(problem) => {
                println!("mutant {case} of {}: {problem}\n{}\n", short.0, short.1);
                failures.push(case);
            }
        }
    }
    println!("{done} mutants run: {codes:?} ended with 0, 1, 2, 3");
    assert!(failures.is_empty(), "{failures:?}");
}
