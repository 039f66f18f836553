//! Expression to formula: names resolved, variables inserted, constants folded.

use super::diagnostic::{Code, Diagnostic};
use super::formula::Formula;
use super::function::Operator;
use super::parse::{self, Node};
use super::scope::{Measure, Scope, current};
use super::source::Span;
use super::syntax::Argument;
use super::tape::{Operation, fold};

/// A formula may have so many operations, variables inserted.
const LONGEST: usize = 4_000;

/// Compiles an argument as an expression.
pub(super) fn compile(
    argument: &Argument,
    scope: &mut Scope,
    mut measure: Option<&mut dyn Measure>,
) -> Result<Formula, Diagnostic> {
    if argument.quoted {
        return Err(Diagnostic::error(
            Code::Type,
            argument.span,
            "text in quotes is not an expression",
        )
        .label("expected a number or formula"));
    }
    let nodes = parse::parse(&argument.text, argument.span.start)?;
    let mut tape = Tape::default();
    for placed in &nodes {
        let operation = match &placed.node {
            Node::Number(number) => Operation::Constant(*number),
            Node::Name(name) => {
                tape.insert(&scope.resolve(name, placed.span)?);
                tape.check_length(argument.span)?;
                continue;
            }
            Node::Value => {
                tape.freeze(
                    placed.span,
                    scope,
                    measure.as_mut().map(|measure| &mut **measure as _),
                )?;
                continue;
            }
            Node::Group { function, group, axis } => {
                Operation::Slot(scope.group_slot(*function, group, *axis, placed.span)?)
            }
            Node::Negate => Operation::Negate,
            Node::Not => Operation::Not,
            Node::Operator(operator) => Operation::Operator(*operator),
            Node::One(function, action) => Operation::One(function, *action),
            Node::Two(function, action) => Operation::Two(function, *action),
            Node::If => Operation::Select,
        };
        tape.push(operation, placed.span);
        tape.check_length(argument.span)?;
    }
    if let (Some((_, span)), false) = (tape.infinite.first(), tape.operations.len() == 1) {
        return Err(Diagnostic::error(
            Code::NotFinite,
            *span,
            "this part of the formula is never finite",
        )
        .label("infinite or not a number"));
    }
    Ok(Formula::new(tape.operations, &|slot| scope.slot_name(slot)))
}

#[derive(Default)]
struct Tape {
    operations: Vec<Operation>,
    /// First operation of each value on the stack.
    starts: Vec<usize>,
    /// Operations with an operand that is a constant but not finite, and their places.
    infinite: Vec<(usize, Span)>,
}

impl Tape {
    fn check_length(&self, span: Span) -> Result<(), Diagnostic> {
        if self.operations.len() <= LONGEST {
            return Ok(());
        }
        let message = format!("the formula has more than {LONGEST} operations, variables inserted");
        Err(Diagnostic::error(Code::TooDeep, span, message)
            .help("freeze a part of it with `value(...)`"))
    }

    fn insert(&mut self, formula: &Formula) {
        self.starts.push(self.operations.len());
        self.operations.extend_from_slice(formula.operations());
    }

    fn push(&mut self, operation: Operation, span: Span) {
        let first = self.starts.len() - operation.operands();
        let start = self.starts.get(first).copied().unwrap_or(self.operations.len());
        let operands = &self.operations[start..];
        if matches!(operation, Operation::Select) {
            return self.select(first);
        }
        let constants = operands.iter().all(Operation::is_constant);
        if !operands.is_empty() && constants && operands.len() == operation.operands() {
            let folded = folded(&operation, operands);
            self.operations.truncate(start);
            self.operations.push(folded);
        } else {
            let infinite = self.starts[first..].iter().any(|start| match self.operations[*start] {
                Operation::Constant(value) => !value.is_finite(),
                _ => false,
            });
            if infinite {
                self.infinite.push((self.operations.len(), span));
            }
            self.multiply_squares(operation);
        }
        self.starts.truncate(first);
        self.starts.push(start);
    }

