//! What a run is about: the summary at its start, and `check`.

use super::overlap::overlapping;
use super::trial::{Trial, duration};
use super::{Simulation, Until};
use crate::fault::Fault;
use crate::kernel::survey::Survey;
use crate::math::exact_sum::ExactSum;
use crate::memory;
use crate::method::METHODS;
use crate::model::column::Column;
use crate::model::contact::Rule;
use crate::model::domain::{Boundary, Domain};
use crate::model::grid::Node;
use crate::model::group::Members;
use crate::scheme::{SCHEMES, SchemeKind};
use crate::shape::corners::{DOMAINS, dimensions_of};
use crate::shape::{SHAPES, ShapeKind};
use crate::step::Stage;
use crate::style::Style;
use crate::time_step::TimeStep;
use crate::transfer::TRANSFERS;
use std::fmt::Write;

/// `20 x 10 cells of 0.05`.
fn cells_in_words(cells: &Domain) -> String {
    let counts: Vec<String> =
        cells.cells()[..cells.dimension].iter().map(|count| count.to_string()).collect();
    format!("{} cells of {}", counts.join(" x "), cells.cell)
}

/// Loads and messages of a scene on several processes, and how fast they would be.
fn on_processes(survey: &Survey, trial: Option<&Trial>) -> String {
    let Survey { processes, imbalance, uniform_imbalance, messages, nodes } = survey;
    let speed = trial.map(|trial| format!("; about {:.1} times as fast", speed_up(survey, trial)));
    let speed = speed.unwrap_or_default();
    format!(
        "  {processes} processes: the fullest has {imbalance:.2} times the mean number of particles (an equal \
         cut of the box: {uniform_imbalance:.2}); a process sends {:.2} messages with {:.2} nodes per sweep \
         (at most {} and {}){speed}",
        messages[0], nodes[0], messages[1], nodes[1]
    )
}

/// Seconds that a message between machines takes before its first byte, and bytes per second after
/// it: a common cluster network.
const LATENCY: f64 = 2e-6;
const BANDWIDTH: f64 = 1e10;

/// Bytes that a node takes in a message: mass, momentum and force.
const NODE_BYTES: f64 = 56.0;

/// Reductions of a step, which pass the processes as a tree, there and back.
const REDUCTIONS: f64 = 2.0;

/// One process over so many, each with the threads of this one: the fullest one's share of the step,
/// its messages in every sweep that adds to nodes, and the reductions. Nothing is hidden behind the
/// work, and caches do not grow with the processes.
fn speed_up(survey: &Survey, trial: &Trial) -> f64 {
    let Survey { processes, imbalance, messages, nodes, .. } = survey;
    let share = trial.seconds * imbalance / *processes as f64;
    let exchange = trial.scatters * (messages[1] * LATENCY + nodes[1] * NODE_BYTES / BANDWIDTH);
    let agreement = REDUCTIONS * 2.0 * (*processes as f64).log2().ceil() * LATENCY;
    trial.seconds / (share + exchange + agreement)
}

/// What steps cost, and so the run.
fn add_trial(text: &mut String, trial: &Trial, steps: Option<u64>) {
    let Trial { steps: played, seconds, sweeps, scatters } = trial;
    let run = steps.map(|steps| format!("about {}, ", duration(steps as f64 * seconds)));
    let _ = writeln!(
        text,
        "{:<20}{}{} per step (the first {played}, without outputs)",
        "time",
        run.unwrap_or_default(),
        duration(*seconds)
    );
    let _ = writeln!(
        text,
        "{:<20}{sweeps:.1} over the particles per step, {scatters:.1} of them add to nodes",
        "sweeps"
    );
}

impl Simulation {
    /// Prepares the state a run would start from, and gives its stable time step; `None` without
    /// particles. Fixes that act once do so.
    ///
    /// # Errors
    /// A formula of a fix that is not finite.
    pub fn stable_limit(&mut self) -> Result<Option<TimeStep>, Fault> {
        self.ready()?;
        let [count] = self.world.ranks.count([self.world.particles.len()]);
        Ok((count > 0).then(|| self.stable_now()))
    }

