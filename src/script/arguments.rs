//! The only reader of arguments: typed, ranged, tracked.

use super::compile::no_point;
use super::diagnostic::{Code, Diagnostic};
use super::formula::Formula;
use super::scope::{Measure, Scope, current};
use super::source::Span;
use super::suggest;
use super::syntax::Argument;
use super::text;

/// A count is a number so close to a whole one.
const WHOLE: f64 = 1e-6;

/// Above this, neighbouring f64 are not neighbouring whole numbers.
const LARGEST_COUNT: f64 = 9_007_199_254_740_992.0;

/// A word of the script and where it stands.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Name {
    /// Without quotes.
    pub text: String,
    /// Where it stands.
    pub span: Span,
}

/// A number and where it stands.
#[derive(Clone, Copy, Debug)]
pub struct Number {
    /// NaN while it is unknown.
    pub value: f64,
    /// False in the rehearsal if the number depends on a run; then every range test passes.
    pub known: bool,
    /// Where it stands.
    pub span: Span,
}

/// Whether a formula may read x..z0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// There is no point.
    Nowhere,
    /// It is evaluated at points.
    Point,
}

/// The arguments of one call, read from left to right.
pub struct Args<'a> {
    /// The command's word.
    pub command: &'a Name,
    /// The whole call.
    pub span: Span,
    /// The names known so far.
    pub scope: &'a mut Scope,
    /// Warnings and notes the reading gave.
    pub remarks: Vec<Diagnostic>,
    list: &'a [Argument],
    next: usize,
    usage: Option<String>,
    measure: Option<&'a mut dyn Measure>,
}

impl<'a> Args<'a> {
    /// The arguments of a call; without a measure this is the rehearsal.
    pub fn new(
        command: &'a Name,
        span: Span,
        list: &'a [Argument],
        scope: &'a mut Scope,
        measure: Option<&'a mut dyn Measure>,
    ) -> Self {
        Self { command, span, scope, remarks: Vec::new(), list, next: 0, usage: None, measure }
    }

    /// In the rehearsal, numbers that depend on a run are unknown.
    pub fn rehearsal(&self) -> bool {
        self.measure.is_none()
    }

    /// Arguments not yet read.
    pub fn remaining(&self) -> usize {
        self.list.len() - self.next
    }

    /// Usage line shown with arity errors: set it once the style is known.
    pub fn expect_usage(&mut self, usage: &str) {
        self.usage = Some(usage.to_string());
    }

    /// Span of the next argument, or of the closing parenthesis.
    pub fn next_span(&self) -> Span {
        let closing =
            Span::new(self.span.end.saturating_sub(1).max(self.span.start), self.span.end);
        self.list.get(self.next).map_or(closing, |argument| argument.span)
    }

    /// The next argument's text without reading it.
    pub fn peek(&self) -> Option<&str> {
        self.peek_at(0)
    }

    /// The argument `ahead` places after the next one, without reading it.
    pub fn peek_at(&self, ahead: usize) -> Option<&str> {
        self.list.get(self.next + ahead).map(|argument| argument.text.as_str())
    }

    /// Is the next argument text in double quotes?
    pub fn peek_quoted(&self) -> bool {
        self.list.get(self.next).is_some_and(|argument| argument.quoted)
    }

    /// Warns of an old form, with the modern line.
    pub fn old_form(&mut self, modern: &str) {
        let message = format!("an old form of `{}`", self.command.text);
        self.remarks.push(
            Diagnostic::warning(Code::Compatibility, self.span, message)
                .label("accepted")
                .help(format!("the modern line is `{modern}`")),
        );
    }

    fn with_usage(&self, error: Diagnostic) -> Diagnostic {
        match &self.usage {
            Some(usage) => error.help(format!("usage: {usage}")),
            None => error,
        }
    }

