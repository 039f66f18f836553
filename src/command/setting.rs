//! `--set NAME=VALUE` and `--measure`: other words in the place of those a script writes.
//!
//! A setting changes arguments of parsed statements, so the script stays as it is and every mistake
//! is shown at the place of the words that were there. Each change is reported as the line that
//! now holds.

mod measure;
mod words;

use crate::script::arguments::Name;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::source::{Source, Span};
use crate::script::suggest;
use crate::script::syntax::{Argument, Statement};
pub use measure::measure;
use words::MethodWords;

/// A name and what it is set to.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Setting {
    /// The name.
    pub name: String,
    /// The words in its place.
    pub value: String,
}

/// A line that now holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// Where the statement stands that was changed, or before which one was added.
    pub span: Span,
    /// The statement as it now is; empty if it was taken away.
    pub line: String,
    /// The setting that did it.
    pub setting: String,
}

/// Names of settings with the statement they change.
pub const SETTINGS: &[(&str, &str)] = &[
    ("method", "the type: ulmpm, tlmpm, ulcpdi, tlcpdi"),
    ("transfer", "the sub-method: PIC, FLIP, FLIP:0.99, APIC, XPIC:3, PIC:gradient-enhanced, ..."),
    ("alpha", "the blend of FLIP, AFLIP, ASFLIP"),
    ("shape", "the shape function; a domain of CPDI (R4, Q4, ...) makes the method CPDI"),
    ("scheme", "musl, usl, usf"),
    ("ppc", "particles per cell and axis of every solid from a region"),
    ("cell", "the cell size of box and solids [L], or a factor: x0.5"),
    ("dt_factor", "the part of the stable time step"),
    ("set_dt", "the constant time step [T], or auto"),
    ("stress_rate", "none, jaumann, green_naghdi, logarithmic"),
    ("anti_locking", "none, fbar"),
    ("thermal_blend", "0 to 1"),
    ("boundary", "error, delete, bounce"),
    ("set_output", "steps between rows of the log"),
    ("run", "the number of steps; one run only"),
    ("run_time", "the time [T]; one run only"),
    ("dumps", "on, off: files of dumps and plots"),
];

/// Commands that write files.
const FILES: [&str; 4] = ["dump", "undump", "plot", "save_plot"];

/// Commands that run.
pub const RUNS: [&str; 4] = ["run", "run_time", "run_while", "run_until"];

/// The column of the log that `--measure` adds.
pub const MEASURED: &str = "measured";

impl Setting {
    /// Reads `NAME=VALUE`.
    ///
    /// # Errors
    /// Another form, or an unknown name.
    pub fn parse(text: &str) -> Result<Self, String> {
        let Some((name, value)) = text.split_once('=') else {
            return Err(format!("`{text}` is not NAME=VALUE"));
        };
        if value.trim().is_empty() {
            return Err(format!("`{text}` gives no value"));
        }
        let setting = Self { name: name.trim().to_string(), value: value.trim().to_string() };
        match SETTINGS.iter().any(|(known, _)| *known == setting.name) {
            true => Ok(setting),
            false => Err(unknown(&setting.name)),
        }
    }

    /// As on the command line.
    pub fn text(&self) -> String {
        format!("{}={}", self.name, self.value)
    }
}

/// Is there a setting of this name?
pub fn is_setting(name: &str) -> bool {
    SETTINGS.iter().any(|(known, _)| *known == name)
}

fn unknown(name: &str) -> String {
    let known = SETTINGS.iter().map(|(known, _)| *known);
    let all: Vec<&str> = known.clone().collect();
    let help = suggest::help(name, known, &format!("settings: {}", all.join(", ")));
    format!("there is no setting `{name}`: {help}")
}

/// Changes statements; gives the lines that now hold. `variables` are those of `-var`.
///
/// # Errors
/// The script has no statement that could take a setting, or a setting that contradicts it.
pub fn apply(
    statements: &mut Vec<Statement>,
    settings: &[Setting],
    variables: &[(String, String)],
    source: &Source,
) -> Result<Vec<Change>, Diagnostic> {
    let mut edit = Edit { statements, changes: Vec::new(), variables, source };
    for setting in settings {
        edit.apply(setting)?;
    }
    Ok(edit.changes)
}

fn is_run(statement: &Statement) -> bool {
    matches!(statement, Statement::Call { name, .. } if RUNS.contains(&name.text.as_str()))
}

