//! Scripts: soups of bytes and words, and mutants of every script of the project.

use super::project::scripts_below;
use super::random::Random;
use super::{bound_memory, cases};
use karamelo::command::COMMANDS;
use karamelo::command::play::{Script, rehearse};
use karamelo::fix::FIXES;
use karamelo::material::MATERIALS;
use karamelo::region::REGIONS;
use karamelo::script::diagnostic::{Diagnostic, Severity, render};
use karamelo::script::function::FUNCTIONS;
use karamelo::script::source::Source;
use karamelo::shape::SHAPES;
use karamelo::transfer::TRANSFERS;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// A rehearsal that takes longer hangs. The largest body that fits has some ten million places.
const PATIENCE: Duration = Duration::from_secs(20);

/// A script of the project: its path, which tells where its files are, and its text.
pub type Seed = (String, String);

/// All scripts that mutants come from.
pub fn seeds() -> Vec<Seed> {
    let paths = [scripts_below("inputs"), scripts_below("tests/script")].concat();
    let read = |path: PathBuf| {
        let text = String::from_utf8_lossy(&std::fs::read(&path).unwrap()).into_owned();
        (path.display().to_string(), text)
    };
    paths.into_iter().map(read).collect()
}

/// Words, numbers, signs and blanks.
fn tokens(text: &str) -> Vec<&str> {
    let kind = |c: char| match c {
        c if c.is_alphanumeric() || "_.".contains(c) => 0,
        '\n' => 1,
        c if c.is_whitespace() => 2,
        _ => 3,
    };
    let mut tokens = Vec::new();
    let mut start = 0;
    let mut letters = text.char_indices().peekable();
    while let Some((_, letter)) = letters.next() {
        let ends = letters.peek().is_none_or(|(_, next)| {
            kind(letter) != kind(*next) || kind(letter) == 3 || kind(letter) == 1
        });
        if ends {
            let end = letters.peek().map_or(text.len(), |(at, _)| *at);
            tokens.push(&text[start..end]);
            start = end;
        }
    }
    tokens
}

/// Numbers that are wrong at most places.
const NUMBERS: [&str; 22] = [
    "0",
    "-1",
    "1e300",
    "nan",
    "inf",
    "1e-300",
    "-0",
    "1",
    "2",
    "3",
    "7",
    "0.5",
    "1e9",
    "1e18",
    "4294967296",
    "9007199254740993",
    "-1e300",
    "1e-9",
    "100",
    "2147483647",
    "-0.25",
    "12345",
];

/// Words of the language.
fn words() -> Vec<&'static str> {
    let mut words: Vec<&str> = COMMANDS.iter().map(|row| row.name).collect();
    words.extend(FIXES.iter().map(|row| row.name));
    words.extend(MATERIALS.iter().map(|row| row.name));
    words.extend(REGIONS.iter().map(|row| row.name));
    words.extend(SHAPES.iter().map(|row| row.name));
    words.extend(TRANSFERS.iter().map(|row| row.name));
    words.extend(FUNCTIONS.iter().map(|row| row.name));
    words.extend(["all", "NULL", "INF", "x", "y", "z", "x0", "time", "dt", "PI", "ulmpm", "tlmpm"]);
    words.extend([
        "ulcpdi", "tlcpdi", "exterior", "true", "auto", "none", "quit", "*", "&&", "\"", "",
    ]);
    words
}

/// One change of a script.
fn change(tokens: &mut Vec<String>, words: &[&str], random: &mut Random) {
    if tokens.is_empty() {
        return;
    }
    let place = |random: &mut Random, test: &dyn Fn(&str) -> bool, tokens: &[String]| {
        let start = random.below(tokens.len());
        (0..tokens.len()).map(|k| (start + k) % tokens.len()).find(|k| test(&tokens[*k]))
    };
    let plain = |token: &str| !token.trim().is_empty();
    let number = |token: &str| token.starts_with(|c: char| c.is_ascii_digit());
    let Some(at) = place(random, &plain, tokens) else { return };
    match random.below(10) {
        0 => {
            tokens.remove(at);
        }
        1 => tokens.insert(at, tokens[at].clone()),
        2 => {
            let other = random.below(tokens.len());
            tokens.swap(at, other);
        }
        3 => tokens[at] = random.of(words).to_string(),
        4 => tokens[at] = tokens[random.below(tokens.len())].clone(),
        5 => {
            // A statement goes, or comes twice.
            let is_end = |token: &String| token == "\n";
            let start = tokens[..at].iter().rposition(is_end).map_or(0, |end| end + 1);
            let end = tokens[at..].iter().position(is_end).map_or(tokens.len(), |end| at + end + 1);
            let line: Vec<String> = tokens.drain(start..end).collect();
            if random.one_in(2) {
                let to = random.below(tokens.len() + 1);
                tokens.splice(to..to, [line.clone(), line].concat());
            }
        }
        _ => {
            if let Some(at) = place(random, &number, tokens) {
                tokens[at] = random.of(&NUMBERS).to_string();
            }
        }
    }
}