    fn take(&mut self, what: &str) -> Result<&'a Argument, Diagnostic> {
        let Some(argument) = self.list.get(self.next) else {
            let message = format!("`{}` needs {what} here", self.command.text);
            let error = Diagnostic::error(Code::Arity, self.next_span(), message);
            return Err(self.with_usage(error.label(format!("expected {what}"))));
        };
        self.next += 1;
        if argument.text.is_empty() {
            return Err(empty_argument(argument.span).label(format!("expected {what}")));
        }
        Ok(argument)
    }

    /// Reads a word. `what` says what is expected, for messages: "a region ID".
    ///
    /// # Errors
    /// No argument left, or one that is no single word.
    pub fn word(&mut self, what: &str) -> Result<Name, Diagnostic> {
        let argument = self.take(what)?;
        if !argument.quoted && super::token::word(&argument.text) != argument.text.len() {
            let message = format!("expected {what}, found `{}`", shortened(&argument.text));
            return Err(Diagnostic::error(Code::Type, argument.span, message)
                .label("not one word")
                .help("a word with blanks, commas or parentheses is put in double quotes"));
        }
        Ok(Name { text: argument.text.clone(), span: argument.span })
    }

    /// Reads the word if the next argument is exactly it.
    pub fn keyword(&mut self, word: &str) -> bool {
        let found = self.peek() == Some(word);
        self.next += usize::from(found);
        found
    }

    /// Reads one of the given words, with "did you mean"; gives its index.
    ///
    /// # Errors
    /// Any other word.
    pub fn choice(&mut self, what: &str, words: &[&str]) -> Result<usize, Diagnostic> {
        let name = self.word(what)?;
        words.iter().position(|word| *word == name.text).ok_or_else(|| {
            let all = words.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", ");
            Diagnostic::error(
                Code::Type,
                name.span,
                format!("expected {what}, found `{}`", name.text),
            )
            .label(format!("not {what}"))
            .help(suggest::help(
                &name.text,
                words.iter().copied(),
                &format!("one of {all}"),
            ))
        })
    }

    /// Reads a number (an expression that is a finite constant now).
    ///
    /// # Errors
    /// Mistakes in the expression, a formula of place, a number that is not finite.
    pub fn number(&mut self, what: &str) -> Result<Number, Diagnostic> {
        let formula = self.formula(what, Place::Nowhere)?;
        let span = self.list[self.next - 1].span;
        match self.current(&formula) {
            Some(value) if value.is_finite() => Ok(Number { value, known: true, span }),
            Some(value) => Err(not_finite(what, value, span)),
            None => Ok(Number { value: f64::NAN, known: false, span }),
        }
    }

    /// Reads a number > 0.
    ///
    /// # Errors
    /// As [`Args::number`]; a number that is not above zero.
    pub fn positive(&mut self, what: &str) -> Result<Number, Diagnostic> {
        let number = self.number(what)?;
        if number.known && number.value <= 0.0 {
            return Err(self.out_of_range(&number, &format!("{what} must be greater than 0")));
        }
        Ok(number)
    }

    /// Reads a number with lower <= value <= upper.
    ///
    /// # Errors
    /// As [`Args::number`]; a number outside.
    pub fn within(&mut self, what: &str, lower: f64, upper: f64) -> Result<Number, Diagnostic> {
        let number = self.number(what)?;
        if number.known && !(lower..=upper).contains(&number.value) {
            let (low, high) = (text::number(lower), text::number(upper));
            let message = match (lower.is_finite(), upper.is_finite()) {
                (true, false) => format!("{what} must be at least {low}"),
                (false, true) => format!("{what} must be at most {high}"),
                _ => format!("{what} must lie between {low} and {high}"),
            };
            return Err(self.out_of_range(&number, &message));
        }
        Ok(number)
    }

    /// Reads a count >= least (within 1e-6 of an integer); unknown in the rehearsal: `least`.
    ///
    /// # Errors
    /// As [`Args::number`]; a number that is not whole, too small, or above 2^53.
    pub fn count(&mut self, what: &str, least: u64) -> Result<u64, Diagnostic> {
        let number = self.number(what)?;
        if !number.known {
            return Ok(least);
        }
        let rounded = number.value.round();
        if (number.value - rounded).abs() > WHOLE {
            return Err(self.out_of_range(&number, &format!("{what} must be a whole number")));
        }
        if rounded < least as f64 {
            return Err(self.out_of_range(&number, &format!("{what} must be at least {least}")));
        }
        if rounded > LARGEST_COUNT {
            return Err(self.out_of_range(&number, &format!("{what} must be at most 2^53")));
        }
        Ok(rounded as u64)
    }

    /// Reads a formula.
    ///
    /// # Errors
    /// Mistakes in the expression, a constant that is not finite, x..z0 where there is no point.
    pub fn formula(&mut self, what: &str, place: Place) -> Result<Formula, Diagnostic> {
        let argument = self.take(what)?;
        let measure = self.measure.as_mut().map(|measure| &mut **measure as &mut dyn Measure);
        let formula = self.scope.compile(argument, measure)?;
        if place == Place::Nowhere && formula.reads_point() {
            return Err(no_point(argument.span, &format!("{what} does not belong to a point")));
        }
        match formula.as_constant() {
            Some(value) if !value.is_finite() && formula.is_known() => {
                Err(not_finite(what, value, argument.span))
            }
            _ => Ok(formula),
        }
    }

    /// Reads a formula or `NULL`.
    ///
    /// # Errors
    /// As [`Args::formula`].
    pub fn component(&mut self, what: &str, place: Place) -> Result<Option<Formula>, Diagnostic> {
        if self.keyword("NULL") {
            return Ok(None);
        }
        self.formula(what, place).map(Some)
    }

    /// The number a formula has now; `None` in the rehearsal if only a run can tell it.
    pub fn current(&mut self, formula: &Formula) -> Option<f64> {
        let measure = self.measure.as_mut().map(|measure| &mut **measure as &mut dyn Measure);
        current(formula, self.scope, measure)
    }

    /// An error at the number, with the range it should lie in.
    pub fn out_of_range(&self, number: &Number, message: &str) -> Diagnostic {
        Diagnostic::error(Code::Range, number.span, message)
            .label(format!("is {}", text::number(number.value)))
    }

    /// Everything has been read: an argument left over is an error at its own column.
    ///
    /// # Errors
    /// The first argument that nobody read.
    pub fn finish(self) -> Result<Vec<Diagnostic>, Diagnostic> {
        let Some(argument) = self.list.get(self.next) else {
            return Ok(self.remarks);
        };
        if argument.text.is_empty() {
            return Err(empty_argument(argument.span));
        }
        let message = format!(
            "`{}` takes no argument `{}` here",
            self.command.text,
            shortened(&argument.text)
        );
        Err(self.with_usage(
            Diagnostic::error(Code::Unread, argument.span, message)
                .label("nothing reads this argument"),
        ))
    }
}

