//! Which runs a study consists of, and what their errors are.

use super::child::{Job, files_of};
use super::log::Taken;
use super::results::hash;
use super::{Against, Case, Request, State, Stop, Vary};
use crate::command::play::{self, Wishes};
use crate::command::setting::{Setting, is_setting};
use crate::script::diagnostic::{Diagnostic, Severity, render};
use crate::script::source::Source;
use crate::script::suggest;
use crate::script::syntax::{self, Statement};
use std::io::Read;
use std::path::Path;

/// So many runs are too many: a slip on the command line.
const MOST_CASES: usize = 10_000;

/// A study before and after its runs.
pub struct Plan {
    /// Names that vary.
    pub names: Vec<String>,
    /// The cases; the one of reference, if there is one, stands last.
    pub cases: Vec<Case>,
    /// Is the last case the reference?
    pub has_reference: bool,
    /// The statements of the script.
    pub statements: Vec<Statement>,
    /// The expression that is measured.
    pub measure: String,
    /// What it is compared with.
    pub against: Against,
    /// What all keys of results depend on.
    common: u64,
}

impl Plan {
    /// The key under which results of a case are kept.
    pub fn key(&self, index: usize, round: usize) -> u64 {
        let words = self.cases[index].job.words().join("\0");
        hash(&[&self.common.to_le_bytes(), words.as_bytes(), &round.to_le_bytes()])
    }
}

/// Plans the runs; combinations that the script refuses are known afterwards.
///
/// # Errors
/// The script, a name or a value is wrong, or nothing says what the error is.
pub fn make(request: &Request) -> Result<Plan, Stop> {
    let wrong = |message: String| Stop::Wrong(format!("error: {message}"));
    let shown = request.script.display().to_string();
    let unread =
        |reason: std::io::Error| Stop::Files(format!("error: cannot read `{shown}`: {reason}"));
    let script = std::path::absolute(&request.script).map_err(unread)?;
    if script.exists() && !script.is_file() {
        return Err(wrong(format!("`{shown}` is no file that many runs can read")));
    }
    let bytes = std::fs::read(&script).map_err(unread)?;
    let (source, _) = Source::from_bytes(shown, &bytes);
    let (statements, _) = syntax::parse(&source);
    let variables = variables_of(&statements);
    let (measure, against) = measure_of(request, &statements).map_err(wrong)?;
    let maker = Maker { request, source: &source, script: &script, measure: &measure, variables };
    let mut cases = Vec::new();
    for values in combinations(&request.vary).map_err(wrong)? {
        cases.push(maker.case(&values).map_err(wrong)?);
    }
    let has_reference = matches!(against, Against::Run(_));
    if let Against::Run(settings) = &against {
        let case = maker.reference(settings).map_err(wrong)?;
        if let State::Refused(reason) = &case.state {
            return Err(wrong(format!("the reference run is refused: {reason}")));
        }
        cases.push(case);
    }
    maker.stop_if_all_refused(&cases)?;
    let common = common(request, &bytes, &statements, &measure);
    let names = request.vary.iter().map(|vary| vary.name.clone()).collect();
    Ok(Plan { names, cases, has_reference, statements, measure, against, common })
}

/// Names that the script assigns.
fn variables_of(statements: &[Statement]) -> Vec<String> {
    let name = |statement: &Statement| match statement {
        Statement::Assign { name, .. } => Some(name.text.clone()),
        _ => None,
    };
    statements.iter().filter_map(name).collect()
}

/// IDs of the fixes of a script that compare with an exact solution.
fn solutions(statements: &[Statement]) -> Vec<&str> {
    statements.iter().filter_map(solution).collect()
}

/// The ID of a fix that compares with an exact solution.
fn solution(statement: &Statement) -> Option<&str> {
    let Statement::Call { name, arguments, .. } = statement else { return None };
    let compares = arguments.get(1).is_some_and(|style| style.text == "check_solution");
    let id = arguments.first().filter(|_| name.text == "fix" && compares);
    id.map(|id| id.text.as_str())
}

