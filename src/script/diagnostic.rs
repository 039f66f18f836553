//! Mistakes in a script: code, place, words, help.

use super::source::{Source, Span};
use annotate_snippets::renderer::DecorStyle;
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

/// More diagnostics than this are counted, not shown.
const SHOWN_AT_MOST: usize = 200;

macro_rules! codes {
    ($($name:ident $number:literal $meaning:literal,)*) => {
        /// Kinds of mistakes; `karamelo-rs explain E0203` explains one.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Code { $(#[doc = $meaning] $name,)* }

        impl Code {
            /// Every code, in the order of the numbers.
            pub const ALL: &'static [Code] = &[$(Code::$name,)*];

            /// The stable number: `E0203`.
            pub fn number(self) -> &'static str {
                match self { $(Code::$name => $number,)* }
            }

            /// One line: what the code stands for.
            pub fn meaning(self) -> &'static str {
                match self { $(Code::$name => $meaning,)* }
            }
        }
    };
}

codes! {
    Encoding "E0101" "The script is not UTF-8 text.",
    BadStatement "E0102" "A line is no assignment, no command call and not `quit`.",
    BadName "E0103" "A name left of `=` is no variable name.",
    MissingParenthesis "E0104" "A parenthesis is not closed.",
    EmptyArgument "E0105" "Nothing stands between two commas or parentheses.",
    TrailingComma "E0106" "A comma stands before the closing parenthesis.",
    TextAfterCall "E0107" "Something follows the closing parenthesis of a statement.",
    OpenQuote "E0108" "A double quote is not closed on its line.",
    BrokenQuote "E0109" "A word is quoted only in part.",
    MissingExpression "E0110" "An expression or operand is missing.",
    MissingOperator "E0111" "Two operands follow each other without an operator.",
    ComparisonChain "E0112" "Comparisons are chained.",
    BadNumber "E0113" "A number is malformed.",
    UnexpectedText "E0114" "A character or operator cannot stand here.",
    TooDeep "E0115" "An expression is nested too deeply or becomes too long.",
    NotAvailable "E0201" "A reserved word is known, but not available yet.",
    UnknownCommand "E0202" "A command does not exist.",
    UnknownStyle "E0203" "A style does not exist in its family.",
    UnknownName "E0204" "A variable, function, result or ID does not exist.",
    Arity "E0205" "Arguments are missing.",
    Unread "E0206" "There is an argument too many.",
    Type "E0207" "An argument is of the wrong kind.",
    Range "E0208" "A number lies outside its range.",
    NotFinite "E0209" "A number is infinite or not a number.",
    NotPlace "E0210" "A formula of place stands where there is no point.",
    Protected "E0211" "A protected or read-only name is assigned.",
    UnknownField "E0212" "A dump or log has no such column.",
    NotCombined "E0213" "Options that do not go together.",
    Constant "E0214" "A condition or number never changes.",
    DimensionMismatch "E0215" "Numbers or styles do not fit the dimension of the problem.",
    Order "E0301" "A command stands too early or too late.",
    Duplicate "E0302" "An ID is used twice.",
    GroupKind "E0303" "A group is of the wrong kind.",
    Missing "E0304" "A run lacks something it needs.",
    NothingLeft "E0305" "A command leaves or makes no particles.",
    TooLarge "E0306" "The scene needs more memory than there is.",
    BadFile "E0307" "A file of a region or solid is malformed.",
    FileSystem "E0401" "A file or directory cannot be used.",
    RunFailed "E0402" "The run stopped itself.",
    Compatibility "W0101" "An old form is accepted; the modern one is shown.",
    ProtectedConstant "W0102" "`x0`, `y0` or `z0` is used as a variable.",
    EmptyGroup "W0201" "A group has no members.",
    Overlap "W0202" "Two solids overlap.",
    CutByBox "W0203" "A solid is cut by the box.",
    SurplusComponent "W0204" "A component beyond the dimension is ignored.",
    UnstableStep "W0205" "The time step is above the stable one.",
    NoEffect "W0206" "A command or value has no effect.",
    OddFile "W0207" "A file of a solid holds something unusual.",
    NotPhysical "W0208" "A material breaks a law of physics.",
    CommandLine "N0101" "A variable of the command line wins.",
    OldReference "N0102" "The current position is read where the reference position may be meant.",
}

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Nothing runs.
    Error,
    /// The run goes on.
    Warning,
    /// Good to know.
    Note,
}

