//! The registry without magic: every family of styles is one `const` table of rows.
//!
//! A row drives look-up, "did you mean", `karamelo-rs styles`, the manual and the tests of the
//! table itself.

use crate::script::arguments::Name;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::suggest;

/// One style of a family; `B` is the family's build function.
pub struct Style<B: 'static> {
    /// The word in the script, letter for letter.
    pub name: &'static str,
    /// Arguments after the style word, as the manual prints them.
    pub usage: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// Manual text: equation as coded, units, source.
    pub manual: &'static str,
    /// Builds the style from its arguments, or `None`: a reserved name, not available yet.
    pub build: Option<B>,
}

/// Finds the style a script names.
///
/// # Errors
/// An unknown word (with the nearest known one), or a reserved name that is not available yet.
pub fn find<B: Copy>(
    family: &str,
    table: &'static [Style<B>],
    word: &Name,
) -> Result<(&'static Style<B>, B), Diagnostic> {
    match table.iter().find(|style| style.name == word.text) {
        Some(style) => match style.build {
            Some(build) => Ok((style, build)),
            None => Err(Diagnostic::error(
                Code::NotAvailable,
                word.span,
                format!("{family} style `{}` is known, but not available yet", word.text),
            )
            .label("not available yet")),
        },
        None => {
            let names = table.iter().map(|style| style.name);
            Err(Diagnostic::error(
                Code::UnknownStyle,
                word.span,
                format!("unknown {family} style `{}`", word.text),
            )
            .label(format!("not a {family} style"))
            .help(suggest::help(
                &word.text,
                names,
                &format!("`karamelo-rs styles {family}` lists all"),
            )))
        }
    }
}