    /// The steps a run will take, as far as that is known.
    pub fn expected_steps(&self, until: &Until) -> Option<u64> {
        match until {
            Until::Steps(steps) => Some(*steps),
            Until::Time(time) => {
                let dt = self.fixed_dt.unwrap_or_else(|| self.stable_now().dt);
                Some((time / dt).ceil() as u64)
            }
            Until::While(_) | Until::Condition(_) => None,
        }
    }

    /// Numbers that show wrong units and wrong sizes at once.
    pub fn summary(&self) -> Vec<(&'static str, String)> {
        let world = &self.world;
        let particles = &world.particles;
        let masses = particles.counted().map(|p| particles.position[p][3]);
        let mass = world.ranks.total(&ExactSum::of(masses));
        let [count, nodes] = world.ranks.count([particles.counted().len(), self.counted_nodes()]);
        let [_, mean, _] = self.memory();
        let waves = world.solids.iter().map(|solid| solid.law.reference_wave_speed());
        let stable = self.stable_now();
        let round = world.method.axisymmetric;
        let grids: Vec<String> = match world.method.total {
            true => world.solids.iter().map(|solid| cells_in_words(&solid.cells)).collect(),
            false => vec![cells_in_words(&world.domain)],
        };
        let dt = match self.fixed_dt {
            Some(dt) => format!("{dt} (set_dt); stable: {:.4e}", stable.dt),
            None => format!("{:.4e} ({} limit)", stable.dt, stable.limit.name()),
        };
        let mut rows = vec![
            ("particles", format!("{count} in {} solids", world.solids.len())),
            ("method", self.method_in_words()),
            ("grid", grids.join(", ")),
            ("active nodes", nodes.to_string()),
            ("mass", format!("{mass:.6e}{}", if round { " per radian" } else { "" })),
            ("wave speed", format!("{:.6e}", waves.fold(0.0, f64::max))),
            ("first time step", dt),
            ("memory", memory::text(mean * world.ranks.size() as f64)),
            (
                "threads",
                match world.ranks.size() {
                    1 => rayon::current_num_threads().to_string(),
                    size => format!("{} in each of {size} processes", rayon::current_num_threads()),
                },
            ),
        ];
        rows.extend(self.unit_hint().map(|hint| ("units?", hint)));
        rows
    }

