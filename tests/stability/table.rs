//! The scoreboard: rows of hard cases, verdicts, Markdown.

use super::play::Played;
use super::ways::Way;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// How a combination did.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// The criterion holds; its figure.
    Pass(String),
    /// It does not, and nothing was said.
    Fail(String),
    /// Nothing ran.
    Refused(String),
    /// It does not hold, as a warning said.
    Warned(String),
    /// The run ended with exit code 1 and words that name the cause.
    Stopped(String),
}

/// A scene without its remedy: what is switched off, and what becomes of it.
pub type Without = (&'static str, fn() -> Verdict);

/// A hard case.
pub struct Row {
    /// Number in the list of failure modes.
    pub number: u32,
    /// What may go wrong.
    pub mode: &'static str,
    /// When a scene passes.
    pub criterion: &'static str,
    /// The ways that it concerns.
    pub ways: fn() -> Vec<Way>,
    /// Plays the scene.
    pub run: fn(&Way) -> Verdict,
    /// Ways of the normal suite, which must pass.
    pub quick: &'static [(&'static str, &'static str, &'static str, &'static str)],
    /// The remedy switched off: in words, and what becomes of the scene then.
    pub without: Option<Without>,
}

/// The run was foretold to go wrong, whatever the case.
const ALWAYS: [&str; 2] = ["no time step is stable", "is unstable"];

/// Words of the warning about hats whose particles have crossed cells.
pub const HATS: &str = "cells under hats";

/// Words of the warning about a time step that is set too large.
pub const STEP: &str = "above the stable one";

/// What a run came to: `criterion` gives the figure if it holds, or if it does not. Of the warnings only
/// those count that hold these words, or say that the way is unstable.
pub fn judge(
    words: &[&str],
    played: &Played,
    criterion: impl FnOnce(&Played) -> Result<String, String>,
) -> Verdict {
    if let Some(reason) = played.refused.first() {
        return Verdict::Refused(reason.clone());
    }
    let found = match &played.end {
        Err(reason) => Err(Verdict::Stopped(reason.clone())),
        Ok(()) if !played.is_finite() => Err(Verdict::Fail("not finite".to_string())),
        Ok(()) => criterion(played).map_err(Verdict::Fail),
    };
    let tells = |warning: &&String| ALWAYS.iter().chain(words).any(|words| warning.contains(words));
    match (found, played.warnings.iter().find(tells)) {
        (Ok(figure), _) => Verdict::Pass(figure),
        (Err(Verdict::Fail(_) | Verdict::Stopped(_)), Some(warning)) => {
            Verdict::Warned(warning.clone())
        }
        (Err(verdict), _) => verdict,
    }
}

/// Runs a case; a panic is a failure.
pub fn tried(run: impl FnOnce() -> Verdict) -> Verdict {
    catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| Verdict::Fail("it panics".to_string()))
}

impl Verdict {
    /// One word.
    pub fn word(&self) -> &'static str {
        match self {
            Verdict::Pass(_) => "pass",
            Verdict::Fail(_) => "fail",
            Verdict::Refused(_) => "refused",
            Verdict::Warned(_) => "warned",
            Verdict::Stopped(_) => "stopped",
        }
    }

    /// The figure or the reason.
    pub fn words(&self) -> &str {
        match self {
            Verdict::Pass(words)
            | Verdict::Fail(words)
            | Verdict::Refused(words)
            | Verdict::Warned(words)
            | Verdict::Stopped(words) => words,
        }
    }
}

/// What became of all ways of a row.
pub struct Score {
    /// Its row.
    pub row: &'static Row,
    /// Each way.
    pub each: Vec<(Way, Verdict)>,
    /// Without the remedy.
    pub without: Option<Verdict>,
    /// The slowest way in seconds.
    pub slowest: f64,
}

/// Plays all ways of a row.
pub fn score(row: &'static Row) -> Score {
    let mut slowest = 0.0f64;
    let mut each = Vec::new();
    for way in (row.ways)() {
        let begin = std::time::Instant::now();
        each.push((way, tried(|| (row.run)(&way))));
        slowest = slowest.max(begin.elapsed().as_secs_f64());
    }
    let without = row.without.map(|(_, run)| tried(run));
    Score { row, each, without, slowest }
}

/// The numbers in words, so that ways that differ in a figure alone are told together.
fn gist(words: &str) -> String {
    let first = words.split(['\n', ';']).next().unwrap_or("");
    let mut gist = String::new();
    for letter in first.chars().take(110) {
        match letter {
            '|' => gist.push('/'),
            '0'..='9' if gist.ends_with('#') => {}
            '0'..='9' => gist.push('#'),
            '.' | '-' | 'e' | '+' if gist.ends_with('#') => {}
            _ => gist.push(letter),
        }
    }
    gist.replace("NaN", "#")
}

/// Ways in few words: shapes, transfers and schemes that are all there.
fn together(ways: &[Way]) -> String {
    let mut list: BTreeMap<(&str, &str, &str), Vec<&str>> = BTreeMap::new();
    for way in ways {
        list.entry((way.method, way.shape, way.transfer)).or_default().push(way.scheme);
    }
    let mut by_transfer: BTreeMap<(&str, &str, Vec<&str>), Vec<&str>> = BTreeMap::new();
    for ((method, shape, transfer), schemes) in list {
        by_transfer.entry((method, shape, schemes)).or_default().push(transfer);
    }
    type Alike<'a> = (&'a str, Vec<&'a str>, Vec<&'a str>);
    let mut by_shape: BTreeMap<Alike<'_>, Vec<&str>> = BTreeMap::new();
    for ((method, shape, schemes), transfers) in by_transfer {
        by_shape.entry((method, transfers, schemes)).or_default().push(shape);
    }
    let each = by_shape.iter().map(|((method, transfers, schemes), shapes)| {
        format!(
            "`{method}` {}: {}; {}",
            shapes.join(", "),
            transfers.join(", "),
            if schemes.len() == 3 { "all schemes".to_string() } else { schemes.join(", ") }
        )
    });
    each.collect::<Vec<_>>().join(" - ")
}

/// The scoreboard in Markdown.
pub fn markdown(scores: &[Score]) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "| # | hard case | criterion | ways | pass | warned | stopped | refused | fail | without the remedy |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    );
    for Score { row, each, without, .. } in scores {
        let count = |word: &str| each.iter().filter(|(_, verdict)| verdict.word() == word).count();
        let without = match (row.without, without) {
            (Some((words, _)), Some(verdict)) => format!("{words}: {}", verdict.word()),
            _ => "no switch".to_string(),
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {without} |",
            row.number,
            row.mode,
            row.criterion,
            each.len(),
            count("pass"),
            count("warned"),
            count("stopped"),
            count("refused"),
            count("fail"),
        );
    }
    for score in scores {
        let others = exceptions(score);
        if !others.is_empty() {
            let _ = writeln!(text, "\nRow {}, {}:\n\n{others}", score.row.number, score.row.mode);
        }
    }
    text
}

/// The ways of a row that do not pass, with their reasons.
fn exceptions(score: &Score) -> String {
    let mut groups: BTreeMap<(&str, String), Vec<Way>> = BTreeMap::new();
    for (way, verdict) in &score.each {
        if verdict.word() != "pass" {
            groups.entry((verdict.word(), gist(verdict.words()))).or_default().push(*way);
        }
    }
    let mut text = String::new();
    for ((word, reason), ways) in groups {
        let _ = writeln!(text, "* {word} ({}), \"{reason}\": {}", ways.len(), together(&ways));
    }
    text
}
