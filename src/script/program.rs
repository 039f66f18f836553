//! What a formula does at many points: each distinct value once, and those that are equal at all
//! points once for all of them.

use super::tape::{BLOCK, Context, Operation, with_stack};
use std::collections::HashMap;

/// Where a value is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Place {
    /// Among those equal at all points.
    Uniform(usize),
    /// Among those that differ from point to point.
    Varying(usize),
}

/// A distinct value of a formula.
#[derive(Debug)]
struct Value {
    operation: Operation,
    operands: [Place; 3],
}

/// The distinct values of a formula, each after its operands; the last one is the result.
#[derive(Debug)]
pub(super) struct Program {
    uniform: Vec<Value>,
    /// Uniform values that varying ones read.
    spread: Vec<usize>,
    /// Their uniform operands are numbered by `spread`.
    varying: Vec<Value>,
}

impl Program {
    /// The distinct values of a complete tape.
    pub(super) fn new(operations: &[Operation]) -> Self {
        let mut program = Self { uniform: Vec::new(), spread: Vec::new(), varying: Vec::new() };
        let mut known: HashMap<((u8, u64), [Place; 3]), Place> = HashMap::new();
        let mut stack: Vec<Place> = Vec::new();
        for operation in operations {
            let first = stack.len() - operation.operands();
            let mut operands = [Place::Uniform(0); 3];
            operands[..operation.operands()].copy_from_slice(&stack[first..]);
            stack.truncate(first);
            let place = known
                .entry((operation.key(), operands))
                .or_insert_with(|| program.add(*operation, operands));
            stack.push(*place);
        }
        program
    }

    fn add(&mut self, operation: Operation, operands: [Place; 3]) -> Place {
        let varies = operands.iter().any(|place| matches!(place, Place::Varying(_)));
        if !varies && !operation.reads_point() {
            self.uniform.push(Value { operation, operands });
            return Place::Uniform(self.uniform.len() - 1);
        }
        let count = operation.operands();
        let mut value = Value { operation, operands };
        for operand in &mut value.operands[..count] {
            if let Place::Uniform(index) = operand {
                *index = self.spread(*index);
            }
        }
        self.varying.push(value);
        Place::Varying(self.varying.len() - 1)
    }

    /// Number of a uniform value among those that varying ones read.
    fn spread(&mut self, index: usize) -> usize {
        let known = self.spread.iter().position(|known| *known == index);
        known.unwrap_or_else(|| {
            self.spread.push(index);
            self.spread.len() - 1
        })
    }

    /// Values at the points of the context.
    pub(super) fn fill(&self, context: &Context<'_>, out: &mut [f64]) {
        with_stack(self.uniform.len(), |uniform| {
            for (index, value) in self.uniform.iter().enumerate() {
                let (before, rest) = uniform.split_at_mut(index);
                let operand = |place: Place| match place {
                    Place::Uniform(index) => before.get(index..=index).unwrap_or(&[]),
                    Place::Varying(_) => &[],
                };
                context.perform(&value.operation, value.operands.map(operand), 0, &mut rest[..1]);
            }
            match (self.varying.len(), self.uniform.len()) {
                (0, 0) => {}
                (0, last) => out.fill(uniform[last - 1]),
                _ => self.fill_varying(context, uniform, out),
            }
        });
    }

    fn fill_varying(&self, context: &Context<'_>, uniform: &[f64], out: &mut [f64]) {
        let width = BLOCK.min(out.len());
        with_stack((self.spread.len() + self.varying.len()) * width, |rows| {
            let (spread, rows) = rows.split_at_mut(self.spread.len() * width);
            for (index, row) in self.spread.iter().zip(spread.chunks_exact_mut(width.max(1))) {
                row.fill(uniform[*index]);
            }
            for (block, out) in out.chunks_mut(BLOCK).enumerate() {
                for (index, value) in self.varying.iter().enumerate() {
                    let (before, row) = rows.split_at_mut(index * width);
                    let operand = |place: Place| match place {
                        Place::Uniform(index) => spread.get(index * width..).unwrap_or(&[]),
                        Place::Varying(index) => &before[index * width..],
                    };
                    let operands = value.operands.map(operand);
                    let row = &mut row[..out.len()];
                    context.perform(&value.operation, operands, block * BLOCK, row);
                }
                let last = (self.varying.len() - 1) * width;
                out.copy_from_slice(&rows[last..][..out.len()]);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::formula::{Board, Formula, Instant, Points};
    use super::super::scope::Scope;
    use super::super::syntax::Argument;
    use super::*;

    fn compile(text: &str) -> Formula {
        let compiled = Scope::default().compile(&Argument::bare(text), None);
        compiled.unwrap_or_else(|error| panic!("{text}: {}", error.message))
    }

    #[test]
    fn equal_values_are_there_once() {
        let cases = [
            ("(x + time)*(x + time)", 1, 3),
            ("sin(2*time) + sin(2*time)", 5, 0),
            ("sin(x) + cos(x) + sin(x)", 0, 5),
            ("x*y - y*x", 0, 5),
            ("x0 + x", 0, 3),
            ("if(x > 0, sqrt(x), sqrt(x))", 1, 4),
        ];
        for (text, uniform, varying) in cases {
            let program = Program::new(compile(text).operations());
            assert_eq!(
                (program.uniform.len(), program.varying.len()),
                (uniform, varying),
                "{text}"
            );
        }
    }

    #[test]
    fn doubling_a_sum_eight_times_costs_eight_sums() {
        let mut scope = Scope::default();
        let name = |text: &str| super::super::arguments::Name {
            text: text.to_string(),
            span: super::super::source::Span::new(0, text.len()),
        };
        scope.assign(&name("a"), &Argument::bare("x + time"), None).unwrap();
        for _ in 0..8 {
            scope.assign(&name("a"), &Argument::bare("a + a"), None).unwrap();
        }
        let formula = scope.formula(&name("a")).unwrap();
        assert_eq!(Program::new(formula.operations()).varying.len(), 10);
        let x: Vec<f64> = (0..130).map(f64::from).collect();
        let mut out = vec![0.0; 130];
        let now = Instant { time: 0.5, dt: 0.0, step: 0 };
        let points = Points { current: [&x; 3], reference: [&x; 3] };
        formula.fill(&Board::default(), &now, &points, &mut out);
        assert!(out.iter().zip(&x).all(|(a, x)| *a == 256.0 * (x + 0.5)));
    }
}