fn span_of(statement: &Statement) -> Span {
    match statement {
        Statement::Assign { name, value } => Span::new(name.span.start, value.span.end),
        Statement::Call { span, .. } | Statement::Quit { span } => *span,
    }
}

fn argument(text: &str, span: Span) -> Argument {
    Argument { span, text: text.to_string(), quoted: false }
}

/// A statement as a line of a script.
fn line(statement: &Statement) -> String {
    match statement {
        Statement::Assign { name, value } => format!("{} = {}", name.text, value.text.trim()),
        Statement::Call { name, arguments, .. } => {
            let words: Vec<&str> = arguments.iter().map(|a| a.text.trim()).collect();
            format!("{}({})", name.text, words.join(", "))
        }
        Statement::Quit { .. } => "quit".to_string(),
    }
}

fn missing(statements: &[Statement], source: &Source, message: impl Into<String>) -> Diagnostic {
    let end = source.text.trim_end().len();
    let span = statements.last().map_or(Span::new(end, end), span_of);
    Diagnostic::error(Code::Missing, span, message).label("the script ends without it")
}

/// A script being changed.
struct Edit<'a> {
    statements: &'a mut Vec<Statement>,
    changes: Vec<Change>,
    /// `-var`: they win over assignments.
    variables: &'a [(String, String)],
    source: &'a Source,
}