/// What is measured and what it is compared with.
fn measure_of(request: &Request, statements: &[Statement]) -> Result<(String, Against), String> {
    let solutions = solutions(statements);
    let measure = match (&request.error, solutions.as_slice()) {
        (Some(expression), _) => expression.trim().to_string(),
        (None, [id]) => format!("{id}_z"),
        (None, []) => {
            return Err("nothing says what the error is: the script has no `check_solution`; \
                        give --error EXPRESSION, and --exact VALUE if its value is known"
                .to_string());
        }
        (None, several) => {
            let all: Vec<String> = several.iter().map(|id| format!("--error {id}_z")).collect();
            return Err(format!("several fixes check the solution: choose {}", all.join(" or ")));
        }
    };
    let is_error = matches!(request.taken, Taken::Curve(_))
        || solutions
            .iter()
            .any(|id| measure.strip_prefix(id).is_some_and(|rest| rest == "_z" || rest == "_s"));
    let against = request.against.clone();
    let against = against.unwrap_or(if is_error { Against::Nothing } else { Against::Grids });
    if is_error && against == Against::Grids {
        return Err(format!("`{measure}` is an error already: it has no value at h = 0 but 0"));
    }
    Ok((measure, against))
}

/// All combinations, the last name fastest.
fn combinations(vary: &[Vary]) -> Result<Vec<Vec<String>>, String> {
    let count = vary.iter().map(|v| v.values.len() as f64).product::<f64>();
    if count > MOST_CASES as f64 {
        return Err(format!("{count} combinations are more than {MOST_CASES}"));
    }
    for (index, one) in vary.iter().enumerate() {
        if vary[..index].iter().any(|other| other.name == one.name) {
            return Err(format!("`{}` varies twice", one.name));
        }
    }
    let mut all = vec![Vec::new()];
    for one in vary {
        let longer = |start: &Vec<String>, value: &String| {
            start.iter().chain([value]).cloned().collect::<Vec<String>>()
        };
        all =
            all.iter().flat_map(|start| one.values.iter().map(move |v| longer(start, v))).collect();
    }
    Ok(all)
}

/// Makes cases of a script.
struct Maker<'a> {
    request: &'a Request,
    source: &'a Source,
    script: &'a Path,
    measure: &'a str,
    variables: Vec<String>,
}

