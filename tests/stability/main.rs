//! How explicit MPM fails, and what this program does about it: scenes of the 24 hard cases over
//! methods, shapes, transfers and schemes.
//!
//! The normal suite plays a few ways of each; `cargo test --release --test stability -- --ignored
//! --nocapture scoreboard` plays all of them and prints the tables of `docs/src/hard-cases.md`.

mod grid_rows;
mod large_rows;
mod matter_rows;
mod play;
mod table;
mod ways;
mod whole_rows;

use std::time::Instant;
use table::{Row, Verdict, markdown, score, tried};
use ways::Way;

/// All rows.
fn rows() -> Vec<&'static Row> {
    let tables = [grid_rows::ROWS, large_rows::ROWS, matter_rows::ROWS, whole_rows::ROWS];
    tables.into_iter().flatten().collect()
}

/// Seconds that a scene may take.
const LONGEST: f64 = 5.0;

#[test]
fn chosen_ways_of_every_hard_case_pass_and_fail_without_their_remedy() {
    let mut wrong = Vec::new();
    for row in rows() {
        let begin = Instant::now();
        for &(method, shape, transfer, scheme) in row.quick {
            let way = Way { method, shape, transfer, scheme };
            let verdict = tried(|| (row.run)(&way));
            println!("{:2} {way}: {} {}", row.number, verdict.word(), verdict.words());
            if !matches!(verdict, Verdict::Pass(_)) {
                wrong.push(format!("{} {way}: {verdict:?}", row.number));
            }
        }
        if let Some((words, run)) = row.without {
            let verdict = tried(run);
            println!("{:2} without, {words}: {} {}", row.number, verdict.word(), verdict.words());
            if matches!(verdict, Verdict::Pass(_)) {
                wrong.push(format!(
                    "{} passes without its remedy, {words}: {verdict:?}",
                    row.number
                ));
            }
        }
        println!("{:2} took {:.2} s", row.number, begin.elapsed().as_secs_f64());
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
#[ignore = "plays some thousand scenes: minutes"]
fn scoreboard() {
    let only: Option<Vec<u32>> = std::env::var("KARAMELO_ROWS")
        .ok()
        .map(|list| list.split(',').filter_map(|number| number.parse().ok()).collect());
    let wanted = rows()
        .into_iter()
        .filter(|row| only.as_ref().is_none_or(|only| only.contains(&row.number)));
    let scores: Vec<table::Score> = wanted.map(score).collect();
    println!("{}", markdown(&scores));
    for score in &scores {
        assert!(score.slowest < LONGEST, "row {}: {:.1} s", score.row.number, score.slowest);
        let silent = score.each.iter().filter(|(_, verdict)| matches!(verdict, Verdict::Fail(_)));
        for (way, verdict) in silent {
            println!("row {} {way}: {verdict:?}", score.row.number);
        }
    }
}