    /// Method, transfer, shape and scheme, in the words of the script.
    fn method_in_words(&self) -> String {
        fn word<B: Copy>(table: &'static [Style<B>], is: impl Fn(B) -> bool) -> &'static str {
            let row = table.iter().find(|row| row.build.is_some_and(&is));
            row.map_or("", |row| row.name)
        }
        let (method, transfer) = (self.world.method, self.transfer);
        let kind = std::mem::discriminant(&transfer.kind);
        let corners = matches!(method.shape, ShapeKind::Corners(_));
        let mut words = vec![
            word(METHODS, |kind| (kind.total, kind.corners) == (method.total, corners)).to_string(),
            word(TRANSFERS, |other| std::mem::discriminant(&other) == kind).to_string(),
        ];
        words.extend(transfer.filter_terms().map(|terms| terms.to_string()));
        if corners {
            words.extend([word(SHAPES, |shape| shape == ShapeKind::Linear).to_string()]);
            let dimension = self.world.domain.dimension;
            let domain = DOMAINS.iter().find(|row| {
                row.build == Some(method.shape) && dimensions_of(row.name).contains(&dimension)
            });
            words.extend(domain.map(|row| row.name.to_string()));
        } else {
            words.push(word(SHAPES, |shape| shape == method.shape).to_string());
        }
        match transfer.time_constant {
            Some(tau) => words.push(format!("time-constant {tau}")),
            None if transfer.kind.takes_blend() => words.push(transfer.alpha.to_string()),
            None => {}
        }
        if transfer.gradient_enhanced {
            words.push("gradient-enhanced".to_string());
        }
        if method.conducts_heat {
            words.push("thermo-mechanical".to_string());
        }
        let scheme = self.scheme.kind();
        words.push(word(SCHEMES, |other| other.kind() == scheme).to_string());
        words.join(", ")
    }

    /// Active nodes that this process counts.
    fn counted_nodes(&self) -> usize {
        let grid = &self.world.grid;
        grid.runs.iter().cloned().flatten().filter(|node| grid.counts(*node)).count()
    }

    /// Bytes of the process with least, of the mean, and of that with most.
    pub fn memory(&self) -> [f64; 3] {
        let here = self.bytes() as f64;
        let ranks = &self.world.ranks;
        let [least, most] = ranks.largest([-here, here]);
        [-least, ranks.total(&ExactSum::of([here])) / ranks.size() as f64, most]
    }

    /// Bytes of particles and nodes of this process.
    pub fn bytes(&self) -> usize {
        let world = &self.world;
        let each = std::mem::size_of::<Node>() + 32;
        let nodes = world.grid.len() * each;
        world.particles.len() * world.particles.bytes_each() + nodes
    }

    /// What would run: sizes, effects on and off with their reasons.
    ///
    /// # Errors
    /// A formula of a fix that is not finite.
    pub fn describe(&mut self, until: &Until, processes: &[usize]) -> Result<String, Fault> {
        let played = self.world.ranks.is_alone() && !self.world.particles.is_empty();
        let trial = if played { Some(self.trial()) } else { None };
        self.ready()?;
        let mut text = String::new();
        for (name, value) in self.summary() {
            let _ = writeln!(text, "{name:<20}{value}");
        }
        let steps = self.expected_steps(until);
        if let Some(steps) = steps {
            let _ = writeln!(text, "{:<20}about {steps}", "steps");
        }
        match &trial {
            Some(Ok(trial)) => add_trial(&mut text, trial, steps),
            Some(Err(fault)) => {
                let _ = writeln!(text, "{:<20}the first steps end with: {fault}", "time");
            }
            None => {}
        }
        let _ = writeln!(text, "{:<20}{}", "bytes per particle", self.world.particles.bytes_each());
        let columns = self.world.particles.present.iter().map(|column| column.info().name);
        let _ = writeln!(text, "{:<20}{}", "columns", columns.collect::<Vec<_>>().join(" "));
        for (effect, reason) in self.effects() {
            let _ = writeln!(text, "  {effect:<28}{reason}");
        }
        for processes in processes {
            let survey = self.loops.sorter.survey(&self.world, &self.loops.tiles, *processes);
            let trial = trial.as_ref().and_then(|trial| trial.as_ref().ok());
            let _ = writeln!(text, "{}", on_processes(&survey, trial));
        }
        for ([a, b], count) in overlapping(&self.world) {
            let [a, b] = [a, b].map(|solid| &self.world.solids[solid].name);
            let _ = writeln!(
                text,
                "  solids {a} and {b} overlap: {count} cells have more matter of both than room for it"
            );
        }
        for (index, group) in self.world.groups.0.iter().enumerate().skip(1) {
            let count = match &group.members {
                Members::Nodes { .. } => {
                    let grid = &self.world.grid;
                    let members = grid.of_group(crate::model::group::GroupId(index)).iter();
                    members.filter(|node| grid.counts(**node as usize)).count()
                }
                members => {
                    let particles = &self.world.particles;
                    particles.counted().filter(|p| particles.belongs(*p, members)).count()
                }
            };
            let [count] = self.world.ranks.count([count]);
            let empty = if count == 0 { ": nothing acts on it yet" } else { "" };
            let _ = writeln!(text, "  group {:<20}{count} members now{empty}", group.name);
        }
        Ok(text)
    }

    /// What happens at the limits of the box.
    fn boundary_in_words(&self) -> &'static str {
        match (self.world.method.total, self.world.boundary) {
            (true, _) => "off: the box is for outputs only",
            (_, Boundary::Error) => "error: a particle that leaves the box stops the run",
            (_, Boundary::Delete) => "delete: particles that leave the box are removed and counted",
            (_, Boundary::Bounce) => "bounce: particles are reflected by the box",
        }
    }

    /// The contacts of bodies with velocities of their own.
    fn contacts_in_words(&self) -> String {
        let world = &self.world;
        let each = world.contacts.list.iter().map(|contact| {
            let bodies = match contact.solids {
                Some([a, b]) => format!("{}, {}", world.solids[a].name, world.solids[b].name),
                None => "all".to_string(),
            };
            let rule = match contact.rule {
                Rule::Welded | Rule::Stick => "stick".to_string(),
                Rule::Slip => "slip".to_string(),
                Rule::Frictional(mu) => format!("frictional {mu}"),
            };
            let touching = if contact.touching { "" } else { ", on_nodes" };
            format!("{} ({rule}: {bodies}{touching})", contact.name)
        });
        let each: Vec<String> = each.collect();
        format!("on: {} in {} fields", each.join(", "), world.grid.lattices.len())
    }

