//! `karamelo-rs styles --markdown FOLDER`: the reference of the manual, written from the tables.
//!
//! The files stand in `docs/src/reference`, so that they can be read and linked where the
//! repository is browsed; `tests/manual.rs` fails while they are not what the tables say.

use super::arguments;
use super::styles::{Entry, FAMILIES, family, written};
use crate::error;
use crate::output::file;
use crate::script::diagnostic::Code;
use crate::script::function::FUNCTIONS;
use std::fmt::Write;
use std::path::Path;

const MARK: &str = "<!-- Written by `karamelo-rs styles --markdown docs/src/reference` from the tables \
in src: change those. -->\n\n";

/// Title and first paragraph of the page of a family.
fn heading(family: &str) -> [&'static str; 2] {
    match family {
        "command" => {
            ["Commands", "What a script may call. [The script language](../language.md) says how."]
        }
        "method" => [
            "Methods",
            "The first word of [`method`](command.md#method): where the weights of a particle belong to.",
        ],
        "transfer" => [
            "Transfers",
            "The second word of [`method`](command.md#method): how velocities pass between particles and grid.",
        ],
        "shape" => ["Shape functions", "The third word of [`method`](command.md#method)."],
        "domain" => [
            "Particle domains",
            "The last word of [`method`](command.md#method) for `ulcpdi` and `tlcpdi`: what a particle is.",
        ],
        "scheme" => ["Schemes", "The order of the parts of a step: [`scheme`](command.md#scheme)."],
        "region" => {
            ["Regions", "Sets of points: [`region`](command.md#region). Limits are inclusive."]
        }
        "material" => ["Materials", "Laws of bodies: [`material`](command.md#material)."],
        "eos" => [
            "Equations of state",
            "The pressure of an [`eos-strength`](material.md#eos-strength) material.",
        ],
        "strength" => [
            "Strength laws",
            "The deviatoric stress of an [`eos-strength`](material.md#eos-strength) material.",
        ],
        "damage" => {
            ["Damage laws", "Failure of an [`eos-strength`](material.md#eos-strength) material."]
        }
        "temperature" => {
            ["Temperature laws", "Heat of an [`eos-strength`](material.md#eos-strength) material."]
        }
        "fix" => [
            "Fixes",
            "What acts in every step: [`fix`](command.md#fix). H1 to H7 are the places in a step where \
             fixes act: see [the step](../methods/step.md#hooks).",
        ],
        "compute" => [
            "Computes",
            "Numbers about particles, computed when something reads them: [`compute`](command.md#compute).",
        ],
        _ => [
            "Dumps",
            "Series of files: [`dump`](command.md#dump). [File formats](../formats.md) shows them.",
        ],
    }
}

/// Every page: its name and its text.
pub fn pages() -> Vec<(String, String)> {
    let mut pages = vec![("index.md".to_string(), contents())];
    let families = FAMILIES.into_iter().filter_map(|name| Some((name, family(name)?)));
    pages.extend(families.map(|(name, styles)| (format!("{name}.md"), page(name, &styles))));
    pages.push(("function.md".to_string(), functions()));
    pages.push(("code.md".to_string(), codes()));
    pages.push(("command-line.md".to_string(), command_line()));
    pages
}

/// Writes all pages into a folder.
///
/// # Errors
/// A file that cannot be written, in words.
pub fn write(folder: &Path) -> Result<String, String> {
    std::fs::create_dir_all(folder)
        .map_err(|reason| format!("cannot make `{}`: {reason}", folder.display()))?;
    let pages = pages();
    for (name, text) in &pages {
        file::write_whole(&folder.join(name), text.as_bytes())
            .map_err(|fault| fault.to_string())?;
    }
    Ok(format!("wrote {} pages into {}\n", pages.len(), folder.display()))
}

fn contents() -> String {
    let mut text = format!(
        "{MARK}# Reference\n\nEvery style, written from the tables of the program. `karamelo-rs styles FAMILY \
         NAME` prints the same entry in the shell.\n\n"
    );
    for name in FAMILIES {
        let [title, _] = heading(name);
        let styles = family(name).unwrap_or_default();
        let links = styles.iter().filter(|style| style.available);
        let links: Vec<String> = links
            .map(|style| format!("[`{0}`]({name}.md#{1})", style.name, anchor(style.name)))
            .collect();
        let _ = writeln!(text, "* [{title}]({name}.md): {}", links.join(", "));
    }
    text.push_str(
        "* [Operators and functions](function.md)\n* [Codes of mistakes](code.md)\n\
         * [Command line](command-line.md)\n",
    );
    text
}