impl Edit<'_> {
    fn apply(&mut self, setting: &Setting) -> Result<(), Diagnostic> {
        let value = setting.value.as_str();
        match setting.name.as_str() {
            "method" | "transfer" | "alpha" | "shape" => self.method(setting),
            "ppc" => self.particles_per_cell(setting),
            "cell" => self.cell(setting),
            "dumps" if value == "on" => Ok(()),
            "dumps" if value == "off" => {
                self.without_files();
                Ok(())
            }
            "dumps" => Err(self.refused(setting, None, "`dumps` is on or off")),
            "run" | "run_time" => self.only_run(setting),
            "dt_factor" => {
                if let Some(span) = self.fixed_step() {
                    let message = "`set_dt` gives the time step: `dt_factor` would change nothing";
                    return Err(self.refused(setting, Some(span), message));
                }
                self.one_argument(setting)
            }
            name if is_setting(name) => self.one_argument(setting),
            name => Err(self.refused(setting, None, &unknown(name))),
        }
    }

    fn refused(&self, setting: &Setting, span: Option<Span>, message: &str) -> Diagnostic {
        let first = self.statements.first().map_or(Span::default(), span_of);
        Diagnostic::error(Code::NotCombined, span.unwrap_or(first), message)
            .label(format!("cannot take `{}`", setting.text()))
    }

    /// Numbers of the calls of a command.
    fn calls(&self, command: &str) -> Vec<usize> {
        let is = |statement: &Statement| matches!(statement, Statement::Call { name, .. } if name.text == command);
        (0..self.statements.len()).filter(|index| is(&self.statements[*index])).collect()
    }

    fn first_run(&self, setting: &Setting) -> Result<usize, Diagnostic> {
        self.statements.iter().position(is_run).ok_or_else(|| {
            let message = format!("the script has no run that could take `{}`", setting.text());
            missing(self.statements, self.source, message)
        })
    }

    fn arguments(&self, index: usize) -> &[Argument] {
        match &self.statements[index] {
            Statement::Call { arguments, .. } => arguments,
            _ => &[],
        }
    }

    /// Puts other arguments in the place of those of a call.
    fn replace(&mut self, index: usize, new: Vec<Argument>, setting: &Setting) {
        if let Statement::Call { arguments, .. } = &mut self.statements[index] {
            *arguments = new;
        }
        let statement = &self.statements[index];
        let change =
            Change { span: span_of(statement), line: line(statement), setting: setting.text() };
        // Several settings may change one statement: its last form holds.
        match self.changes.iter_mut().find(|known| known.span == change.span) {
            Some(known) => {
                known.setting = format!("{}, {}", known.setting, change.setting);
                known.line = change.line;
            }
            None => self.changes.push(change),
        }
    }

    /// A command of one argument: changed where it stands, added before the first run otherwise.
    fn one_argument(&mut self, setting: &Setting) -> Result<(), Diagnostic> {
        let mut calls = self.calls(&setting.name);
        if setting.name == "set_output" {
            calls.extend(self.calls("log"));
        }
        if setting.name == "anti_locking" && !self.calls("anti_volumetric_locking").is_empty() {
            let span = span_of(&self.statements[self.calls("anti_volumetric_locking")[0]]);
            let message = "the script writes `anti_volumetric_locking`";
            return Err(self.refused(setting, Some(span), message));
        }
        if !calls.is_empty() {
            for index in calls {
                let old = self.arguments(index).first().map(|old| old.span);
                let span = old.unwrap_or_else(|| span_of(&self.statements[index]));
                self.replace(index, vec![argument(&setting.value, span)], setting);
            }
            return Ok(());
        }
        let run = self.first_run(setting)?;
        let span = span_of(&self.statements[run]);
        let name = Name { text: setting.name.clone(), span };
        let arguments = vec![argument(&setting.value, span)];
        let added = Statement::Call { name, arguments, span };
        self.changes.push(Change { span, line: line(&added), setting: setting.text() });
        self.statements.insert(run, added);
        Ok(())
    }

    /// Where a `set_dt` stands that gives a number.
    fn fixed_step(&self) -> Option<Span> {
        let fixed =
            |index: &usize| self.arguments(*index).first().is_some_and(|a| a.text != "auto");
        self.calls("set_dt").into_iter().find(fixed).map(|index| span_of(&self.statements[index]))
    }

    /// `run` or `run_time` of a script that runs once.
    fn only_run(&mut self, setting: &Setting) -> Result<(), Diagnostic> {
        let runs: Vec<usize> =
            (0..self.statements.len()).filter(|index| is_run(&self.statements[*index])).collect();
        let found = self.calls(&setting.name);
        match (runs.as_slice(), found.as_slice()) {
            ([_], [only]) => {
                let span = self.arguments(*only).first().map_or(Span::default(), |old| old.span);
                self.replace(*only, vec![argument(&setting.value, span)], setting);
                Ok(())
            }
            _ => {
                let message = format!("the script does not run once, by `{}`", setting.name);
                Err(self.refused(
                    setting,
                    runs.last().map(|r| span_of(&self.statements[*r])),
                    &message,
                ))
            }
        }
    }

    /// Takes away what writes files.
    fn without_files(&mut self) {
        let writes = |statement: &Statement| matches!(statement, Statement::Call { name, .. } if FILES.contains(&name.text.as_str()));
        self.statements.retain(|statement| !writes(statement));
    }

    fn method(&mut self, setting: &Setting) -> Result<(), Diagnostic> {
        let Some(index) = self.calls("method").first().copied() else {
            let message = "the script has no `method(...)` to change";
            return Err(missing(self.statements, self.source, message));
        };
        let span = span_of(&self.statements[index]);
        let Some(mut words) = MethodWords::read(self.arguments(index)) else {
            let message = "this `method(...)` cannot be read";
            return Err(self.refused(setting, Some(span), message));
        };
        let changed = match setting.name.as_str() {
            "method" => words.set_type(&setting.value),
            "transfer" => words.set_transfer(&setting.value),
            "shape" => words.set_shape(&setting.value),
            _ => words.set_alpha(&setting.value),
        };
        changed.map_err(|(span, message)| self.refused(setting, Some(span), &message))?;
        self.replace(index, words.arguments(), setting);
        Ok(())
    }

    /// Places of ppc and of h among the arguments of a solid.
    fn places(arguments: &[Argument]) -> (Option<usize>, Option<usize>) {
        match arguments.get(1).map(|word| word.text.as_str()) {
            Some("region") => (Some(3), Some(5)),
            Some("mesh" | "file") => (None, Some(4)),
            _ if arguments.len() == 5 => (Some(2), Some(4)),
            _ => (None, None),
        }
    }

    fn particles_per_cell(&mut self, setting: &Setting) -> Result<(), Diagnostic> {
        let mut changed = false;
        for index in self.calls("solid") {
            let mut arguments = self.arguments(index).to_vec();
            let place = Self::places(&arguments).0;
            let Some(old) = place.and_then(|place| arguments.get_mut(place)) else { continue };
            old.text.clone_from(&setting.value);
            changed = true;
            self.replace(index, arguments, setting);
        }
        if changed {
            return Ok(());
        }
        let message =
            "the script has no `solid(ID, region, ...)` whose particles per cell could change";
        Err(missing(self.statements, self.source, message))
    }

    /// The variable that gives the cell size of the box, or else of the solids, if one does.
    fn cell_variable(&self) -> Option<String> {
        let boxes = self.calls("dimension").into_iter().filter_map(|index| {
            let arguments = self.arguments(index);
            arguments.last().filter(|_| arguments.len().is_multiple_of(2))
        });
        let solids = self.calls("solid").into_iter().filter_map(|index| {
            let arguments = self.arguments(index);
            arguments.get(Self::places(arguments).1?)
        });
        let first = boxes.chain(solids).next()?.text.trim().to_string();
        let assigns = |statement: &Statement| matches!(statement, Statement::Assign { name, .. } if name.text == first);
        self.statements.iter().any(assigns).then_some(first)
    }

    /// Changes the variable, so that what follows from the cell size follows on.
    fn cell_of_variable(
        &mut self,
        variable: &str,
        setting: &Setting,
        new: &dyn Fn(&str) -> String,
    ) -> Result<(), Diagnostic> {
        for index in 0..self.statements.len() {
            let Statement::Assign { name, value } = &mut self.statements[index] else { continue };
            if name.text != variable {
                continue;
            }
            if self.variables.iter().any(|(given, _)| given == variable) {
                let span = name.span;
                let message = format!("`-var {variable}` gives the cell size already");
                return Err(self.refused(setting, Some(span), &message));
            }
            value.text = new(value.text.trim());
            let statement = &self.statements[index];
            let (span, line) = (span_of(statement), line(statement));
            self.changes.push(Change { span, line, setting: setting.text() });
        }
        Ok(())
    }

    fn cell(&mut self, setting: &Setting) -> Result<(), Diagnostic> {
        let factor = setting.value.strip_prefix('x').filter(|rest| rest.parse::<f64>().is_ok());
        let new = |old: &str| match factor {
            Some(factor) => format!("({old})*{factor}"),
            None => setting.value.clone(),
        };
        if let Some(name) = self.cell_variable() {
            return self.cell_of_variable(&name, setting, &new);
        }
        let mut changed = false;
        for index in self.calls("dimension") {
            let mut arguments = self.arguments(index).to_vec();
            // d and two limits per axis: with the cell size the count is even.
            if arguments.len().is_multiple_of(2)
                && let Some(last) = arguments.last_mut()
            {
                last.text = new(&last.text);
                changed = true;
                self.replace(index, arguments, setting);
            }
        }
        for index in self.calls("solid") {
            let mut arguments = self.arguments(index).to_vec();
            let place = Self::places(&arguments).1;
            if let Some(old) = place.and_then(|place| arguments.get_mut(place)) {
                old.text = new(&old.text);
                changed = true;
                self.replace(index, arguments, setting);
            }
        }
        if changed {
            return Ok(());
        }
        let message = "the script has no `dimension(..., h)` and no `solid(..., h)` to change";
        Err(missing(self.statements, self.source, message))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::script::syntax;

    const SCRIPT: &str = "n = 4\nh = 1/n\nmethod(ulmpm, FLIP, linear, 0.99, thermo-mechanical)\n\
        dimension(2, 0, 1, 0, 1, h)\nsolid(a, region, r, 2, m, h)\ndump(d, all, particle, 1, f, x)\n\
        compute(Ek, kinetic_energy, all)\nlog_modify(custom, step)\nrun(4)\n";

    fn changed(settings: &[&str]) -> Result<Vec<String>, String> {
        let source = Source::new("in.mpm", SCRIPT);
        let (mut statements, _) = syntax::parse(&source);
        let settings: Vec<Setting> =
            settings.iter().map(|text| Setting::parse(text).unwrap()).collect();
        let changes =
            apply(&mut statements, &settings, &[], &source).map_err(|wrong| wrong.message)?;
        let held: Vec<String> = statements.iter().map(line).collect();
        assert!(changes.iter().all(|change| held.contains(&change.line)), "{changes:?} {held:?}");
        Ok(changes.into_iter().map(|change| change.line).collect())
    }

    #[test]
    fn words_of_the_method_change_together_with_what_hangs_on_them() {
        let cases = [
            ("shape=cubic-spline", "method(ulmpm, FLIP, cubic-spline, 0.99, thermo-mechanical)"),
            ("shape=R4", "method(ulcpdi, FLIP, linear, 0.99, thermo-mechanical, R4)"),
            ("method=tlmpm", "method(tlmpm, FLIP, linear, 0.99, thermo-mechanical)"),
            ("transfer=APIC", "method(ulmpm, APIC, linear, thermo-mechanical)"),
            ("transfer=AFLIP", "method(ulmpm, AFLIP, linear, 0.99, thermo-mechanical)"),
            ("transfer=FLIP:1", "method(ulmpm, FLIP, linear, 1, thermo-mechanical)"),
            (
                "transfer=FLIP:time-constant:0.1",
                "method(ulmpm, FLIP, linear, time-constant, 0.1, thermo-mechanical)",
            ),
            ("transfer=XPIC:3", "method(ulmpm, XPIC, 3, linear, thermo-mechanical)"),
            (
                "transfer=PIC:gradient-enhanced",
                "method(ulmpm, PIC, linear, thermo-mechanical, gradient-enhanced)",
            ),
            ("alpha=0.5", "method(ulmpm, FLIP, linear, 0.5, thermo-mechanical)"),
        ];
        for (setting, expected) in cases {
            assert_eq!(changed(&[setting]).unwrap(), [expected], "{setting}");
        }
        let both = changed(&["transfer=MLS", "shape=quadratic-spline"]).unwrap();
        assert_eq!(both, ["method(ulmpm, MLS, quadratic-spline, thermo-mechanical)"]);
        let back = changed(&["transfer=APIC", "transfer=FLIP", "shape=R4", "shape=gimp"]).unwrap();
        assert_eq!(back, ["method(ulmpm, FLIP, gimp, 1, thermo-mechanical)"]);
    }

    #[test]
    fn cells_particles_steps_and_schemes_change_where_they_stand_or_are_added() {
        let cell = changed(&["cell=x0.5"]).unwrap();
        assert_eq!(cell, ["h = (1/n)*0.5"]);
        let literal = SCRIPT.replace("1, h)", "1, 0.1)").replace("m, h)", "m, 0.1)");
        let source = Source::new("in.mpm", &literal);
        let (mut statements, _) = syntax::parse(&source);
        let twice = [Setting::parse("cell=0.2").unwrap()];
        let changes = apply(&mut statements, &twice, &[], &source).unwrap();
        let lines: Vec<&str> = changes.iter().map(|change| change.line.as_str()).collect();
        assert_eq!(lines, ["dimension(2, 0, 1, 0, 1, 0.2)", "solid(a, region, r, 2, m, 0.2)"]);
        let source = Source::new("in.mpm", SCRIPT);
        let (mut statements, _) = syntax::parse(&source);
        let given = [("h".to_string(), "0.3".to_string())];
        let refused = apply(&mut statements, &twice, &given, &source).unwrap_err();
        assert!(refused.message.contains("`-var h`"), "{}", refused.message);
        assert_eq!(changed(&["ppc=3"]).unwrap(), ["solid(a, region, r, 3, m, h)"]);
        assert_eq!(changed(&["scheme=usl"]).unwrap(), ["scheme(usl)"]);
        assert_eq!(changed(&["run=8"]).unwrap(), ["run(8)"]);
        assert!(changed(&["dumps=off"]).unwrap().is_empty());
        assert!(changed(&["run_time=8"]).unwrap_err().contains("does not run once"));
        assert!(changed(&["transfer=PIC", "alpha=1"]).unwrap_err().contains("no blend"));
        let fixed = changed(&["set_dt=0.1", "dt_factor=0.5"]).unwrap_err();
        assert!(fixed.contains("would change nothing"));
    }

    #[test]
    fn unknown_names_are_answered_with_similar_ones() {
        assert!(Setting::parse("shapes=linear").unwrap_err().contains("`shape`"));
        assert!(Setting::parse("shape").unwrap_err().contains("NAME=VALUE"));
        assert!(Setting::parse("shape=").unwrap_err().contains("no value"));
    }

    #[test]
    fn a_measure_stands_before_the_first_run_below_its_names() {
        let text = format!("{SCRIPT}tip = Ek*2\nrun(5)\n");
        let source = Source::new("in.mpm", &text);
        let lines = |expression: &str| {
            let (mut statements, _) = syntax::parse(&source);
            measure(&mut statements, expression, &source)
                .map(|_| statements.iter().map(line).collect::<Vec<_>>())
        };
        let early = lines("Ek + 1e3*sin(time)").unwrap();
        let place = early.iter().position(|line| line.starts_with("measured")).unwrap();
        assert_eq!(
            early[place..place + 3],
            [
                "measured = Ek + 1e3*sin(time)".to_string(),
                "log_modify(custom, time, measured)".to_string(),
                "run(4)".to_string(),
            ]
        );
        assert!(!early.contains(&"log_modify(custom, step)".to_string()));
        let late = lines("tip").unwrap();
        assert_eq!(late[late.len() - 2..], ["log_modify(custom, time, measured)", "run(5)"]);
    }
}
