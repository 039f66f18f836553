//! Ways to spoil the program on purpose, to show that `verify` notices (`--break NAME`).
//!
//! The program itself has no switch: the script that a problem runs is changed behind its back, so
//! that it is played as a program with a wrong law or transfer would play the right one.

use crate::command::setting::RUNS;
use crate::script::source::Source;
use crate::script::syntax::{self, Statement};

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Break {
    /// Laws are ten per cent too stiff and conduct ten per cent too much.
    Law,
    /// The transfer is PIC, whatever was asked for.
    Transfer,
    /// Body forces do nothing.
    Force,
    /// The grid loses momentum, a millionth in each unit of time.
    Grid,
}

impl Break {
    /// All of them with their names.
    pub const ALL: [(&'static str, Break); 4] = [
        ("law", Break::Law),
        ("transfer", Break::Transfer),
        ("force", Break::Force),
        ("grid", Break::Grid),
    ];

    /// Settings that win over those of a problem.
    pub fn settings(self) -> &'static [&'static str] {
        if self == Break::Transfer { &["transfer=PIC"] } else { &[] }
    }

    /// The script as a spoilt program would play it.
    pub fn spoil(self, text: &str) -> String {
        let source = Source::new("problem", text);
        let (statements, _) = syntax::parse(&source);
        let mut edits: Vec<(usize, usize, String)> = Vec::new();
        let mut runs = 0;
        for statement in &statements {
            let Statement::Call { name, arguments, span } = statement else { continue };
            let style = arguments.get(1).map_or("", |word| word.text.as_str());
            match (self, name.text.as_str()) {
                // ID, style, rho, E, nu, heat capacity, conductivity.
                (Break::Law, "material") if style != "rigid" => {
                    for place in [3, 6] {
                        let Some(old) = arguments.get(place) else { continue };
                        let new = format!("1.1*({})", old.text.trim());
                        edits.push((old.span.start, old.span.end, new));
                    }
                }
                (Break::Force, "fix") if style == "body_force" => {
                    edits.push((span.start, span.end, String::new()));
                }
                (Break::Grid, run) if RUNS.contains(&run) => {
                    if runs == 0 {
                        let fix = "fix(leak, damping_nodes, all, 1e-6)\n".to_string();
                        edits.push((span.start, span.start, fix));
                    }
                    runs += 1;
                }
                _ => {}
            }
        }
        let mut spoilt = source.text.clone();
        for (start, end, new) in edits.into_iter().rev() {
            spoilt.replace_range(start..end, &new);
        }
        spoilt
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCRIPT: &str =
        "material(m, linear, 1, E + 1, 0)\nfix(b, body_force, all, 1)\nrun(1)\nrun(2)\n";

    #[test]
    fn each_break_changes_what_it_names() {
        let spoilt = |spoil: Break| spoil.spoil(SCRIPT);
        assert_eq!(spoilt(Break::Law), SCRIPT.replace("E + 1", "1.1*(E + 1)"));
        assert_eq!(spoilt(Break::Force), SCRIPT.replace("fix(b, body_force, all, 1)", ""));
        assert_eq!(spoilt(Break::Transfer), SCRIPT);
        let leak = "fix(leak, damping_nodes, all, 1e-6)\nrun(1)";
        assert_eq!(spoilt(Break::Grid), SCRIPT.replace("run(1)", leak));
    }
}
