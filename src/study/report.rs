//! The table of a study, for people and for programs.

use super::{Case, Cost, Measured, State, Study};
use crate::output::number;
use std::fmt::Write;

/// Seconds of repeats that differ by more than this part of their median are marked.
const STEADY: f64 = 0.1;

/// A table with columns that stand under each other; the first `left` columns are words.
fn aligned(rows: &[Vec<String>], left: usize) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max()
    };
    let widths: Vec<usize> = (0..columns).map(|column| width(column).unwrap_or(0)).collect();
    let mut text = String::new();
    for row in rows {
        let cell = |(column, cell): (usize, &String)| {
            let width = widths[column];
            let words = column < left || column + 1 == columns;
            if words { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
        };
        let line = row.iter().enumerate().map(cell).collect::<Vec<_>>().join("  ");
        let _ = writeln!(text, "{}", line.trim_end());
    }
    text
}

/// A number with three digits.
fn three(value: f64) -> String {
    if !value.is_finite() {
        return "-".to_string();
    }
    match value.abs() {
        size if size == 0.0 || (1e-2..1e4).contains(&size) => {
            let digits = if size == 0.0 { 0 } else { (2 - size.log10().floor() as i32).max(0) };
            format!("{value:.*}", digits as usize)
        }
        _ => format!("{value:.2e}"),
    }
}

/// Remarks on a row.
fn remarks(case: &Case, measured: &Measured, study: &Study) -> String {
    let mut remarks = Vec::new();
    if measured.pareto {
        remarks.push("*".to_string());
    }
    if measured.worse {
        let missed = measured.error >= study.below;
        let missed = if missed { " and misses the limit" } else { "" };
        remarks.push(format!("worse than on coarser cells{missed}"));
    }
    if measured.spread > STEADY {
        remarks.push(format!("seconds vary by {:.0} %", 100.0 * measured.spread));
    }
    remarks.extend(case.warnings.iter().map(|warning| format!("warning: {warning}")));
    remarks.join(" ")
}

fn row(case: &Case, study: &Study) -> Vec<String> {
    let mut row = case.values.clone();
    match &case.state {
        State::Done(measured) => {
            row.push(three(measured.error));
            row.push(if measured.order.is_finite() {
                format!("{:.2}", measured.order)
            } else {
                "-".to_string()
            });
            row.push(three(measured.cpu));
            row.push(three(measured.wall));
            row.push(format!("{}", measured.steps));
            row.push(three(measured.speed / 1e6));
            row.push(three(measured.memory / 1e6));
            row.push(remarks(case, measured, study));
        }
        State::Refused(reason) => row.extend(blank(format!("refused: {reason}"))),
        State::Failed(reason) => row.extend(blank(format!("failed: {reason}"))),
        State::Waiting => row.extend(blank("not run".to_string())),
    }
    row
}

/// Nothing but a remark.
fn blank(remark: String) -> Vec<String> {
    let mut row = vec!["-".to_string(); 7];
    row.push(remark);
    row
}

/// The table with all that must be said about it.
pub fn text(study: &Study) -> String {
    let mut head = study.names.clone();
    let columns = ["error", "order", "CPU s", "wall s", "steps", "Mp-steps/s", "MB", ""];
    head.extend(columns.map(str::to_string));
    let mut rows = vec![head];
    rows.extend(study.cases.iter().map(|case| row(case, study)));
    let mut text = String::new();
    let _ = writeln!(text, "error: `{}` against {}", study.measure, study.reference);
    for warning in &study.warnings {
        let _ = writeln!(text, "warning: {warning}");
    }
    text.push_str(&aligned(&rows, study.names.len()));
    let _ = writeln!(text, "* nothing else is faster and more accurate");
    text.push_str(&answer(study));
    text
}

