//! Plays the runs of a plan, one after another or a few at a time.

use super::child::{Ending, Finished};
use super::log::Taken;
use super::pace::Pace;
use super::plan::Plan;
use super::results::{Entry, Kept, Results};
use super::{Measured, Request, State, Stop};
use crate::interrupt;
use std::collections::BTreeSet;
use std::process::Command;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;
use std::time::Duration;

/// How often the user's wish to stop is looked at.
const GLANCE: Duration = Duration::from_millis(100);

/// A run to do: which case, which repeat.
type Turn = (usize, usize);

/// Plays what is not known yet; all repeats of a case become its numbers.
///
/// # Errors
/// The program cannot be started, results cannot be kept, or the user stopped it.
pub fn play_all(plan: &mut Plan, request: &Request) -> Result<(), Stop> {
    let files = |reason: std::io::Error| Stop::Files(format!("error: {reason}"));
    let mut results = Results::open(request.results.clone(), request.again).map_err(files)?;
    // All cases once, then all again: what slows the machine for a while slows all of them.
    let waiting: Vec<usize> =
        (0..plan.cases.len()).filter(|c| plan.cases[*c].state == State::Waiting).collect();
    let turns: Vec<Turn> = (0..request.repeat)
        .flat_map(|round| waiting.iter().map(move |case| (*case, round)))
        .filter(|(case, round)| results.get(plan.key(*case, *round)).is_none())
        .collect();
    let weights = turns.iter().map(|(case, _)| weight(plan.cases[*case].cell)).collect();
    let mut pace = Pace::new(weights, waiting.len() * request.repeat, request.quiet);
    let mut keep = |(case, round): Turn, ending: Ending| -> Result<(), Stop> {
        let entry: Entry = match ending {
            Ending::Interrupted => return Err(Stop::Interrupted),
            Ending::Failed(reason) => Err(reason),
            Ending::Done(finished) => Ok(kept(&finished, &request.taken)),
        };
        let label = plan.cases[case].values.join(" ");
        results.add(plan.key(case, round), &label, entry).map_err(files)
    };
    all_turns(plan, &turns, request.jobs, &mut pace, &mut keep)?;
    for case in waiting {
        let rounds = (0..request.repeat).filter_map(|round| results.get(plan.key(case, round)));
        let rounds: Result<Vec<&Kept>, String> =
            rounds.map(|entry| entry.as_ref().map_err(String::clone)).collect();
        let state = match rounds {
            Ok(rounds) => together(&rounds, request).map_or(State::Waiting, State::Done),
            Err(reason) => State::Failed(reason),
        };
        plan.cases[case].state = state;
    }
    Ok(())
}

/// How long a run takes beside others: steps times particles of a plane.
fn weight(cell: f64) -> f64 {
    if cell > 0.0 { cell.powi(-3) } else { 1.0 }
}

fn kept(finished: &Finished, taken: &Taken) -> Kept {
    Kept {
        value: taken.of(&finished.logged.rows),
        wall: finished.wall,
        cpu: finished.cpu,
        memory: finished.memory,
        steps: finished.logged.steps,
        particle_steps: finished.logged.particle_steps,
        seconds: finished.logged.seconds,
    }
}

fn all_turns(
    plan: &Plan,
    turns: &[Turn],
    jobs: usize,
    pace: &mut Pace,
    keep: &mut dyn FnMut(Turn, Ending) -> Result<(), Stop>,
) -> Result<(), Stop> {
    let next = AtomicUsize::new(0);
    let stop = AtomicBool::new(false);
    let processes: Mutex<BTreeSet<u32>> = Mutex::new(BTreeSet::new());
    let (sender, receiver) = mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..jobs.clamp(1, turns.len().max(1)) {
            let sender = sender.clone();
            let (next, stop, processes) = (&next, &stop, &processes);
            scope.spawn(move || {
                while !stop.load(Ordering::Relaxed) {
                    let turn = next.fetch_add(1, Ordering::Relaxed);
                    let Some((case, round)) = turns.get(turn) else { break };
                    let mine = Mutex::new(0);
                    let started = |process: Option<u32>| {
                        let mut all = processes.lock().unwrap_or_else(PoisonError::into_inner);
                        let mut mine = mine.lock().unwrap_or_else(PoisonError::into_inner);
                        match process {
                            Some(process) => all.insert(process),
                            None => all.remove(&*mine),
                        };
                        *mine = process.unwrap_or(0);
                    };
                    let ending = plan.cases[*case].job.play(&plan.statements, started);
                    if sender.send((turn, (*case, *round), ending)).is_err() {
                        break;
                    }
                }
            });
        }
        drop(sender);
        let result = listen(&receiver, pace, keep);
        if result.is_err() {
            stop.store(true, Ordering::Relaxed);
            end(&processes.lock().unwrap_or_else(PoisonError::into_inner));
        }
        pace.finish();
        result
    })
}

type Message = (usize, Turn, std::io::Result<Ending>);

fn listen(
    receiver: &mpsc::Receiver<Message>,
    pace: &mut Pace,
    keep: &mut dyn FnMut(Turn, Ending) -> Result<(), Stop>,
) -> Result<(), Stop> {
    loop {
        match receiver.recv_timeout(GLANCE) {
            Ok((number, turn, ending)) => {
                let ending = ending.map_err(|reason| {
                    Stop::Files(format!("error: a run cannot start: {reason}"))
                })?;
                keep(turn, ending)?;
                pace.done(number);
            }
            Err(mpsc::RecvTimeoutError::Disconnected) => return Ok(()),
            Err(mpsc::RecvTimeoutError::Timeout) => pace.show(),
        }
        if interrupt::requested() {
            return Err(Stop::Interrupted);
        }
    }
}

/// Asks processes to end; runs stop after the step under way.
fn end(processes: &BTreeSet<u32>) {
    for process in processes {
        // One that has ended by itself meanwhile needs no asking.
        let _ = Command::new("kill").arg(process.to_string()).status();
    }
}

/// The numbers of a case from its repeats; `None` without any.
fn together(rounds: &[&Kept], request: &Request) -> Option<Measured> {
    let first = rounds.first()?;
    let all = |pick: fn(&Kept) -> f64| rounds.iter().map(|kept| pick(kept)).collect::<Vec<f64>>();
    let seconds = match request.cost {
        super::Cost::Cpu => all(|kept| kept.cpu),
        super::Cost::Wall => all(|kept| kept.wall),
    };
    let speed = |kept: &Kept| {
        if kept.seconds > 0.0 { kept.particle_steps / kept.seconds } else { f64::NAN }
    };
    Some(Measured {
        value: first.value,
        cpu: median(all(|kept| kept.cpu)),
        wall: median(all(|kept| kept.wall)),
        spread: spread(&seconds),
        memory: all(|kept| kept.memory).into_iter().fold(0.0, f64::max),
        steps: first.steps,
        speed: median(all(speed)),
        ..Measured::default()
    })
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        count => 0.5 * (values[(count - 1) / 2] + values[count / 2]),
    }
}

fn spread(values: &[f64]) -> f64 {
    let (low, high) =
        values.iter().fold((f64::INFINITY, 0.0f64), |(low, high), v| (low.min(*v), high.max(*v)));
    let middle = median(values.to_vec());
    if middle > 0.0 { (high - low) / middle } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_and_spreads() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0]), 2.5);
        assert!((spread(&[1.0, 1.2, 0.9]) - 0.3).abs() < 1e-12);
        assert_eq!(spread(&[1.0]), 0.0);
    }
}
