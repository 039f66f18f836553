//! Plays a script in silence: how it ended, its log, its warnings, its state.

use karamelo::command::play::{perform, rehearse};
use karamelo::command::session::{Mode, Session, Stop};
use karamelo::model::column::Column;
use karamelo::output::{OutputOptions, Outputs};
use karamelo::script::diagnostic::{Diagnostic, Severity};
use karamelo::script::source::Source;

/// What became of a script.
pub struct Played {
    /// Mistakes that were found before anything ran.
    pub refused: Vec<String>,
    /// Warnings with their codes, those at the end of a run too.
    pub warnings: Vec<String>,
    /// How it ended.
    pub end: Result<(), String>,
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
    /// The state at the end.
    pub session: Session,
}

/// Plays a script.
pub fn play(text: &str) -> Played {
    let (script, found) = rehearse(Source::new("scene.mpm", text), &[]);
    let of = |severity: Severity| {
        let wanted = found.iter().filter(move |remark| remark.severity == severity);
        wanted.map(|remark| format!("{} {}", remark.code.number(), remark.message))
    };
    let refused: Vec<String> = of(Severity::Error).collect();
    let mut warnings: Vec<String> = of(Severity::Warning).collect();
    let place = tempfile::tempdir().unwrap();
    let log = place.path().join("log.mpm");
    let title = "scene".to_string();
    let options = OutputOptions { quiet: true, log: Some(log.clone()), title, mute: false };
    let mut session = Session::new(Outputs::new(options), Mode::Run);
    if !refused.is_empty() {
        let end = Err(refused.join("; "));
        return Played { refused, warnings, end, names: Vec::new(), rows: Vec::new(), session };
    }
    let words = |mistakes: &[Diagnostic]| mistakes.first().map_or("", |m| &m.message).to_string();
    let end = perform(&script, &mut session).map_err(|stop| match stop {
        Stop::Fault(fault) => match fault.cause {
            Some(cause) => format!("{}; likely cause: {cause}", fault.what),
            None => fault.what,
        },
        Stop::Script(mistakes) => words(&mistakes),
        Stop::Interrupted => "interrupted".to_string(),
    });
    session.simulation.outputs.close().unwrap();
    let text = std::fs::read_to_string(log).unwrap_or_default();
    let said = text.lines().filter(|line| line.trim_start().starts_with("warning"));
    warnings.extend(said.map(str::to_string));
    let names = text.lines().find(|line| line.trim_start().starts_with("Step "));
    let names = names.unwrap_or("").split_whitespace().map(str::to_string).collect();
    let numbers = |line: &str| {
        line.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<f64>>>()
    };
    let rows = text.lines().filter_map(numbers).filter(|row| row.len() > 1).collect();
    Played { refused, warnings, end, names, rows, session }
}

impl Played {
    /// A column of the log.
    pub fn column(&self, name: &str) -> Vec<f64> {
        let known = self.names.iter().position(|known| known == name);
        let place = known.unwrap_or_else(|| panic!("no column `{name}` in {:?}", self.names));
        self.rows.iter().filter_map(|row| row.get(place).copied()).collect()
    }

    /// The first and the last value of a column.
    pub fn ends(&self, name: &str) -> [f64; 2] {
        let column = self.column(name);
        [column[0], column[column.len() - 1]]
    }

    /// The largest of a column over its first value.
    pub fn growth(&self, name: &str) -> f64 {
        let column = self.column(name);
        column.iter().fold(0.0, |most: f64, x| if x.is_nan() { f64::NAN } else { most.max(*x) })
            / column[0]
    }

    /// The largest of the second half of a column over the largest of its first tenth. A step near the
    /// stable one shows kinetic and stored energy at different instants, so that their sum swings
    /// about what is kept: only its trend tells.
    pub fn trend(&self, name: &str) -> f64 {
        let column = self.column(name);
        let most = |part: &[f64]| {
            let any = part.iter().any(|x| x.is_nan());
            if any { f64::NAN } else { part.iter().fold(0.0f64, |most, x| most.max(*x)) }
        };
        most(&column[column.len() / 2..]) / most(&column[..column.len() / 10 + 1])
    }

    /// Steps taken.
    pub fn steps(&self) -> u64 {
        self.session.simulation.clock.step
    }

    /// A column of the particles, in the order of their ids.
    pub fn particles(&self, column: Column) -> Vec<f64> {
        let particles = &self.session.simulation.world.particles;
        let mut list: Vec<(u32, f64)> =
            particles.id.iter().copied().zip(particles.column(column).iter().copied()).collect();
        list.sort_by_key(|(id, _)| *id);
        list.into_iter().map(|(_, value)| value).collect()
    }

    /// Places of the particles, in the order of their ids.
    pub fn places(&self) -> Vec<[f64; 3]> {
        let particles = &self.session.simulation.world.particles;
        let mut list: Vec<(u32, [f64; 3])> = particles
            .id
            .iter()
            .zip(&particles.position)
            .map(|(id, x)| (*id, [x[0], x[1], x[2]]))
            .collect();
        list.sort_by_key(|(id, _)| *id);
        list.into_iter().map(|(_, place)| place).collect()
    }

    /// Are places, velocities and volumes finite?
    pub fn is_finite(&self) -> bool {
        let particles = &self.session.simulation.world.particles;
        let both = particles.position.iter().chain(&particles.velocity);
        both.flatten().all(|x| x.is_finite())
            && particles.column(Column::J).iter().all(|x| x.is_finite())
    }
}
