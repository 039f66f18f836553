//! `--measure`: an expression as a column of the log.

use super::{Change, MEASURED, argument, is_run, line, missing, span_of};
use crate::script::arguments::Name;
use crate::script::diagnostic::Diagnostic;
use crate::script::source::Source;
use crate::script::syntax::Statement;
use crate::script::token;

/// Makes the log hold nothing but the time and an expression: `measured = EXPRESSION` and a
/// `log_modify` before the first run below all names in it.
///
/// # Errors
/// No run stands below them.
pub fn measure(
    statements: &mut Vec<Statement>,
    expression: &str,
    source: &Source,
) -> Result<Vec<Change>, Diagnostic> {
    let is_log = |name: &Name| name.text == "log_modify";
    statements
        .retain(|statement| !matches!(statement, Statement::Call { name, .. } if is_log(name)));
    let names = identifiers(expression);
    // The last of the first declarations: what a name means later is what the run sees.
    let first = |word: &str| statements.iter().position(|statement| declares(statement, word));
    let below = names.iter().filter_map(|word| first(word)).max().map_or(0, |last| last + 1);
    let run = (below..statements.len()).find(|index| is_run(&statements[*index]));
    let Some(run) = run else {
        return Err(missing(statements, source, "the script has no run to measure in"));
    };
    let span = span_of(&statements[run]);
    let name = Name { text: MEASURED.to_string(), span };
    let words = ["custom", "time", MEASURED];
    let assignment = Statement::Assign { name, value: argument(expression, span) };
    let arguments = words.iter().map(|word| argument(word, span)).collect();
    let log =
        Statement::Call { name: Name { text: "log_modify".to_string(), span }, arguments, span };
    let setting = format!("measure {expression}");
    let changes = [&assignment, &log]
        .map(|added| Change { span, line: line(added), setting: setting.clone() })
        .to_vec();
    statements.splice(run..run, [assignment, log]);
    Ok(changes)
}

/// Does a statement give a name its meaning: a variable, or a result of the fix or compute?
fn declares(statement: &Statement, word: &str) -> bool {
    match statement {
        Statement::Assign { name, .. } => name.text == word,
        Statement::Call { arguments, .. } => arguments.first().is_some_and(|id| {
            let rest = word.strip_prefix(id.text.as_str());
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('_'))
        }),
        Statement::Quit { .. } => false,
    }
}

/// Names in an expression.
fn identifiers(expression: &str) -> Vec<&str> {
    let mut rest = expression;
    let mut names = Vec::new();
    while let Some(first) = rest.chars().next() {
        let length = token::identifier(rest);
        if length > 0 {
            names.push(&rest[..length]);
        }
        // A number such as 1e3 holds no name.
        let number = |c: char| c.is_ascii_alphanumeric() || c == '.' || c == '_';
        let skipped = match length {
            0 if first.is_ascii_digit() => rest.find(|c| !number(c)).unwrap_or(rest.len()),
            0 => first.len_utf8(),
            _ => length,
        };
        rest = &rest[skipped..];
    }
    names
}
