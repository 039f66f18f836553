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

    /// Equal for operations that give equal values from equal operands.
    pub(super) fn key(&self) -> (u8, u64) {
        let function = |function: &'static Function| std::ptr::from_ref(function) as u64;
        match self {
            Self::Constant(value) => (0, value.to_bits()),
            Self::Unknown => (1, 0),
            Self::Slot(slot) => (2, slot.0 as u64),
            Self::Time => (3, 0),
            Self::StepSize => (4, 0),
            Self::StepNumber => (5, 0),
            Self::Current(axis) => (6, *axis as u64),
            Self::Reference(axis) => (7, *axis as u64),
            Self::Negate => (8, 0),
            Self::Not => (9, 0),
            Self::Square => (10, 0),
            Self::Operator(operator) => (11, *operator as u64),
            Self::One(row, _) => (12, function(row)),
            Self::Two(row, _) => (13, function(row)),
            Self::Select => (14, 0),
        }
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
    } else if values <= 96 * BLOCK {
        use_it(&mut [0.0; 96 * BLOCK])
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
            top -= operation.operands();
            let operands = [0, 1, 2].map(|n| stack.get(top + n).copied().unwrap_or(0.0));
            let operands = operands.each_ref().map(std::slice::from_ref);
            self.perform(operation, operands, 0, &mut stack[top..=top]);
            top += 1;
        }
        stack[0]
    }

    /// Performs one operation on rows of values, for the points from `first` on.
    pub(super) fn perform(
        &self,
        operation: &Operation,
        [a, b, c]: [&[f64]; 3],
        first: usize,
        out: &mut [f64],
    ) {
        match *operation {
            Operation::Constant(value) => out.fill(value),
            Operation::Unknown => out.fill(f64::NAN),
            Operation::Slot(slot) => {
                out.fill(self.board.values.get(slot.0).copied().unwrap_or(f64::NAN));
            }
            Operation::Time => out.fill(self.now.time),
            Operation::StepSize => out.fill(self.now.dt),
            Operation::StepNumber => out.fill(self.now.step as f64),
            Operation::Current(axis) => {
                copy(self.points.map(|points| points.current[axis]), first, out);
            }
            Operation::Reference(axis) => {
                copy(self.points.map(|points| points.reference[axis]), first, out);
            }
            Operation::Negate => one(a, out, |a| -a),
            Operation::Not => one(a, out, |a| truth(a == 0.0)),
            Operation::Square => one(a, out, |a| a * a),
            Operation::One(_, function) => one(a, out, function),
            Operation::Two(_, function) => two(a, b, out, function),
            Operation::Operator(operator) => operate(operator, a, b, out),
            Operation::Select => select([a, b, c], out),
        }
    }
}

/// The value of an operation on constants.
pub(super) fn fold(operation: &Operation, operands: &[f64]) -> f64 {
    let operand = |n: usize| operands.get(n..=n).unwrap_or(&[]);
    let context = Context { board: &Board::default(), now: &Instant::default(), points: None };
    let mut value = [0.0];
    context.perform(operation, [operand(0), operand(1), operand(2)], 0, &mut value);
    value[0]
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
fn one(from: &[f64], out: &mut [f64], function: impl Fn(f64) -> f64) {
    for (value, a) in out.iter_mut().zip(from) {
        *value = function(*a);
    }
}

#[inline(always)]
fn two(left: &[f64], right: &[f64], out: &mut [f64], function: impl Fn(f64, f64) -> f64) {
    for ((value, a), b) in out.iter_mut().zip(left).zip(right) {
        *value = function(*a, *b);
    }
}

/// Takes the chosen value of each point, so that what the other branch gives does not matter.
fn select([condition, yes, no]: [&[f64]; 3], out: &mut [f64]) {
    for (((value, condition), yes), no) in out.iter_mut().zip(condition).zip(yes).zip(no) {
        *value = if *condition != 0.0 { *yes } else { *no };
    }
}

fn operate(operator: Operator, a: &[f64], b: &[f64], out: &mut [f64]) {
    match operator {
        Operator::Power => two(a, b, out, f64::powf),
        Operator::Multiply => two(a, b, out, |a, b| a * b),
        Operator::Divide => two(a, b, out, |a, b| a / b),
        Operator::Add => two(a, b, out, |a, b| a + b),
        Operator::Subtract => two(a, b, out, |a, b| a - b),
        Operator::Less => two(a, b, out, |a, b| truth(a < b)),
        Operator::LessEqual => two(a, b, out, |a, b| truth(a <= b)),
        Operator::Greater => two(a, b, out, |a, b| truth(a > b)),
        Operator::GreaterEqual => two(a, b, out, |a, b| truth(a >= b)),
        Operator::Equal => two(a, b, out, |a, b| truth(a == b)),
        Operator::NotEqual => two(a, b, out, |a, b| truth(a != b)),
        Operator::And => two(a, b, out, |a, b| truth(a != 0.0 && b != 0.0)),
        Operator::Or => two(a, b, out, |a, b| truth(a != 0.0 || b != 0.0)),
    }
}