/// The mutant of a number: the path of its script and its text.
pub fn mutant(seeds: &[Seed], case: u64) -> Seed {
    let mut random = Random::of_case(case);
    let (path, text) = random.of(seeds);
    let mut list: Vec<String> = tokens(text).into_iter().map(str::to_string).collect();
    let words = words();
    for _ in 0..1 + random.below(3) {
        change(&mut list, &words, &mut random);
    }
    (path.clone(), list.concat())
}

/// Rehearses a script; what went wrong with the rehearsal itself.
fn rehearsed(name: &str, bytes: &[u8]) -> Result<bool, String> {
    let begin = Instant::now();
    let work = || {
        let (source, encoding) = Source::from_bytes(name, bytes);
        let (script, mut found) = rehearse(source, &[]);
        found.extend(encoding);
        told(&script, &found)
    };
    match catch_unwind(AssertUnwindSafe(work)) {
        Err(_) => Err("it panics".to_string()),
        Ok(_) if begin.elapsed() > PATIENCE => Err(format!("it takes {:?}", begin.elapsed())),
        Ok(result) => result,
    }
}

/// Is a script accepted? Its mistakes must have places in it and words.
fn told(script: &Script, found: &[Diagnostic]) -> Result<bool, String> {
    let length = script.source.text.len();
    for mistake in found {
        if mistake.span.end > length || mistake.span.start > mistake.span.end {
            return Err(format!("a mistake lies outside: {mistake:?}"));
        }
        if mistake.message.trim().is_empty() {
            return Err("a mistake without words".to_string());
        }
    }
    if found.len() < 50 {
        render(found, &script.source, false);
    }
    Ok(found.iter().all(|mistake| mistake.severity != Severity::Error))
}

/// Tells every failure with its case; the first ones in full.
fn judge(what: &str, failures: &[(u64, String, String)]) {
    for (case, problem, text) in failures.iter().take(5) {
        println!("{what} {case}: {problem}\n{text}\n");
    }
    let list: Vec<u64> = failures.iter().map(|(case, ..)| *case).collect();
    assert!(list.is_empty(), "{what}: {list:?}");
}

#[test]
fn soups_of_bytes_and_words_never_panic() {
    bound_memory();
    let words = words();
    let mut failures = Vec::new();
    for case in 0..cases(4000) {
        let mut random = Random::of_case(case);
        let length = random.below(300);
        let bytes = match case % 3 {
            0 => random.bytes(length),
            1 => {
                let signs = b"()\",=#+-*/^<>!&|.\n\t 0123456789eEabcxyz\xc3\xa9\xef\xbb\xbf\0";
                (0..length).map(|_| *random.of(signs)).collect()
            }
            _ => {
                let mut text = String::new();
                for _ in 0..length / 4 {
                    let word =
                        if random.one_in(3) { random.of(&NUMBERS) } else { random.of(&words) };
                    text.push_str(word);
                    text.push_str(
                        random.of::<&str>(&["(", ")", ",", ", ", "\n", "=", " ", "+", ")\n"]),
                    );
                }
                text.into_bytes()
            }
        };
        if let Err(problem) = rehearsed("soup.mpm", &bytes) {
            failures.push((case, problem, format!("{bytes:?}")));
        }
    }
    judge("soup", &failures);
}

#[test]
fn mutants_of_all_scripts_are_judged_in_time_and_memory() {
    bound_memory();
    let seeds = seeds();
    let (mut failures, mut accepted) = (Vec::new(), 0);
    let count = cases(10_000);
    for case in 0..count {
        let (path, text) = mutant(&seeds, case);
        match rehearsed(&path, text.as_bytes()) {
            Ok(good) => accepted += u64::from(good),
            Err(problem) => failures.push((case, problem, text)),
        }
    }
    println!("{count} mutants of {} scripts, {accepted} accepted", seeds.len());
    // Otherwise the mutants show nothing but mistakes of form.
    assert!(accepted * 20 > count && accepted * 2 < count, "{accepted} accepted");
    judge("mutant", &failures);
}
