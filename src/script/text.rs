//! Numbers and formulas as text that the language reads back.

use super::formula::Slot;
use super::function::{Operator, SIGN_LEVEL};
use super::tape::{Operation, subtree_starts};

/// Binds tighter than any operator: a name, a call, a number without sign.
const ATOM: u8 = 8;

const AXES: [&str; 3] = ["x", "y", "z"];
const REFERENCE_AXES: [&str; 3] = ["x0", "y0", "z0"];

/// The shortest text that reads back as the same number; whole numbers without a dot.
pub fn number(value: f64) -> String {
    let mut buffer = zmij::Buffer::new();
    let text = buffer.format(value);
    text.strip_suffix(".0").unwrap_or(text).to_string()
}

enum Task {
    /// Write the operand that ends at this operation; in parentheses if it binds less than this.
    Operand(usize, u8),
    Text(&'static str),
}

/// The formula that a tape computes, with no more parentheses than needed.
///
/// `name` gives the names of results. Written from the outside in with a list of tasks, so that
/// neither depth nor length costs more than in proportion.
pub(super) fn formula(operations: &[Operation], name: &dyn Fn(Slot) -> String) -> String {
    let starts = subtree_starts(operations);
    let mut text = String::new();
    let mut tasks = vec![Task::Operand(operations.len() - 1, 0)];
    while let Some(task) = tasks.pop() {
        let (root, weakest) = match task {
            Task::Text(piece) => {
                text.push_str(piece);
                continue;
            }
            Task::Operand(root, weakest) => (root, weakest),
        };
        if level(&operations[root]) < weakest {
            text.push('(');
            tasks.push(Task::Text(")"));
        }
        let first = tasks.len();
        write(&operations[root], root, &starts, name, &mut text, &mut tasks);
        tasks[first..].reverse();
    }
    text
}

fn level(operation: &Operation) -> u8 {
    match operation {
        Operation::Constant(value) if value.is_sign_negative() => SIGN_LEVEL,
        Operation::Negate | Operation::Not => SIGN_LEVEL,
        Operation::Square => Operator::Power.level(),
        Operation::Operator(operator) => operator.level(),
        _ => ATOM,
    }
}

/// Writes what stands before the first operand and lists the rest in reading order.
fn write(
    operation: &Operation,
    root: usize,
    starts: &[usize],
    name: &dyn Fn(Slot) -> String,
    text: &mut String,
    tasks: &mut Vec<Task>,
) {
    let last = || root - 1;
    let middle = || starts[root - 1] - 1;
    match operation {
        Operation::Constant(value) => text.push_str(&number(*value)),
        Operation::Unknown => text.push('?'),
        Operation::Slot(slot) => text.push_str(&name(*slot)),
        Operation::Time => text.push_str("time"),
        Operation::StepSize => text.push_str("dt"),
        Operation::StepNumber => text.push_str("timestep"),
        Operation::Current(axis) => text.push_str(AXES[*axis]),
        Operation::Reference(axis) => text.push_str(REFERENCE_AXES[*axis]),
        Operation::Negate => tasks.extend([Task::Text("-"), Task::Operand(last(), SIGN_LEVEL)]),
        Operation::Not => tasks.extend([Task::Text("!"), Task::Operand(last(), SIGN_LEVEL)]),
        Operation::Square => tasks.extend([Task::Operand(last(), ATOM), Task::Text("^2")]),
        Operation::Operator(operator) => {
            let level = operator.level();
            let (left, right) = match operator {
                Operator::Power => (ATOM, SIGN_LEVEL),
                _ if operator.compares() => (level + 1, level + 1),
                _ => (level, level + 1),
            };
            tasks.push(Task::Operand(middle(), left));
            match operator {
                Operator::Power | Operator::Multiply | Operator::Divide => {
                    tasks.push(Task::Text(operator.text()));
                }
                _ => tasks.extend([Task::Text(" "), Task::Text(operator.text()), Task::Text(" ")]),
            }
            tasks.push(Task::Operand(last(), right));
        }
        Operation::One(function, _) => {
            tasks.extend([Task::Text(function.name), Task::Text("(")]);
            tasks.extend([Task::Operand(last(), 0), Task::Text(")")]);
        }
        Operation::Two(function, _) => {
            tasks.extend([Task::Text(function.name), Task::Text("(")]);
            tasks.extend([Task::Operand(middle(), 0), Task::Text(", ")]);
            tasks.extend([Task::Operand(last(), 0), Task::Text(")")]);
        }
        Operation::Select => {
            tasks.extend([
                Task::Text("if("),
                Task::Operand(starts[middle()] - 1, 0),
                Task::Text(", "),
            ]);
            tasks.extend([Task::Operand(middle(), 0), Task::Text(", ")]);
            tasks.extend([Task::Operand(last(), 0), Task::Text(")")]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::scope::Scope;
    use super::super::syntax::Argument;
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back() {
        for (value, text) in [(20.0, "20"), (-0.05, "-0.05"), (1e-300, "1e-300"), (0.0, "0")] {
            assert_eq!(number(value), text);
        }
        for value in [0.1 + 0.2, 1.0 / 3.0, f64::MAX, 5e-324, 1e15, 123_456_789_012_345_680.0] {
            assert_eq!(number(value).parse(), Ok(value));
        }
    }

    #[test]
    fn formulas_read_as_computed() {
        let cases = [
            ("x", "x"),
            ("-x^2", "-x^2"),
            ("(-x)^2", "(-x)^2"),
            ("x^-3", "x^-3"),
            ("(-3)^x", "(-3)^x"),
            ("(x^y)^z", "(x^y)^z"),
            ("x^y^z", "x^y^z"),
            ("x-(y-z)", "x - (y - z)"),
            ("x-y-z", "x - y - z"),
            ("x*(y+time)/dt", "x*(y + time)/dt"),
            ("2*3*x", "6*x"),
            ("(x<y)<z", "(x < y) < z"),
            ("x<y==z", "x < y == z"),
            ("!(x&&y)||z0", "!(x && y) || z0"),
            ("max(x,y,z)", "max(max(x, y), z)"),
            ("if(x>0, sqrt(x), timestep)", "if(x > 0, sqrt(x), timestep)"),
            ("-(x*y)", "-(x*y)"),
            ("-x*y", "-x*y"),
        ];
        for (text, expected) in cases {
            let formula = Scope::default().compile(&Argument::bare(text), None).expect(text);
            assert_eq!(formula.text(), expected, "{text}");
            let again =
                Scope::default().compile(&Argument::bare(formula.text()), None).expect(expected);
            assert_eq!(again.text(), expected, "read back");
        }
    }
}