/// One mistake or remark.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// What kind of mistake.
    pub code: Code,
    /// The culprit.
    pub span: Span,
    /// What is wrong, in one sentence.
    pub message: String,
    /// A few words under the culprit.
    pub label: String,
    /// What to do, one line each.
    pub help: Vec<String>,
}

impl Diagnostic {
    fn new(severity: Severity, code: Code, span: Span, message: String) -> Self {
        Self { severity, code, span, message, label: String::new(), help: Vec::new() }
    }

    /// A mistake: nothing runs.
    pub fn error(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, span, message.into())
    }

    /// A remark the run does not stop for.
    pub fn warning(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, span, message.into())
    }

    /// Something good to know.
    pub fn note(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self::new(Severity::Note, code, span, message.into())
    }

    /// A mistake in a file that the script names: `ring.msh:12: ...`, shown at its name.
    pub fn in_file(file: &str, line: Option<usize>, span: Span, what: &str) -> Self {
        let line = line.map_or(String::new(), |line| format!(":{line}"));
        Self::error(Code::BadFile, span, format!("{file}{line}: {what}"))
            .label("this file cannot be used")
    }

    /// The same with a few words under the culprit.
    pub fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    /// The same with a help line more; an empty one is left out.
    pub fn help(mut self, help: impl Into<String>) -> Self {
        let help = help.into();
        if !help.is_empty() {
            self.help.push(help);
        }
        self
    }
}

/// All of them in the order of their places, each mistake once.
///
/// A mistake of form is found when the text is split and again when the argument is read: the same
/// code at the same place is the same mistake.
pub fn ordered(list: &[Diagnostic]) -> Vec<&Diagnostic> {
    let mut ordered: Vec<&Diagnostic> = list.iter().collect();
    let key = |diagnostic: &&Diagnostic| {
        (diagnostic.span.start, diagnostic.code.number(), diagnostic.message.clone())
    };
    ordered.sort_by_cached_key(key);
    ordered.dedup_by_key(|diagnostic| key(&*diagnostic));
    ordered
}

/// All of them as text for the terminal: `error[E0203]: ...` with file:line:column and caret.
pub fn render(list: &[Diagnostic], source: &Source, color: bool) -> String {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    let renderer = renderer.decor_style(DecorStyle::Ascii);
    let ordered = ordered(list);
    let mut text = String::new();
    for diagnostic in ordered.iter().take(SHOWN_AT_MOST) {
        text.push_str(&render_one(&renderer, diagnostic, source));
        text.push_str("\n\n");
    }
    if ordered.len() > SHOWN_AT_MOST {
        text.push_str(&format!("... and {} more\n\n", ordered.len() - SHOWN_AT_MOST));
    }
    text
}

fn render_one(renderer: &Renderer, diagnostic: &Diagnostic, source: &Source) -> String {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
        Severity::Note => Level::NOTE,
    };
    let start = source.boundary(diagnostic.span.start);
    let line = source.line_span(start);
    let start = start.min(line.end);
    let end = source.boundary(diagnostic.span.end).clamp(start, line.end);
    let label = Some(diagnostic.label.as_str()).filter(|label| !label.is_empty());
    let culprit = AnnotationKind::Primary.span(start - line.start..end - line.start).label(label);
    let snippet = Snippet::source(&source.text[line.start..line.end])
        .line_start(source.position(line.start).0)
        .path(source.name.as_str())
        .annotation(culprit);
    let title = level.primary_title(diagnostic.message.as_str()).id(diagnostic.code.number());
    let helps = diagnostic.help.iter().map(|help| Level::HELP.message(help.as_str()));
    let rendered = renderer.render(&[title.element(snippet).elements(helps)]);
    without_spacer(&rendered)
}

/// Drops the empty `|` line that the renderer puts between the culprit and the help.
fn without_spacer(rendered: &str) -> String {
    let lines: Vec<&str> = rendered.lines().collect();
    let bare: Vec<String> =
        lines.iter().map(|line| without_escapes(line).trim().to_string()).collect();
    let kept = (0..lines.len()).filter(|index| {
        let help_follows = bare.get(index + 1).is_some_and(|next| next.starts_with("= "));
        bare[*index] != "|" || !help_follows
    });
    kept.map(|index| lines[index]).collect::<Vec<_>>().join("\n")
}

