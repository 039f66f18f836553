//! Scripts that must be refused, and scripts that must be accepted.
//!
//! Every fixture carries what it expects under the culprit: a comment line whose carets mark the
//! columns, then the code and the beginning of the message. `KARAMELO_SHOW=1` prints what was
//! found instead of what was expected.

mod project;

use karamelo::command::play::rehearse;
use karamelo::script::diagnostic::{Diagnostic, Severity, ordered};
use karamelo::script::source::Source;
use project::scripts_below;
use proptest::prelude::*;
use std::path::{Path, PathBuf};

/// A mistake as a fixture states it: line, first and last column, code and message.
#[derive(Clone, Debug, PartialEq)]
struct Expected {
    line: usize,
    columns: (usize, usize),
    words: String,
}

fn fixtures(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/script").join(folder);
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

fn expectations(text: &str) -> Vec<Expected> {
    let mut list = Vec::new();
    let mut culprit = 0;
    for (index, line) in text.lines().enumerate() {
        let marks =
            line.strip_prefix('#').map(str::trim_start).filter(|rest| rest.starts_with('^'));
        let Some(marks) = marks else {
            culprit = index + 1;
            continue;
        };
        let before = line.chars().take_while(|c| *c != '^').count();
        let carets = marks.chars().take_while(|c| *c == '^').count();
        let words = marks.trim_start_matches('^').trim().to_string();
        list.push(Expected { line: culprit, columns: (before + 1, before + carets), words });
    }
    list
}

/// What the rehearsal finds, in the words of a fixture.
fn found(source: &Source, diagnostics: &[Diagnostic]) -> Vec<Expected> {
    let describe = |d: &Diagnostic| {
        let (line, first) = source.position(d.span.start);
        let width =
            source.text[d.span.start..d.span.end].lines().next().unwrap_or("").chars().count();
        let words = format!("{} {}", d.code.number(), d.message);
        Expected { line, columns: (first, first + width.max(1) - 1), words }
    };
    ordered(diagnostics).into_iter().map(describe).collect()
}

fn rehearsed(path: &Path) -> (Source, Vec<Diagnostic>) {
    let bytes = std::fs::read(path).unwrap();
    let (source, encoding) = Source::from_bytes(path.display().to_string(), &bytes);
    let (script, mut diagnostics) = rehearse(source, &[]);
    diagnostics.extend(encoding);
    (script.source, diagnostics)
}

fn check(folder: &str) {
    let show = std::env::var_os("KARAMELO_SHOW").is_some();
    let mut wrong = Vec::new();
    for path in fixtures(folder) {
        let (source, diagnostics) = rehearsed(&path);
        let expected = expectations(&source.text);
        let found = found(&source, &diagnostics);
        let alike = expected.len() == found.len()
            && expected.iter().zip(&found).all(|(e, f)| {
                (e.line, e.columns) == (f.line, f.columns) && f.words.starts_with(&e.words)
            });
        if show {
            println!("{}\n{found:#?}", path.display());
        }
        if !alike {
            wrong
                .push(format!("{}\n  expected {expected:?}\n  found    {found:?}", path.display()));
        }
        let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
        if (folder == "bad") != (errors > 0) {
            wrong.push(format!("{}: {errors} errors in a {folder} script", path.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn bad_scripts_are_refused_with_code_place_and_words() {
    assert!(fixtures("bad").len() >= 60);
    check("bad");
}

#[test]
fn good_scripts_are_accepted_with_the_warnings_they_list() {
    check("good");
}

#[test]
fn every_input_is_accepted_without_a_word() {
    for path in scripts_below("inputs") {
        let (_, diagnostics) = rehearsed(&path);
        assert!(diagnostics.is_empty(), "{}: {diagnostics:?}", path.display());
    }
}

/// Scripts to break: all that are accepted.
fn seeds() -> Vec<String> {
    let scripts = scripts_below("inputs").into_iter().chain(fixtures("good"));
    let texts = scripts.map(|path| std::fs::read_to_string(path).unwrap());
    // Smaller and fewer digits: a mutant with a millionth of the cell size only takes longer.
    texts.filter(|text| text.len() < 3000).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn mutated_scripts_never_panic(
        seed in 0usize..1000,
        cuts in prop::collection::vec((0.0..1.0f64, 0usize..12, "[a-z0-9,()=#\"*. \n-]{0,6}"), 1..6),
    ) {
        let seeds = seeds();
        let mut text = seeds[seed % seeds.len()].clone().into_bytes();
        for (place, length, new) in cuts {
            let start = (place * text.len() as f64) as usize;
            let end = (start + length).min(text.len());
            text.splice(start..end, new.into_bytes());
        }
        let (source, _) = Source::from_bytes("mutant", &text);
        let (script, found) = rehearse(source, &[]);
        prop_assert!(found.iter().all(|d| d.span.end <= script.source.text.len()));
    }

    #[test]
    fn byte_soup_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let (source, _) = Source::from_bytes("soup", &bytes);
        rehearse(source, &[]);
    }
}