    /// Adds an operation; `a ^ 2` is a product, exact and quick.
    fn multiply_squares(&mut self, operation: Operation) {
        match (operation, self.operations.last()) {
            (Operation::Operator(Operator::Power), Some(Operation::Constant(2.0))) => {
                self.operations.pop();
                self.operations.push(Operation::Square);
            }
            _ => self.operations.push(operation),
        }
    }

    /// `if`: with a constant condition only the chosen branch stays.
    fn select(&mut self, first: usize) {
        let [start, yes, no] = [self.starts[first], self.starts[first + 1], self.starts[first + 2]];
        self.infinite.retain(|(index, _)| *index < yes);
        match self.operations[start..yes] {
            [Operation::Constant(condition)] if condition != 0.0 => {
                self.operations.truncate(no);
                self.operations.drain(start..yes);
            }
            [Operation::Constant(_)] => {
                self.operations.drain(start..no);
            }
            [Operation::Unknown] if self.operations[yes..].iter().all(Operation::is_constant) => {
                self.operations.truncate(start);
                self.operations.push(Operation::Unknown);
            }
            _ => self.operations.push(Operation::Select),
        }
        self.starts.truncate(first);
        self.starts.push(start);
    }

    /// `value(e)`: the number e has now.
    fn freeze(
        &mut self,
        span: Span,
        scope: &Scope,
        measure: Option<&mut dyn Measure>,
    ) -> Result<(), Diagnostic> {
        let start = self.starts[self.starts.len() - 1];
        let formula =
            Formula::new(self.operations[start..].to_vec(), &|slot| scope.slot_name(slot));
        if formula.reads_point() {
            return Err(no_point(span, "`value` freezes one number"));
        }
        let frozen = match current(&formula, scope, measure) {
            None => Operation::Unknown,
            Some(value) if value.is_finite() => Operation::Constant(value),
            Some(value) => {
                return Err(Diagnostic::error(
                    Code::NotFinite,
                    span,
                    format!("`{}` is {value} now", formula.text()),
                )
                .label("not a finite number"));
            }
        };
        self.operations.truncate(start);
        self.operations.push(frozen);
        Ok(())
    }
}

fn folded(operation: &Operation, operands: &[Operation]) -> Operation {
    let mut values = [0.0; 3];
    for (value, operand) in values.iter_mut().zip(operands) {
        match operand {
            Operation::Constant(constant) => *value = *constant,
            _ => return Operation::Unknown,
        }
    }
    // A square here and a square per point must give the same bits.
    match operation {
        Operation::Operator(Operator::Power) if values[1] == 2.0 => {
            Operation::Constant(values[0] * values[0])
        }
        _ => Operation::Constant(fold(operation, &values[..operands.len()])),
    }
}

/// The mistake of a place where there is none.
pub(super) fn no_point(span: Span, reason: &str) -> Diagnostic {
    Diagnostic::error(
        Code::NotPlace,
        span,
        format!("there is no point here to take `x` .. `z0` of: {reason}"),
    )
    .label("reads the place of a point")
}

#[cfg(test)]
mod tests {
    use super::super::arguments::Name;
    use super::super::formula::{Instant, Quantity};
    use super::*;

    struct Fixed(f64);

    impl Measure for Fixed {
        fn measure(&mut self, _quantity: &Quantity) -> f64 {
            self.0
        }
        fn now(&mut self) -> Instant {
            Instant { time: 2.0, dt: 0.5, step: 4 }
        }
    }

    fn name(text: &str) -> Name {
        Name { text: text.to_string(), span: Span::new(0, text.len()) }
    }

    fn set(scope: &mut Scope, variable: &str, value: &str) -> Result<String, Code> {
        let assigned = scope.assign(&name(variable), &Argument::bare(value), None);
        assigned.map(|(echo, _)| echo).map_err(|error| error.code)
    }