/// "The cheapest setting below 1 % is ...".
fn answer(study: &Study) -> String {
    let limit = percent(study.below, study.relative);
    let what = match study.cost {
        Cost::Cpu => "s of CPU time",
        Cost::Wall => "s by the clock",
    };
    let seconds = |measured: &Measured| three(study.seconds(measured));
    let known = study.done().filter(|(_, measured)| measured.error.is_finite());
    let Some((best, least)) = known.min_by(|a, b| a.1.error.total_cmp(&b.1.error)) else {
        return "no error is known, so nothing can be recommended\n".to_string();
    };
    let Some((case, measured)) = study.cheapest() else {
        return format!(
            "no setting is below {limit}; the nearest is {}: error {} in {} {what}\n",
            study.label(best, true),
            percent(least.error, study.relative),
            seconds(least)
        );
    };
    let mut text = format!(
        "the cheapest setting below {limit} is {}: error {} in {} {what}\n",
        study.label(case, true),
        percent(measured.error, study.relative),
        seconds(measured)
    );
    for other in finer(study, case) {
        let _ = match &other.state {
            State::Done(m) if m.error < study.below => continue,
            State::Done(m) => writeln!(
                text,
                "but do not trust it: on finer cells ({}) the same setting has error {}",
                study.label(other, true),
                percent(m.error, study.relative)
            ),
            State::Failed(reason) => writeln!(
                text,
                "but do not trust it: on finer cells ({}) the same setting fails: {reason}",
                study.label(other, true)
            ),
            State::Refused(_) | State::Waiting => continue,
        };
        if let Some((case, measured)) = trusted(study) {
            let _ = writeln!(
                text,
                "the cheapest that finer cells confirm is {}: error {} in {} {what}",
                study.label(case, true),
                percent(measured.error, study.relative),
                seconds(measured)
            );
        }
        break;
    }
    text
}

/// Cases that differ from one in nothing but finer cells.
fn finer<'a>(study: &'a Study, case: &'a Case) -> impl Iterator<Item = &'a Case> {
    let same = |other: &Case| study.label(other, false) == study.label(case, false);
    study.cases.iter().filter(move |other| other.cell < case.cell && same(other))
}

/// The fastest case below the limit that has finer ones, all of them below the limit too.
fn trusted(study: &Study) -> Option<(&Case, &Measured)> {
    let good = |case: &Case| match &case.state {
        State::Done(measured) => measured.error < study.below,
        State::Refused(_) => true,
        State::Failed(_) | State::Waiting => false,
    };
    let confirmed = |case: &Case| {
        let mut finer = finer(study, case).peekable();
        finer.peek().is_some() && finer.all(good)
    };
    let all = study.done().filter(|(case, _)| good(case) && confirmed(case));
    all.min_by(|a, b| study.seconds(a.1).total_cmp(&study.seconds(b.1)))
}

fn percent(error: f64, relative: bool) -> String {
    if relative { format!("{} %", three(100.0 * error)) } else { three(error) }
}

/// Why no run came to its end.
pub fn failures(study: &Study) -> String {
    let mut lines = vec!["error: no run came to its end".to_string()];
    for case in &study.cases {
        if let State::Failed(reason) | State::Refused(reason) = &case.state {
            lines.push(format!("   {}: {reason}", study.label(case, true)));
        }
    }
    lines.join("\n")
}

/// All numbers with all digits.
pub fn csv(study: &Study) -> String {
    let mut text = String::new();
    let columns = "cell,value,error,order,cpu_s,wall_s,spread,steps,particle_steps_per_s,memory_bytes,\
                   pareto,remark";
    let names = study.names.iter().map(|name| format!("{name},")).collect::<String>();
    let _ = writeln!(text, "{names}{columns}");
    for case in &study.cases {
        let mut fields: Vec<String> = case.values.iter().map(|value| quoted(value)).collect();
        fields.push(number::text(case.cell));
        match &case.state {
            State::Done(m) => {
                let numbers = [
                    m.value, m.error, m.order, m.cpu, m.wall, m.spread, m.steps, m.speed, m.memory,
                ];
                fields.extend(numbers.map(number::text));
                fields.push(u8::from(m.pareto).to_string());
                fields.push(String::new());
            }
            State::Refused(reason) | State::Failed(reason) => {
                fields.extend(std::iter::repeat_n(String::new(), 10));
                fields.push(quoted(reason));
            }
            State::Waiting => fields.extend(std::iter::repeat_n(String::new(), 11)),
        }
        let _ = writeln!(text, "{}", fields.join(","));
    }
    text
}

fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::child::Job;

    fn study() -> Study {
        let case = |value: &str, cell: f64, state: State| Case {
            values: vec!["linear".to_string(), value.to_string()],
            job: Job {
                script: "a.mpm".into(),
                variables: Vec::new(),
                settings: Vec::new(),
                threads: 1,
                measure: "e_z".to_string(),
            },
            cell,
            warnings: if cell < 0.1 { vec!["odd".to_string()] } else { Vec::new() },
            state,
        };
        let measured = |error: f64, cpu: f64, worse: bool| {
            State::Done(Measured { error, cpu, worse, order: f64::NAN, ..Measured::default() })
        };
        Study {
            names: vec!["shape".to_string(), "cells".to_string()],
            grids: vec![false, true],
            cases: vec![
                case("8", 0.125, measured(5e-3, 0.1, false)),
                case("16", 0.0625, measured(0.2, 0.4, true)),
                case("x", f64::NAN, State::Refused("no, \"never\"".to_string())),
            ],
            measure: "e_z".to_string(),
            reference: "the error itself".to_string(),
            warnings: vec!["all odd".to_string()],
            relative: true,
            cost: Cost::Cpu,
            below: 0.01,
        }
    }

    #[test]
    fn a_pass_that_a_finer_grid_takes_back_is_not_recommended_in_silence() {
        let text = text(&study());
        assert!(text.contains("cheapest setting below 1.00 % is shape=linear cells=8"), "{text}");
        assert!(text.contains("do not trust it: on finer cells (shape=linear cells=16)"), "{text}");
        assert!(text.contains("worse than on coarser cells and misses the limit"), "{text}");
        assert!(text.contains("refused: no, \"never\""), "{text}");
        assert!(
            text.contains("\nwarning: all odd\n") && text.contains(" warning: odd\n"),
            "{text}"
        );
    }

    #[test]
    fn a_pass_whose_finer_run_fails_is_no_better_and_the_next_one_is_named() {
        let mut study = study();
        study.cases[1].state = State::Failed("it tears".to_string());
        let mut steady = study.cases[..2].to_vec();
        for (case, error) in steady.iter_mut().zip([8e-3, 2e-3]) {
            case.values[0] = "cubic".to_string();
            case.state = State::Done(Measured { error, cpu: 0.5, ..Measured::default() });
        }
        study.cases.extend(steady);
        let text = text(&study);
        assert!(text.contains("the same setting fails: it tears"), "{text}");
        let next = "the cheapest that finer cells confirm is shape=cubic cells=8: error 0.800 %";
        assert!(text.contains(next), "{text}");
    }

    #[test]
    fn the_nearest_is_named_when_nothing_is_good_enough() {
        let mut study = study();
        study.below = 1e-4;
        let text = text(&study);
        assert!(text.contains("no setting is below 0.0100 %; the nearest is"), "{text}");
    }

    #[test]
    fn rows_of_the_csv_have_as_many_fields_as_its_head() {
        let text = csv(&study());
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[3].ends_with("\"no, \"\"never\"\"\""), "{text}");
        let count = |line: &str| line.matches(',').count();
        assert_eq!((count(lines[1]), count(lines[3]) - 1), (count(lines[0]), count(lines[0])));
    }

    #[test]
    fn three_digits() {
        let cases = [(0.0123, "0.0123"), (12.0, "12.0"), (1234.0, "1234"), (1.5e-5, "1.50e-5")];
        for (value, expected) in cases {
            assert_eq!(three(value), expected);
        }
        assert_eq!((three(0.0), three(f64::NAN)), ("0".to_string(), "-".to_string()));
    }
}