/// The mistake of nothing between commas.
pub(super) fn empty_argument(span: Span) -> Diagnostic {
    Diagnostic::error(Code::EmptyArgument, span, "an argument is empty")
}

fn not_finite(what: &str, value: f64, span: Span) -> Diagnostic {
    Diagnostic::error(Code::NotFinite, span, format!("{what} must be finite"))
        .label(format!("is {}", text::number(value)))
}

/// The first line of a text, cut to a length that fits a message.
fn shortened(text: &str) -> String {
    let line = text.lines().next().unwrap_or_default();
    let short: String = line.chars().take(40).collect();
    if short.len() < text.len() { format!("{}...", short.trim_end()) } else { short }
}

#[cfg(test)]
mod tests {
    use super::super::source::Source;
    use super::super::syntax::{self, Statement};
    use super::*;

    /// Reads the only call of a script.
    fn with<R>(script: &str, read: impl FnOnce(Args<'_>) -> R) -> R {
        let (statements, _) = syntax::parse(&Source::new("a", script));
        let Some(Statement::Call { name, arguments, span }) = statements.first() else {
            panic!("a call: {script}")
        };
        let mut scope = Scope::default();
        scope.publish(
            "Ek_s",
            super::super::formula::Quantity::Fix { id: "Ek".to_string(), component: 3 },
        );
        read(Args::new(name, *span, arguments, &mut scope, None))
    }

    fn code<T>(result: Result<T, Diagnostic>) -> Option<(Code, usize, usize)> {
        result.err().map(|error| (error.code, error.span.start, error.span.end))
    }

    #[test]
    fn the_signature_decides_between_word_and_expression() {
        with("material(a, eos-strength, 3-1, \"b c\")", |mut args| {
            assert_eq!(
                (args.remaining(), args.peek(), args.peek_at(1)),
                (4, Some("a"), Some("eos-strength"))
            );
            assert_eq!(args.word("an ID").expect("a word").text, "a");
            assert_eq!(args.word("a style").expect("a word").text, "eos-strength");
            assert_eq!(args.number("rho").expect("a number").value, 2.0);
            assert!(args.peek_quoted());
            assert_eq!(args.word("text").expect("a word").text, "b c");
            assert!(args.finish().is_ok());
        });
        with("f(a b)", |mut args| assert_eq!(code(args.word("an ID")), Some((Code::Type, 2, 5))));
        with("f(\"1\")", |mut args| assert_eq!(code(args.number("N")), Some((Code::Type, 2, 5))));
        with("f(\"\")", |mut args| {
            assert_eq!(code(args.word("a file")), Some((Code::EmptyArgument, 2, 4)))
        });
    }

    #[test]
    fn missing_and_surplus_arguments() {
        with("run(1)", |mut args| {
            args.expect_usage("run(N)");
            assert!(args.number("N").is_ok());
            let error = args.number("a second N").expect_err("nothing left");
            assert_eq!((error.code, error.span), (Code::Arity, Span::new(5, 6)));
            assert_eq!(error.help, ["usage: run(N)"]);
        });
        with("run(1, b, c)", |mut args| {
            assert!(args.number("N").is_ok());
            assert_eq!(code(args.finish()), Some((Code::Unread, 7, 8)));
        });
        with("run(1,,c)", |mut args| {
            assert!(args.number("N").is_ok());
            assert_eq!(args.peek(), Some(""));
            assert_eq!(code(args.finish()), Some((Code::EmptyArgument, 6, 7)));
        });
    }

    #[test]
    fn ranges() {
        with("f(0, -1, 2, 1)", |mut args| {
            assert_eq!(code(args.positive("h")), Some((Code::Range, 2, 3)));
            assert_eq!(code(args.positive("h")), Some((Code::Range, 5, 7)));
            assert_eq!(code(args.within("alpha", 0.0, 1.0)), Some((Code::Range, 9, 10)));
            assert!(args.within("alpha", 0.0, 1.0).is_ok(), "the limits belong to it");
        });
        with("f(1/0, x, time)", |mut args| {
            assert_eq!(code(args.number("h")), Some((Code::NotFinite, 2, 5)));
            assert_eq!(code(args.number("h")), Some((Code::NotPlace, 7, 8)));
            assert!(!args.number("h").expect("known when reached").known);
        });
    }

    #[test]
    fn counts_are_whole() {
        with("f(3.0000005, 2.99, 0, 1e300, Ek_s, -0.0000001)", |mut args| {
            assert_eq!(args.count("N", 1).ok(), Some(3));
            assert_eq!(code(args.count("N", 1)), Some((Code::Range, 13, 17)));
            assert_eq!(code(args.count("N", 1)), Some((Code::Range, 19, 20)));
            assert_eq!(code(args.count("N", 1)), Some((Code::Range, 22, 27)));
            assert_eq!(args.count("N", 7).ok(), Some(7), "unknown in the rehearsal");
            assert_eq!(args.count("N", 0).ok(), Some(0));
        });
    }

    #[test]
    fn unknown_numbers_pass_every_range() {
        with("f(value(Ek_s), Ek_s, -Ek_s)", |mut args| {
            assert!(args.rehearsal());
            for _ in 0..2 {
                assert!(!args.positive("h").expect("unknown").known);
            }
            assert!(args.within("h", 0.0, 1.0).expect("unknown").value.is_nan());
        });
    }

    #[test]
    fn words_of_a_list() {
        with("f(jauman, none, all, x)", |mut args| {
            let error = args.choice("a rate", &["none", "jaumann"]).expect_err("misspelt");
            assert_eq!(error.help, ["did you mean `jaumann`? one of `none`, `jaumann`"]);
            assert_eq!(args.choice("a rate", &["none", "jaumann"]).ok(), Some(0));
            assert!(!args.keyword("solid"));
            assert!(args.keyword("all"));
            assert_eq!(args.remaining(), 1);
        });
    }

    #[test]
    fn components_may_be_left_alone() {
        with("f(NULL, 2*x, y)", |mut args| {
            assert!(args.component("vx", Place::Point).expect("NULL").is_none());
            let formula = args.component("vy", Place::Point).expect("good").expect("a formula");
            assert_eq!(formula.text(), "2*x");
            assert_eq!(code(args.component("vz", Place::Nowhere)), Some((Code::NotPlace, 13, 14)));
        });
    }
}