impl Maker<'_> {
    fn case(&self, values: &[String]) -> Result<Case, String> {
        let names = self.request.vary.iter().map(|vary| vary.name.as_str());
        let chosen: Vec<(&str, &str)> = names.zip(values.iter().map(String::as_str)).collect();
        let job = self.job(&chosen)?;
        Ok(self.rehearsed(values.to_vec(), job))
    }

    fn reference(&self, settings: &[(String, String)]) -> Result<Case, String> {
        let chosen: Vec<(&str, &str)> =
            settings.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
        let job = self.job(&chosen)?;
        Ok(self.rehearsed(Vec::new(), job))
    }

    /// A variable of the script wins over a setting of the same name.
    fn job(&self, chosen: &[(&str, &str)]) -> Result<Job, String> {
        let request = self.request;
        let mut job = Job {
            script: self.script.to_path_buf(),
            variables: request.variables.clone(),
            settings: request.settings.clone(),
            threads: request.threads,
            measure: self.measure.to_string(),
        };
        for (name, value) in chosen {
            let pair = (name.to_string(), value.to_string());
            if self.variables.iter().any(|known| known == name) {
                job.variables.retain(|(known, _)| known != name);
                job.variables.push(pair);
            } else if is_setting(name) {
                job.settings.retain(|setting| setting.name != *name);
                job.settings.push(Setting { name: pair.0, value: pair.1 });
            } else if *name == "threads" {
                let count = value.parse::<usize>().ok().filter(|count| (1..=4096).contains(count));
                job.threads = count.ok_or_else(|| format!("`{value}` is no number of threads"))?;
            } else {
                let known = self.variables.iter().map(String::as_str);
                let settings = crate::command::setting::SETTINGS.iter().map(|(name, _)| *name);
                let known = known.chain(settings).chain(["threads"]);
                let otherwise = "neither a variable that the script assigns nor a setting \
                                 (`karamelo-rs study --help` lists those)";
                let help = suggest::help(name, known, "");
                let help = if help.is_empty() { String::new() } else { format!("; {help}") };
                return Err(format!("`{name}` is {otherwise}{help}"));
            }
        }
        Ok(job)
    }

    /// A case with what a rehearsal tells: cell size, warnings, why the script refuses it and where.
    fn rehearsed(&self, values: Vec<String>, job: Job) -> Case {
        let wishes = Wishes {
            variables: &job.variables,
            settings: &job.settings,
            measure: Some(&job.measure),
        };
        let (script, found) = play::rehearse_with(self.source.clone(), &wishes);
        let placed = |mistake: &Diagnostic| {
            let (line, column) = self.source.position(mistake.span.start);
            format!("{} (line {line}, column {column})", mistake.message)
        };
        let of = |severity: Severity| found.iter().filter(move |d| d.severity == severity);
        let state = match of(Severity::Error).next() {
            Some(mistake) => State::Refused(placed(mistake)),
            None => State::Waiting,
        };
        let warnings = of(Severity::Warning).map(placed).collect();
        Case { values, job, cell: script.cell.unwrap_or(f64::NAN), warnings, state }
    }

    /// If no combination can run, the first one shows what is wrong with the script.
    fn stop_if_all_refused(&self, cases: &[Case]) -> Result<(), Stop> {
        if cases.iter().any(|case| case.state == State::Waiting) {
            return Ok(());
        }
        let Some(first) = cases.first() else {
            return Err(Stop::Wrong("error: nothing to run".to_string()));
        };
        let job = &first.job;
        let wishes = Wishes {
            variables: &job.variables,
            settings: &job.settings,
            measure: Some(&job.measure),
        };
        let (script, mut found) = play::rehearse_with(self.source.clone(), &wishes);
        found.retain(|mistake| mistake.severity == Severity::Error);
        let mut text = render(&found, &script.source, false);
        text.push_str("error: the script refuses every combination; the first one as above");
        Err(Stop::Wrong(text))
    }
}

/// A checksum of this program, read in pieces: what a process holds when it starts another one counts
/// as memory of that one.
fn program() -> std::io::Result<u32> {
    let mut file = std::fs::File::open(std::env::current_exe()?)?;
    let mut piece = vec![0; 1 << 16];
    let mut sum = crc32fast::Hasher::new();
    loop {
        match file.read(&mut piece)? {
            0 => return Ok(sum.finalize()),
            count => sum.update(&piece[..count]),
        }
    }
}

/// What all results of a study depend on: program, script, files it reads, the number taken.
fn common(request: &Request, script: &[u8], statements: &[Statement], measure: &str) -> u64 {
    let folder = std::env::current_dir().unwrap_or_default();
    let beside = request.script.parent().unwrap_or(Path::new("")).to_path_buf();
    let mut read = Vec::new();
    for folder in [folder, beside] {
        for file in files_of(statements, &folder).0 {
            read.extend(std::fs::read(folder.join(file)).unwrap_or_default());
        }
    }
    let taken = format!("{:?}", request.taken);
    let version = env!("CARGO_PKG_VERSION").as_bytes();
    let program = program().unwrap_or_default().to_le_bytes();
    hash(&[version, &program, script, &read, measure.as_bytes(), taken.as_bytes()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn combinations_are_bounded_and_named_once() {
        let vary = |name: &str, count: usize| Vary {
            name: name.to_string(),
            values: (0..count).map(|value| value.to_string()).collect(),
        };
        let all = combinations(&[vary("a", 2), vary("b", 3)]).unwrap();
        assert_eq!(
            (all.len(), all[1].as_slice()),
            (6, ["0".to_string(), "1".to_string()].as_slice())
        );
        assert!(combinations(&[vary("a", 200), vary("b", 200)]).unwrap_err().contains("40000"));
        assert!(combinations(&[vary("a", 2), vary("a", 2)]).unwrap_err().contains("twice"));
        assert_eq!(combinations(&[]).unwrap().len(), 1);
    }
}