    /// Effects of the scene: on or off, and why.
    fn effects(&self) -> Vec<(&'static str, String)> {
        let plan = self.make_plan();
        let on = |yes: bool, why: &str, otherwise: &str| match yes {
            true => format!("on: {why}"),
            false => format!("off: {otherwise}"),
        };
        let has = |column: Column| plan.columns.contains(column);
        let split = |stages: &[Stage]| stages.iter().any(|stage| plan.stages[*stage as usize]);
        let acting: Vec<&str> = self
            .fixes
            .iter()
            .filter(|(_, fix)| !fix.stages().is_empty())
            .map(|(id, _)| id.as_str())
            .collect();
        vec![
            ("stress", "on: every solid has a law".to_string()),
            (
                "deformation gradient",
                on(has(Column::F11), "a law or an output reads F", "only J is needed"),
            ),
            ("adaptive time step", on(plan.wave_speed, "wave speeds are computed", "set_dt")),
            (
                "external nodal forces",
                on(plan.external_force, "something reads them", "nothing reads them"),
            ),
            (
                "fixes in every step",
                on(!acting.is_empty(), &acting.join(", "), "no fix acts at a stage of the step"),
            ),
            (
                "one sweep for G2P + P2G",
                on(
                    !split(&[Stage::PostGridToPoint, Stage::PostAdvanceParticles]),
                    "no fix acts between",
                    "a fix acts between",
                ),
            ),
            (
                "one sweep for stress + P2G",
                on(!split(&[Stage::InitialIntegrate]), "no fix acts between", "a fix acts between"),
            ),
            (
                "affine velocity field",
                on(self.transfer.has_matrix(), "the transfer has one", "the transfer has none"),
            ),
            (
                "second mapping",
                on(self.scheme.kind() == SchemeKind::Musl, "scheme musl", "the scheme has none"),
            ),
            (
                "axisymmetric",
                on(
                    self.world.method.axisymmetric,
                    "x is the radius; masses, forces, energies per radian",
                    "axisymmetric(true) does not stand in the script",
                ),
            ),
            ("F-bar", on(self.world.method.averaged_dilation, "anti_locking", "anti_locking none")),
            ("energy ledger", on(plan.ledger, "a compute reads it", "no compute reads it")),
            (
                "temperature",
                on(
                    has(Column::Temperature),
                    "a material reads it",
                    "no material has a temperature law or depends on the temperature",
                ),
            ),
            ("boundary", self.boundary_in_words().to_string()),
            (
                "conduction of heat",
                on(
                    self.world.grid.keeps.temperature,
                    "thermo-mechanical, and a material has a heat capacity",
                    "mechanical, or no material has a heat capacity",
                ),
            ),
            (
                "contact",
                match self.world.method.total {
                    _ if !self.world.contacts.is_empty() => self.contacts_in_words(),
                    _ if plan.contact => "on: a contact fix".to_string(),
                    true => "off: bodies have grids of their own and no contact fix".to_string(),
                    false => "the grid's own, where bodies share nodes".to_string(),
                },
            ),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_shared_until_messages_take_longer() {
        let trial = Trial { steps: 1, seconds: 1e-3, sweeps: 2.0, scatters: 2.0 };
        let survey = |processes, messages, nodes| Survey {
            processes,
            imbalance: 1.0,
            uniform_imbalance: 1.0,
            messages: [messages; 2],
            nodes: [nodes; 2],
        };
        assert_eq!(speed_up(&survey(1, 0.0, 0.0), &trial), 1.0);
        // 500 us of work, 2 (2 us + 1000 56 B/10 GB/s) of messages, 8 us of reductions.
        let two = speed_up(&survey(2, 1.0, 1000.0), &trial);
        assert!((two - 1e-3 / (500e-6 + 2.0 * (2e-6 + 5.6e-6) + 8e-6)).abs() < 1e-9, "{two}");
        assert!(speed_up(&survey(1 << 20, 20.0, 0.0), &trial) < 10.0);
    }
}
