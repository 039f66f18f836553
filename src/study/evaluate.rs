//! Errors, orders and the Pareto front from the numbers of the runs.

use super::log::Taken;
use super::order::{self, Extrapolated};
use super::plan::Plan;
use super::{Against, Case, Measured, Request, State, Stop, Study};
use crate::output::number::brief;

impl Plan {
    /// Errors, orders and the Pareto front from the numbers of the runs.
    ///
    /// # Errors
    /// No run has a number, or the reference has none.
    pub fn evaluate(mut self, request: &Request) -> Result<Study, Stop> {
        let reference = if self.has_reference { self.cases.pop() } else { None };
        let grids = grids(&self.names, &self.cases);
        let mut study = Study {
            names: self.names,
            grids,
            cases: self.cases,
            measure: self.measure,
            reference: String::new(),
            warnings: Vec::new(),
            relative: true,
            cost: request.cost,
            below: request.below,
        };
        share_warnings(&mut study);
        if study.done().next().is_none() {
            return Err(Stop::Failed(super::report::failures(&study)));
        }
        let exact = match (&self.against, &reference) {
            (Against::Nothing, _) => {
                study.reference = match request.taken {
                    Taken::Curve(_) => "distance from the curve, relative to it".to_string(),
                    _ => "the error itself".to_string(),
                };
                Some(0.0)
            }
            (Against::Exact(value), _) => {
                study.reference = format!("exact {}", brief(*value));
                study.relative = *value != 0.0;
                Some(*value)
            }
            (Against::Run(_), Some(case)) => {
                let value = match &case.state {
                    State::Done(measured) => measured.value,
                    State::Failed(reason) | State::Refused(reason) => {
                        return Err(Stop::Failed(format!("the reference run failed: {reason}")));
                    }
                    State::Waiting => f64::NAN,
                };
                study.reference = format!("reference run: {}", brief(value));
                Some(value)
            }
            _ => extrapolate(&mut study),
        };
        let is_error = self.against == Against::Nothing;
        set_errors(&mut study, exact, is_error);
        set_orders(&mut study);
        set_pareto(&mut study);
        Ok(study)
    }
}

/// Warnings about every combination stand once, above the table.
fn share_warnings(study: &mut Study) {
    let Some((first, rest)) = study.cases.split_first() else { return };
    let everywhere = |w: &&String| rest.iter().all(|case| case.warnings.contains(w));
    let shared: Vec<String> = first.warnings.iter().filter(everywhere).cloned().collect();
    for case in &mut study.cases {
        case.warnings.retain(|warning| !shared.contains(warning));
    }
    study.warnings = shared;
}

/// Which names change the cell size: two cases that differ in nothing else have different cells.
fn grids(names: &[String], cases: &[Case]) -> Vec<bool> {
    let differs_only_in = |a: &Case, b: &Case, name: usize| {
        a.values.iter().zip(&b.values).enumerate().all(|(i, (a, b))| (a != b) == (i == name))
    };
    let changes = |name: usize| {
        cases.iter().enumerate().any(|(index, a)| {
            cases[..index].iter().any(|b| {
                differs_only_in(a, b, name)
                    && a.cell.is_finite()
                    && b.cell.is_finite()
                    && (a.cell - b.cell).abs() > 1e-9 * a.cell
            })
        })
    };
    (0..names.len()).map(changes).collect()
}

fn set(study: &mut Study, index: usize, change: impl FnOnce(&mut Measured)) {
    if let State::Done(measured) = &mut study.cases[index].state {
        change(measured);
    }
}

fn get(study: &Study, index: usize) -> Measured {
    match &study.cases[index].state {
        State::Done(measured) => measured.clone(),
        _ => Measured { value: f64::NAN, error: f64::NAN, ..Measured::default() },
    }
}

/// The value at h = 0: of all curves with three grids the one whose finest value is nearest to its own
/// extrapolation; the others tell how sure it is.
fn extrapolate(study: &mut Study) -> Option<f64> {
    let mut found: Vec<(String, Extrapolated)> = Vec::new();
    for curve in study.curves() {
        let [.., a, b, c] = curve[..] else { continue };
        let point = |index: usize| (study.cases[index].cell, get(study, index).value);
        if let Some(value) = order::richardson([a, b, c].map(point)) {
            found.push((study.label(&study.cases[c], false), value));
        }
    }
    let Some((label, best)) =
        found.iter().min_by(|a, b| a.1.distance.total_cmp(&b.1.distance)).cloned()
    else {
        study.reference =
            "unknown: no curve of three grids converges; give --exact or --reference".to_string();
        return None;
    };
    let far = found.iter().map(|(_, other)| (other.value - best.value).abs()).fold(0.0, f64::max);
    let of = if label.is_empty() { String::new() } else { format!(" of {label}") };
    study.reference = format!(
        "Richardson: {} at h = 0 from the three finest grids{of} (order {:.2}); \
         {} curves extrapolate within {} of it",
        brief(best.value),
        best.order,
        found.len(),
        brief(far)
    );
    Some(best.value)
}

