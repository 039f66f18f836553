//! The table of speeds: `cargo bench --bench table`.
//!
//! Times are CPU times, as long as one thread is at work, and medians over rounds through all
//! rows, so that a slow minute of the machine falls on every row. `-- --karamelo PATH` runs the
//! same scenes through a Karamelo binary, turn by turn. `cargo test` runs the smallest case.

mod callgrind;
mod input;
mod measure;
mod program;
mod rows;
mod sample;
mod scene;

use clap::Parser;
use measure::{Measured, Settings};
use program::Program;
use rows::{Goal, ROWS, Row};
use scene::Size;
use std::path::PathBuf;
use std::process::ExitCode;

/// Measures how fast the program is, case by case.
#[derive(Parser)]
#[command(name = "table")]
struct Options {
    /// Cases whose names contain this
    #[arg(long, value_name = "NAME", default_value = "")]
    case: String,
    /// A small version of each case, once: shows that the bench works, not how fast the program is
    #[arg(long)]
    quick: bool,
    /// A Karamelo binary to compare with, on a quarter of the steps
    #[arg(long, value_name = "PATH")]
    karamelo: Option<PathBuf>,
    /// Measurements of each case [default: 5, with Karamelo 3, quick 1]
    #[arg(long, value_name = "N")]
    rounds: Option<usize>,
    /// What `cargo bench` says
    #[arg(long, hide = true)]
    bench: bool,
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().collect();
    let options = match words.iter().any(|word| word == "--bench") {
        true => Options::parse(),
        // `cargo test` does not say `--bench`; its words are for other harnesses.
        false => Options::parse_from(["table", "--quick", "--case", "two disks"]),
    };
    match table(&options) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn table(options: &Options) -> Result<(), String> {
    let rows: Vec<&Row> = ROWS.iter().filter(|row| row.name.contains(&options.case)).collect();
    if rows.is_empty() {
        let names: Vec<&str> = ROWS.iter().map(|row| row.name).collect();
        return Err(format!("no case `{}`; there are: {}", options.case, names.join(", ")));
    }
    let karamelo = options.karamelo.as_deref().map(Program::karamelo).transpose()?;
    let (rounds, shorten) = match (options.quick, &karamelo) {
        (true, _) => (1, 10),
        (false, Some(_)) => (3, 4),
        (false, None) => (5, 1),
    };
    let settings = Settings {
        size: if options.quick { Size::Small } else { Size::Full },
        shorten,
        rounds: options.rounds.unwrap_or(rounds).max(1),
        count: !options.quick,
        karamelo,
    };
    let mut results: Vec<Measured> = rows.iter().map(|_| Measured::default()).collect();
    for (row, measured) in rows.iter().zip(&mut results) {
        eprintln!("counting {}", row.name);
        settings.fixed(row, measured);
    }
    for round in 1..=settings.rounds {
        eprintln!("round {round} of {}", settings.rounds);
        for (row, measured) in rows.iter().zip(&mut results) {
            settings.once(row, measured)?;
        }
    }
    print(&settings, &rows, &results);
    Ok(())
}

fn print(settings: &Settings, rows: &[&Row], results: &[Measured]) {
    println!("M/s: million particle-steps per second of CPU time, one thread, without set-up");
    println!("x:   two threads over one by the clock; ms: CPU time of the whole process");
    println!("median of {} (smallest - largest); instructions per particle-step", settings.rounds);
    if settings.size == Size::Small {
        println!("quick: small scenes and few steps, not to be held against a target");
    }
    println!(
        "\n{:<20}{:>10}  {:<28}{:<14}{:>6}  {:<12}",
        "case", "particles", "measured", "target", "bytes", "instructions"
    );
    for (row, measured) in rows.iter().zip(results) {
        println!("{}", line(settings, row, measured).trim_end());
    }
    if settings.karamelo.is_none() {
        return;
    }
    println!("\n{:<20}{:<28}{:<24}relative difference of Ek", "case", "Karamelo", "times as fast");
    for (row, measured) in rows.iter().zip(results) {
        let Some(difference) = measured.difference else { continue };
        let karamelo = measured.karamelo.text(unit(row));
        let ratio = measured.ratio.text("x");
        println!("{:<20}{karamelo:<28}{ratio:<24}{difference:.1e}", row.name);
    }
}

fn unit(row: &Row) -> &'static str {
    match row.goal {
        Goal::Speed(_) => "M/s",
        Goal::SpeedUp(_) => "x",
        Goal::Whole(_) => "ms",
    }
}

/// A row of the first table.
fn line(settings: &Settings, row: &Row, measured: &Measured) -> String {
    let found = measured.ours.median();
    let (target, met) = match row.goal {
        Goal::Speed(target) | Goal::SpeedUp(target) => (format!(">= {target}"), found >= target),
        Goal::Whole(target) => (format!("<= {target}"), found <= target),
    };
    let judge = |met: bool| match (settings.size, met) {
        (Size::Small, _) => "",
        (Size::Full, true) => " met",
        (Size::Full, false) => " missed",
    };
    let number = |value: Option<u64>| value.map_or("-".to_string(), |value| value.to_string());
    let mut instructions = number(measured.instructions);
    if let (Some(found), Some(budget)) = (measured.instructions, row.budget) {
        let met = if found <= budget { "met" } else { "missed" };
        instructions += &format!(" <= {budget} {met}");
    }
    format!(
        "{:<20}{:>10}  {:<28}{:<14}{:>6}  {instructions}",
        row.name,
        row.scene.particles(settings.size),
        measured.ours.text(unit(row)),
        format!("{target}{}", judge(met)),
        number(measured.bytes),
    )
}