/// The page of a family: a table of all its styles, then an entry for each.
fn page(name: &str, styles: &[Entry]) -> String {
    let [title, first] = heading(name);
    let mut text = format!("{MARK}# {title}\n\n{first}\n\n| style | |\n| --- | --- |\n");
    for style in styles.iter().filter(|style| style.available) {
        let (word, summary) = (style.name, escaped(style.summary));
        let _ = writeln!(text, "| [`{word}`](#{}) | {summary} |", anchor(word));
    }
    for style in styles.iter().filter(|style| style.available) {
        let _ = write!(
            text,
            "\n## `{}`\n\n```text\n{}\n```\n\n{}\n",
            style.name,
            written(name, style),
            sentence(style.summary)
        );
        if !style.manual.is_empty() {
            let _ = write!(text, "\n```text\n{}\n```\n", style.manual);
        }
    }
    let later: Vec<String> = styles
        .iter()
        .filter(|style| !style.available)
        .map(|style| format!("`{}` ({})", style.name, escaped(style.summary)))
        .collect();
    if !later.is_empty() {
        let _ =
            write!(text, "\nReserved for later, and refused until then: {}.\n", later.join(", "));
    }
    text
}

fn functions() -> String {
    let mut text = format!(
        "{MARK}# Operators and functions\n\n\
         From the tightest to the loosest: `f(...)` and `( )`; `^` or `**` (right-associative); the signs `-`, \
         `+`, `!`; `*` `/`; `+` `-`; `<` `<=` `>` `>=`; `==` `!=`; `&&`; `||`. Comparisons and logic give 0 or \
         1. `PI` is the only constant.\n\n"
    );
    let calls: Vec<String> = FUNCTIONS.iter().map(|one| format!("`{}`", one.usage)).collect();
    let _ = write!(
        text,
        "{}\n\n\
         `log` and `ln` are the natural logarithm, `mod(a, b)` is a - b floor(a/b), `remainder` that of IEEE \
         754, `inv_norm(p)` the quantile of the standard normal law; of `if` only the chosen branch is \
         evaluated; `value` and `evaluate` freeze the number of now. The functions of a group are sums over \
         it: `xcm` the mean place by mass, the forces those of the last step on the nodes of the group.\n",
        calls.join(", ")
    );
    text
}

fn codes() -> String {
    let mut text = format!(
        "{MARK}# Codes of mistakes\n\nErrors stop everything before it begins; warnings (W) and notes (N) do not. \
         `karamelo-rs explain E0203` prints one of these.\n"
    );
    for code in Code::ALL {
        let number = code.number();
        let explained = error::explain(number).unwrap_or_default();
        let body = explained.split_once("\n\n").map_or("", |(_, body)| body.trim_end());
        let _ = write!(text, "\n## {number}\n\n{}\n\n```text\n{body}\n```\n", code.meaning());
    }
    text
}

fn command_line() -> String {
    let mut text = format!(
        "{MARK}# Command line\n\nExit codes: 0 done; 1 the run went wrong; 2 the script or the command line is \
         wrong; 3 the file system is wrong; 130 and 143 stopped by SIGINT and SIGTERM.\n"
    );
    for (name, help) in arguments::help() {
        let _ = write!(text, "\n## `{name}`\n\n```text\n{}\n```\n", help.trim_end());
    }
    text
}

/// The anchor of a heading that is one word in code.
fn anchor(word: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, '-' | '_');
    word.to_lowercase().chars().filter(kept).collect()
}

/// A summary as a sentence of its own.
fn sentence(summary: &str) -> String {
    let mut rest = summary.chars();
    let text: String =
        rest.next().map(|first| first.to_uppercase().chain(rest).collect()).unwrap_or_default();
    let code_first = summary.starts_with('`');
    let stop = if summary.ends_with('.') { "" } else { "." };
    format!("{}{stop}", escaped(if code_first { summary } else { &text }))
}

/// Keeps Markdown from reading more into a text than is there; what stands between backticks stays.
fn escaped(text: &str) -> String {
    let mut code = false;
    let mut out = String::new();
    for c in text.chars() {
        code ^= c == '`';
        if c == '|' || !code && matches!(c, '*' | '_' | '<' | '>' | '[' | ']' | '\\') {
            out.push('\\');
        }
        out.push(c);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_family_has_a_page_and_every_style_an_entry_on_it() {
        let pages = pages();
        for name in FAMILIES {
            let (_, text) = pages.iter().find(|(page, _)| *page == format!("{name}.md")).unwrap();
            for style in family(name).unwrap() {
                assert!(text.contains(&format!("`{}`", style.name)), "{}", style.name);
            }
        }
    }

    #[test]
    fn markdown_reads_no_more_than_is_there() {
        assert_eq!(escaped("a*b < c `d*e` [L]"), "a\\*b \\< c `d*e` \\[L\\]");
        assert_eq!(anchor("contact/hertz"), "contacthertz");
        assert_eq!(sentence("old form of x"), "Old form of x.");
    }
}
