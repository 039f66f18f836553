//! The tape of a formula: operations in postfix order, and how they are performed.

use super::formula::{Board, Instant, Points, Slot};
use super::function::{Function, Operator};

/// Points that are evaluated together.
pub(super) const BLOCK: usize = 64;

/// One operation of the tape, on the values before it.
#[derive(Clone, Copy, Debug)]
pub(super) enum Operation {
    Constant(f64),
    /// A constant that only a run can tell; not a number until then.
    Unknown,
    Slot(Slot),
    Time,
    StepSize,
    StepNumber,
    Current(usize),
    Reference(usize),
    Negate,
    Not,
    Square,
    Operator(Operator),
    One(&'static Function, fn(f64) -> f64),
    Two(&'static Function, fn(f64, f64) -> f64),
    Select,
}

impl Operation {
    /// Number of values it takes.
    pub(super) fn operands(&self) -> usize {
        match self {
            Self::Negate | Self::Not | Self::Square | Self::One(..) => 1,
            Self::Operator(_) | Self::Two(..) => 2,
            Self::Select => 3,
            _ => 0,
        }
    }

    pub(super) fn reads_point(&self) -> bool {
        matches!(self, Self::Current(_) | Self::Reference(_))
    }

    /// Is it one fixed number, known or not?
    pub(super) fn is_constant(&self) -> bool {
        matches!(self, Self::Constant(_) | Self::Unknown)
    }
}

/// For each operation the first operation of the subtree that ends with it.
pub(super) fn subtree_starts(operations: &[Operation]) -> Vec<usize> {
    let mut starts: Vec<usize> = Vec::with_capacity(operations.len());
    for (index, operation) in operations.iter().enumerate() {
        let start = (0..operation.operands()).fold(index, |start, _| starts[start - 1]);
        starts.push(start);
    }
    starts
}

/// Lends room for so many values, on the stack if they are few.
pub(super) fn with_stack<R>(values: usize, use_it: impl FnOnce(&mut [f64]) -> R) -> R {
    if values <= 8 {
        use_it(&mut [0.0; 8])
    } else if values <= 4 * BLOCK {
        use_it(&mut [0.0; 4 * BLOCK])
    } else if values <= 16 * BLOCK {
        use_it(&mut [0.0; 16 * BLOCK])
    } else {
        use_it(&mut vec![0.0; values])
    }
}

/// Where and when operations are performed.
pub(super) struct Context<'a> {
    pub(super) board: &'a Board,
    pub(super) now: &'a Instant,
    pub(super) points: Option<&'a Points<'a>>,
}

impl Context<'_> {
    /// The value of a complete tape.
    pub(super) fn scalar(&self, operations: &[Operation], stack: &mut [f64]) -> f64 {
        let mut top = 0;
        for operation in operations {
            self.perform(operation, stack, &mut top, 0, 1);
        }
        stack[0]
    }

    /// Performs one operation on rows of `width` values, for the points from `first` on.
    pub(super) fn perform(
        &self,
        operation: &Operation,
        stack: &mut [f64],
        top: &mut usize,
        first: usize,
        width: usize,
    ) {
        let row = *top * width;
        *top = *top + 1 - operation.operands();
        match *operation {
            Operation::Constant(value) => stack[row..row + width].fill(value),
            Operation::Unknown => stack[row..row + width].fill(f64::NAN),
            Operation::Slot(slot) => {
                let value = self.board.values.get(slot.0).copied().unwrap_or(f64::NAN);
                stack[row..row + width].fill(value);
            }
            Operation::Time => stack[row..row + width].fill(self.now.time),
            Operation::StepSize => stack[row..row + width].fill(self.now.dt),
            Operation::StepNumber => stack[row..row + width].fill(self.now.step as f64),
            Operation::Current(axis) => {
                copy(
                    self.points.map(|points| points.current[axis]),
                    first,
                    &mut stack[row..row + width],
                );
            }
            Operation::Reference(axis) => {
                copy(
                    self.points.map(|points| points.reference[axis]),
                    first,
                    &mut stack[row..row + width],
                );
            }
            Operation::Negate => one(&mut stack[row - width..row], |a| -a),
            Operation::Not => one(&mut stack[row - width..row], |a| truth(a == 0.0)),
            Operation::Square => one(&mut stack[row - width..row], |a| a * a),
            Operation::One(_, function) => one(&mut stack[row - width..row], function),
            Operation::Two(_, function) => two(&mut stack[row - 2 * width..row], function),
            Operation::Operator(operator) => operate(operator, &mut stack[row - 2 * width..row]),
            Operation::Select => select(&mut stack[row - 3 * width..row]),
        }
    }
}

/// The value of an operation on constants.
pub(super) fn fold(operation: &Operation, operands: &[f64]) -> f64 {
    let mut stack = [0.0; 3];
    stack[..operands.len()].copy_from_slice(operands);
    let context = Context { board: &Board::default(), now: &Instant::default(), points: None };
    context.perform(operation, &mut stack, &mut operands.len(), 0, 1);
    stack[0]
}

fn copy(from: Option<&[f64]>, first: usize, row: &mut [f64]) {
    match from.and_then(|values| values.get(first..first + row.len())) {
        Some(values) => row.copy_from_slice(values),
        None => row.fill(f64::NAN),
    }
}

fn truth(holds: bool) -> f64 {
    if holds { 1.0 } else { 0.0 }
}

#[inline(always)]
fn one(row: &mut [f64], function: impl Fn(f64) -> f64) {
    for value in row {
        *value = function(*value);
    }
}

#[inline(always)]
fn two(rows: &mut [f64], function: impl Fn(f64, f64) -> f64) {
    let (left, right) = rows.split_at_mut(rows.len() / 2);
    for (a, b) in left.iter_mut().zip(right) {
        *a = function(*a, *b);
    }
}

/// Takes the chosen value of each point, so that what the other branch gives does not matter.
fn select(rows: &mut [f64]) {
    let (condition, branches) = rows.split_at_mut(rows.len() / 3);
    let (yes, no) = branches.split_at(branches.len() / 2);
    for ((condition, yes), no) in condition.iter_mut().zip(yes).zip(no) {
        *condition = if *condition != 0.0 { *yes } else { *no };
    }
}

fn operate(operator: Operator, rows: &mut [f64]) {
    match operator {
        Operator::Power => two(rows, f64::powf),
        Operator::Multiply => two(rows, |a, b| a * b),
        Operator::Divide => two(rows, |a, b| a / b),
        Operator::Add => two(rows, |a, b| a + b),
        Operator::Subtract => two(rows, |a, b| a - b),
        Operator::Less => two(rows, |a, b| truth(a < b)),
        Operator::LessEqual => two(rows, |a, b| truth(a <= b)),
        Operator::Greater => two(rows, |a, b| truth(a > b)),
        Operator::GreaterEqual => two(rows, |a, b| truth(a >= b)),
        Operator::Equal => two(rows, |a, b| truth(a == b)),
        Operator::NotEqual => two(rows, |a, b| truth(a != b)),
        Operator::And => two(rows, |a, b| truth(a != 0.0 && b != 0.0)),
        Operator::Or => two(rows, |a, b| truth(a != 0.0 || b != 0.0)),
    }
}