fn set_errors(study: &mut Study, exact: Option<f64>, is_error: bool) {
    for index in 0..study.cases.len() {
        let relative = study.relative && !is_error;
        set(study, index, |measured| {
            measured.error = match exact {
                None => f64::NAN,
                Some(_) if is_error => measured.value.abs(),
                Some(exact) if relative => ((measured.value - exact) / exact).abs(),
                Some(exact) => (measured.value - exact).abs(),
            };
        });
    }
}

fn set_orders(study: &mut Study) {
    for curve in study.curves() {
        for (position, index) in curve.iter().enumerate() {
            let point = |index: usize| (study.cases[index].cell, get(study, index).error);
            let coarser = position.checked_sub(1).map(|before| curve[before]);
            let order = coarser.map_or(f64::NAN, |c| order::order(point(c), point(*index)));
            // Rounding of equal errors is no change.
            let worse = coarser.is_some_and(|c| point(*index).1 > 1.001 * point(c).1);
            set(study, *index, |measured| {
                measured.order = order;
                measured.worse = worse;
            });
        }
    }
}

fn set_pareto(study: &mut Study) {
    let points: Vec<(usize, f64, f64)> = (0..study.cases.len())
        .filter(|index| matches!(study.cases[*index].state, State::Done(_)))
        .map(|index| (index, study.seconds(&get(study, index)), get(study, index).error))
        .filter(|(_, _, error)| error.is_finite())
        .collect();
    for (index, seconds, error) in &points {
        let beaten = points.iter().any(|(other, s, e)| {
            other != index && s <= seconds && e <= error && (s < seconds || e < error)
        });
        set(study, *index, |measured| measured.pareto = !beaten);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Cost;
    use crate::study::child::Job;

    fn job() -> Job {
        Job {
            script: "a.mpm".into(),
            variables: Vec::new(),
            settings: Vec::new(),
            threads: 1,
            measure: "e_z".to_string(),
        }
    }

    /// Values f(h) of two shapes over three grids, seconds growing as 1/h^2.
    fn study(value: impl Fn(&str, f64) -> f64) -> Study {
        let mut cases = Vec::new();
        for shape in ["a", "b"] {
            for cells in [8.0, 16.0, 32.0] {
                let cpu = cells * cells * if shape == "a" { 1.0 } else { 2.0 };
                let measured =
                    Measured { value: value(shape, 1.0 / cells), cpu, ..Measured::default() };
                let values = vec![shape.to_string(), cells.to_string()];
                let state = State::Done(measured);
                let (job, cell, warnings) = (job(), 1.0 / cells, Vec::new());
                cases.push(Case { values, job, cell, warnings, state });
            }
        }
        let names = vec!["shape".to_string(), "cells".to_string()];
        let grids = grids(&names, &cases);
        Study {
            names,
            grids,
            cases,
            measure: "e".to_string(),
            reference: String::new(),
            warnings: Vec::new(),
            relative: true,
            cost: Cost::Cpu,
            below: 0.01,
        }
    }

    #[test]
    fn errors_orders_and_front_follow_from_the_numbers() {
        let mut study = study(|shape, h| if shape == "a" { 6.4 * h * h } else { 0.8 * h });
        assert_eq!(study.grids, [false, true]);
        set_errors(&mut study, Some(0.0), true);
        set_orders(&mut study);
        set_pareto(&mut study);
        let all: Vec<Measured> = study.done().map(|(_, measured)| measured.clone()).collect();
        assert!(all[0].order.is_nan() && (all[2].order - 2.0).abs() < 1e-12);
        assert!((all[5].order - 1.0).abs() < 1e-12 && !all[5].worse);
        // On 8 cells both have 0.1; b takes twice as long and never wins.
        let front: Vec<bool> = all.iter().map(|measured| measured.pareto).collect();
        assert_eq!(front, [true, true, true, false, false, false]);
        let (case, _) = study.cheapest().unwrap();
        assert_eq!(study.label(case, true), "shape=a cells=32");
    }

    #[test]
    fn grids_extrapolate_to_the_value_that_all_approach() {
        let mut study = study(|shape, h| 5.0 + if shape == "a" { h * h } else { -3.0 * h });
        let exact = extrapolate(&mut study).unwrap();
        assert!((exact - 5.0).abs() < 1e-9, "{}", study.reference);
        assert!(study.reference.contains("2 curves"), "{}", study.reference);
        let mut rising = self::study(|_, h| 1.0 / h);
        assert_eq!(extrapolate(&mut rising), None);
        assert!(rising.reference.starts_with("unknown"));
    }

    #[test]
    fn an_error_that_grows_on_finer_cells_is_marked() {
        let mut study = study(|shape, h| if shape == "a" { h } else { 1e-3 / h });
        set_errors(&mut study, Some(0.0), true);
        set_orders(&mut study);
        let worse: Vec<bool> = study.done().map(|(_, measured)| measured.worse).collect();
        assert_eq!(worse, [false, false, false, false, true, true]);
    }
}
