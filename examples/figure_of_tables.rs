//! One figure of the curves of several runs: `figure_of_tables FIGURE TABLE...` draws the tables that
//! `save_plot(name.csv)` wrote into a `.svg`, `.pdf` or `.png`.

use karamelo::output::plot::{Curve, save};
use std::path::Path;
use std::process::ExitCode;

/// A curve read back: names of curve, x and y, and its points.
struct Read {
    names: [String; 3],
    points: Vec<[f64; 2]>,
}

/// The curves of a table: two columns each, headed `curve:x,curve:y`; short ones end in empty fields.
fn curves_of(text: &str) -> Option<Vec<Read>> {
    let mut lines = text.lines();
    let heads: Vec<&str> = lines.next()?.split(',').collect();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let curve = |(place, pair): (usize, &[&str])| {
        let [(name, x), (_, y)] = [pair.first()?.split_once(':')?, pair.get(1)?.split_once(':')?];
        let number = |row: &Vec<&str>, column: usize| row.get(column)?.parse().ok();
        let point = |row| Some([number(row, 2 * place)?, number(row, 2 * place + 1)?]);
        let points = rows.iter().map_while(point).collect();
        Some(Read { names: [name, x, y].map(str::to_string), points })
    };
    heads.chunks(2).enumerate().map(curve).collect()
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((figure, tables)) = arguments.split_first().filter(|(_, tables)| !tables.is_empty())
    else {
        eprintln!("usage: figure_of_tables FIGURE TABLE...");
        return ExitCode::from(2);
    };
    let mut read = Vec::new();
    for table in tables {
        match std::fs::read_to_string(table) {
            Ok(text) => match curves_of(&text) {
                Some(curves) => read.extend(curves),
                None => {
                    eprintln!("{table}: not a table of `save_plot`");
                    return ExitCode::FAILURE;
                }
            },
            Err(reason) => {
                eprintln!("{table}: {reason}");
                return ExitCode::FAILURE;
            }
        }
    }
    let curves: Vec<Curve<'_>> = read
        .iter()
        .map(|Read { names: [name, x, y], points }| Curve { name, axes: [x, y], points })
        .collect();
    match save(Path::new(figure), &curves) {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => {
            eprintln!("{fault}");
            ExitCode::FAILURE
        }
    }
}