/// The text without the escapes that color it.
fn without_escapes(line: &str) -> String {
    let mut pieces = line.split("\u{1b}[");
    let mut text = pieces.next().unwrap_or_default().to_string();
    for piece in pieces {
        text.push_str(piece.split_once('m').map_or(piece, |(_, after)| after));
    }
    text
}

/// Counts in words: "3 errors, 1 warning"; empty if there is nothing.
pub fn summary(list: &[Diagnostic]) -> String {
    let ordered = ordered(list);
    [(Severity::Error, "error"), (Severity::Warning, "warning"), (Severity::Note, "note")]
        .into_iter()
        .filter_map(|(severity, word)| {
            match ordered.iter().filter(|diagnostic| diagnostic.severity == severity).count() {
                0 => None,
                1 => Some(format!("1 {word}")),
                count => Some(format!("{count} {word}s")),
            }
        })
        .collect::<Vec<_>>()
        .join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn disks() -> (Source, Diagnostic) {
        let text = "\n".repeat(22) + "material(mat1, neohookean, rho, E, nu)\n";
        let source = Source::new("inputs/two-disks.mpm", &text);
        let start = text.find("neohookean").expect("in the text");
        let diagnostic = Diagnostic::error(
            Code::UnknownStyle,
            Span::new(start, start + 10),
            "unknown material style `neohookean`",
        )
        .label("not a material style")
        .help("did you mean `neo-hookean`? `karamelo-rs styles material` lists all");
        (source, diagnostic)
    }

    #[test]
    fn text_looks_as_designed() {
        let (source, diagnostic) = disks();
        let expected = "\
error[E0203]: unknown material style `neohookean`
  --> inputs/two-disks.mpm:23:16
   |
23 | material(mat1, neohookean, rho, E, nu)
   |                ^^^^^^^^^^ not a material style
   = help: did you mean `neo-hookean`? `karamelo-rs styles material` lists all

";
        assert_eq!(render(&[diagnostic], &source, false), expected);
    }

    #[test]
    fn color_adds_only_escapes() {
        let (source, diagnostic) = disks();
        let colored = render(std::slice::from_ref(&diagnostic), &source, true);
        assert!(colored.contains("\u{1b}["));
        let plain: Vec<String> = colored.lines().map(without_escapes).collect();
        let plain = plain.join("\n") + "\n";
        assert_eq!(plain, render(&[diagnostic], &source, false));
    }

    #[test]
    fn order_of_places_and_each_once() {
        let source = Source::new("a", "é\tb\nc");
        let at = |start, end| Diagnostic::error(Code::Type, Span::new(start, end), "wrong");
        let list =
            [at(5, 6), at(3, 4), at(5, 6), Diagnostic::note(Code::NoEffect, Span::new(5, 6), "n")];
        let text = render(&list, &source, false);
        let places: Vec<&str> = text.lines().filter(|line| line.contains("-->")).collect();
        assert_eq!(places, [" --> a:1:3", " --> a:2:1", " --> a:2:1"]);
        assert_eq!(summary(&list), "2 errors, 1 note");
        assert_eq!(summary(&[]), "");
    }

    #[test]
    fn places_outside_the_text_are_moved_into_it() {
        for text in ["", "é", "a\nb\n", "\r\n"] {
            let source = Source::new("a", text);
            for start in 0..6 {
                for end in 0..8 {
                    let list = [Diagnostic::warning(Code::Type, Span::new(start, end), "wrong")];
                    assert!(render(&list, &source, false).starts_with("warning[E0207]: wrong"));
                }
            }
        }
    }

    #[test]
    fn numbers_are_unique_and_rise_within_their_kind() {
        for pair in Code::ALL.windows(2) {
            let (first, second) = (pair[0].number(), pair[1].number());
            assert!(first != second && (first[..1] != second[..1] || first < second));
            assert!(pair[0].meaning().ends_with('.'));
        }
    }

    #[test]
    fn endless_lists_are_cut() {
        let source = Source::new("a", &"x".repeat(300));
        let list: Vec<_> =
            (0..300).map(|n| Diagnostic::error(Code::Type, Span::new(n, n + 1), "wrong")).collect();
        assert!(render(&list, &source, false).ends_with("... and 100 more\n\n"));
    }
}