    fn set_now(scope: &mut Scope, variable: &str, value: &str, now: f64) -> Result<String, Code> {
        let assigned = scope.assign(&name(variable), &Argument::bare(value), Some(&mut Fixed(now)));
        assigned.map(|(echo, _)| echo).map_err(|error| error.code)
    }

    fn with_result() -> Scope {
        let mut scope = Scope::default();
        scope.publish("Ek_s", Quantity::Fix { id: "Ek".to_string(), component: 3 });
        scope
    }

    #[test]
    fn constants_are_folded_and_formulas_keep_what_they_were_built_of() {
        let mut scope = with_result();
        assert_eq!(set(&mut scope, "a", "2^3^2"), Ok("a = 512".to_string()));
        assert_eq!(set(&mut scope, "f", "a*Ek_s + time"), Ok("f = 512*Ek_s + time".to_string()));
        assert_eq!(set(&mut scope, "a", "1"), Ok("a = 1".to_string()));
        assert_eq!(set(&mut scope, "g", "-f"), Ok("g = -(512*Ek_s + time)".to_string()));
        assert_eq!(set(&mut scope, "e", "PI - PI"), Ok("e = 0".to_string()));
    }

    #[test]
    fn only_the_chosen_branch_counts() {
        let mut scope = Scope::default();
        assert_eq!(set(&mut scope, "a", "if(1, 2, 1/0)"), Ok("a = 2".to_string()));
        assert_eq!(set(&mut scope, "a", "if(0, log(-1), 3) + 1"), Ok("a = 4".to_string()));
        assert_eq!(set(&mut scope, "a", "if(1, x, 1/0)"), Ok("a = x".to_string()));
        assert_eq!(
            set(&mut scope, "a", "if(x > 0, 1/0, 2)"),
            Ok("a = if(x > 0, inf, 2)".to_string())
        );
        assert_eq!(set(&mut scope, "a", "if(1, 2, b)"), Err(Code::UnknownName));
    }

    #[test]
    fn what_is_never_finite_is_refused() {
        let mut scope = Scope::default();
        for text in ["1/0", "log(-1)", "x + 1/0", "0*(1/0)", "value(1/0)"] {
            assert_eq!(set(&mut scope, "a", text), Err(Code::NotFinite), "{text}");
        }
        assert_eq!(set(&mut scope, "a", "1/(1/0)"), Ok("a = 0".to_string()));
    }

    #[test]
    fn values_are_frozen_in_a_run_and_unknown_before() {
        let mut scope = with_result();
        assert_eq!(set_now(&mut scope, "a", "value(Ek_s*time)", 3.0), Ok("a = 6".to_string()));
        assert_eq!(
            set_now(&mut scope, "b", "evaluate(timestep + dt)*x", 3.0),
            Ok("b = 4.5*x".to_string())
        );
        assert_eq!(set_now(&mut scope, "b", "value(Ek_s)", f64::NAN), Err(Code::NotFinite));
        assert_eq!(set(&mut scope, "c", "value(x)"), Err(Code::NotPlace));
        assert_eq!(set(&mut scope, "c", "value(2)"), Ok("c = 2".to_string()));
        assert_eq!(set(&mut scope, "c", "2*value(Ek_s)"), Ok("c = ?".to_string()));
        assert_eq!(set(&mut scope, "d", "if(c > 0, 1, 2)"), Ok("d = ?".to_string()));
        assert_eq!(set(&mut scope, "e", "if(c > 0, x, 2)"), Ok("e = if(?, x, 2)".to_string()));
        assert!(!scope.formula(&name("e")).expect("known name").is_known());
    }

    #[test]
    fn formulas_have_a_longest_length() {
        let mut scope = Scope::default();
        assert!(set(&mut scope, "a", "x + y").is_ok());
        let last = (0..100).map(|_| set(&mut scope, "a", "a + a")).find(Result::is_err);
        assert_eq!(last, Some(Err(Code::TooDeep)));
        assert_eq!(set(&mut scope, "b", &("x+".repeat(100_000) + "x")), Err(Code::TooDeep));
    }
}
