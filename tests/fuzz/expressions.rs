//! Random expressions against an evaluator of their own trees.

use super::cases;
use super::random::Random;
use karamelo::script::arguments::Name;
use karamelo::script::diagnostic::Code;
use karamelo::script::formula::{Board, Instant, Points};
use karamelo::script::scope::Scope;
use karamelo::script::source::Span;
use karamelo::script::syntax::Argument;
use std::fmt::Write;

/// An expression as language.md 2 has it.
enum Tree {
    Number(f64, String),
    /// `time`, `x`, `y0`: names of a run, by their place in [`NAMES`].
    Name(usize),
    Sign(char, Box<Tree>),
    Pair(&'static str, Box<Tree>, Box<Tree>),
    Call(&'static str, Vec<Tree>),
}

const NAMES: [&str; 3] = ["time", "x", "y0"];

/// What the names stand for.
const VALUES: [f64; 3] = [0.75, -1.25, 2.5];

/// Operators and how tightly they bind.
const OPERATORS: [(&str, u8); 14] = [
    ("^", 7),
    ("**", 7),
    ("*", 5),
    ("/", 5),
    ("+", 4),
    ("-", 4),
    ("<", 3),
    ("<=", 3),
    (">", 3),
    (">=", 3),
    ("==", 2),
    ("!=", 2),
    ("&&", 1),
    ("||", 0),
];

/// How tightly a sign binds.
const SIGN: u8 = 6;

/// Functions that the standard library computes too, with the number of their arguments.
const CALLS: [(&str, usize); 31] = [
    ("exp", 1),
    ("exp2", 1),
    ("expm1", 1),
    ("log", 1),
    ("ln", 1),
    ("log10", 1),
    ("log2", 1),
    ("log1p", 1),
    ("sqrt", 1),
    ("cbrt", 1),
    ("hypot", 2),
    ("pow", 2),
    ("abs", 1),
    ("sign", 1),
    ("min", 3),
    ("max", 2),
    ("floor", 1),
    ("ceil", 1),
    ("trunc", 1),
    ("round", 1),
    ("mod", 2),
    ("sin", 1),
    ("cos", 1),
    ("tan", 1),
    ("asin", 1),
    ("acos", 1),
    ("atan", 1),
    ("atan2", 2),
    ("sinh", 1),
    ("cosh", 1),
    ("if", 3),
];

/// A random tree; `names`: it may read the run.
fn tree(random: &mut Random, depth: usize, names: bool) -> Tree {
    let leaf = depth == 0 || random.one_in(5);
    match random.below(10) {
        0..4 if leaf && names => Tree::Name(random.below(NAMES.len())),
        _ if leaf => number(random),
        0 => Tree::Sign(*random.of(&['-', '+', '!']), Box::new(tree(random, depth - 1, names))),
        1..4 => {
            let (name, count) = *random.of(&CALLS);
            Tree::Call(name, (0..count).map(|_| tree(random, depth - 1, names)).collect())
        }
        _ => {
            let (operator, _) = *random.of(&OPERATORS);
            let [left, right] = [(); 2].map(|()| Box::new(tree(random, depth - 1, names)));
            Tree::Pair(operator, left, right)
        }
    }
}

/// A number in one of the ways to write it.
fn number(random: &mut Random) -> Tree {
    let value = match random.below(6) {
        0 => random.below(10) as f64,
        1 => random.between(0.0, 1.0),
        2 => random.between(0.0, 1e3),
        3 => 10f64.powi(random.below(40) as i32 - 20),
        4 => 0.5 * random.below(9) as f64,
        _ => random.between(0.0, 4.0),
    };
    let text = match random.below(4) {
        0 => format!("{value:e}"),
        1 => format!("{value:E}").replace("E", "E+").replace("E+-", "E-"),
        2 if value > 0.0 && value < 1.0 => format!("{value}").replacen("0.", ".", 1),
        2 if value == value.trunc() && value < 1e6 => format!("{value}."),
        _ => format!("{value}"),
    };
    Tree::Number(value, text)
}

impl Tree {
    fn level(&self) -> u8 {
        match self {
            Tree::Pair(operator, ..) => {
                OPERATORS.iter().find(|(text, _)| text == operator).map_or(9, |(_, level)| *level)
            }
            Tree::Sign(..) => SIGN,
            _ => 9,
        }
    }

    /// Writes it with the parentheses that it needs, and some more.
    fn write(&self, random: &mut Random, text: &mut String) {
        let blank = |random: &mut Random, text: &mut String| {
            text.push_str(random.of::<&str>(&["", "", " ", "\t"]));
        };
        match self {
            Tree::Number(_, written) => text.push_str(written),
            Tree::Name(name) => text.push_str(NAMES[*name]),
            Tree::Sign(sign, inner) => {
                text.push(*sign);
                inner.write_within(random, text, inner.level() < SIGN);
            }
            Tree::Pair(operator, left, right) => {
                let level = self.level();
                let power = level == 7;
                let compares = matches!(level, 2 | 3);
                let (l, r) = (left.level(), right.level());
                // Comparisons do not chain; powers group from the right, and an exponent may have
                // a sign.
                let left_in = if power { l <= level } else { l < level };
                let right_in = if power { r < SIGN } else { r <= level };
                let chains = |other: u8| compares && matches!(other, 2 | 3);
                left.write_within(random, text, left_in || chains(l));
                blank(random, text);
                text.push_str(operator);
                blank(random, text);
                right.write_within(random, text, right_in || chains(r));
            }
            Tree::Call(name, arguments) => {
                let _ = write!(text, "{name}(");
                for (number, argument) in arguments.iter().enumerate() {
                    text.push_str(if number > 0 { ", " } else { "" });
                    argument.write_within(random, text, false);
                }
                text.push(')');
            }
        }
    }

    fn write_within(&self, random: &mut Random, text: &mut String, needed: bool) {
        let parentheses = needed || random.one_in(8);
        if parentheses {
            text.push('(');
        }
        self.write(random, text);
        if parentheses {
            text.push(')');
        }
    }

    /// Its value.
    fn value(&self) -> f64 {
        match self {
            Tree::Number(value, _) => *value,
            Tree::Name(name) => VALUES[*name],
            Tree::Sign(sign, inner) => {
                let value = inner.value();
                match sign {
                    '-' => -value,
                    '!' => f64::from(value == 0.0),
                    _ => value,
                }
            }
            Tree::Pair(operator, left, right) => pair(operator, left.value(), right.value()),
            Tree::Call("if", arguments) => {
                arguments[if arguments[0].value() != 0.0 { 1 } else { 2 }].value()
            }
            Tree::Call(name, arguments) => {
                let values: Vec<f64> = arguments.iter().map(Tree::value).collect();
                call(name, &values)
            }
        }
    }

    fn is_constant(&self) -> bool {
        match self {
            Tree::Number(..) => true,
            Tree::Name(_) => false,
            Tree::Sign(_, inner) => inner.is_constant(),
            Tree::Pair(_, left, right) => left.is_constant() && right.is_constant(),
            Tree::Call("if", arguments) if arguments[0].is_constant() => {
                arguments[if arguments[0].value() != 0.0 { 1 } else { 2 }].is_constant()
            }
            Tree::Call(_, arguments) => arguments.iter().all(Tree::is_constant),
        }
    }

    /// Has it a part without names that is not finite?
    fn has_infinite_part(&self) -> bool {
        let inside = match self {
            Tree::Number(..) | Tree::Name(_) => false,
            Tree::Sign(_, inner) => inner.has_infinite_part(),
            Tree::Pair(_, left, right) => left.has_infinite_part() || right.has_infinite_part(),
            Tree::Call(_, arguments) => arguments.iter().any(Tree::has_infinite_part),
        };
        inside || (self.is_constant() && !self.value().is_finite())
    }
}

fn pair(operator: &str, a: f64, b: f64) -> f64 {
    let truth = f64::from;
    match operator {
        // A square is a product: language.md leaves it open, and both are within half a digit.
        "^" | "**" if b == 2.0 => a * a,
        "^" | "**" => a.powf(b),
        "*" => a * b,
        "/" => a / b,
        "+" => a + b,
        "-" => a - b,
        "<" => truth(a < b),
        "<=" => truth(a <= b),
        ">" => truth(a > b),
        ">=" => truth(a >= b),
        "==" => truth(a == b),
        "!=" => truth(a != b),
        "&&" => truth(a != 0.0 && b != 0.0),
        "||" => truth(a != 0.0 || b != 0.0),
        other => unreachable!("{other}"),
    }
}

fn call(name: &str, a: &[f64]) -> f64 {
    // A number that is none stays one in minimum and maximum.
    let fold = |better: fn(f64, f64) -> f64| {
        let any = a.iter().any(|x| x.is_nan());
        if any { f64::NAN } else { a.iter().copied().reduce(better).unwrap_or(f64::NAN) }
    };
    match name {
        "exp" => a[0].exp(),
        "exp2" => a[0].exp2(),
        "expm1" => a[0].exp_m1(),
        "log" | "ln" => a[0].ln(),
        "log10" => a[0].log10(),
        "log2" => a[0].log2(),
        "log1p" => a[0].ln_1p(),
        "sqrt" => a[0].sqrt(),
        "cbrt" => a[0].cbrt(),
        "hypot" => a[0].hypot(a[1]),
        "pow" => a[0].powf(a[1]),
        "abs" => a[0].abs(),
        "sign" if a[0] == 0.0 || a[0].is_nan() => a[0],
        "sign" => a[0].signum(),
        "min" => fold(|a, b| if a < b { a } else { b }),
        "max" => fold(|a, b| if a > b { a } else { b }),
        "floor" => a[0].floor(),
        "ceil" => a[0].ceil(),
        "trunc" => a[0].trunc(),
        "round" => a[0].round(),
        "mod" => a[0] - a[1] * (a[0] / a[1]).floor(),
        "sin" => a[0].sin(),
        "cos" => a[0].cos(),
        "tan" => a[0].tan(),
        "asin" => a[0].asin(),
        "acos" => a[0].acos(),
        "atan" => a[0].atan(),
        "atan2" => a[0].atan2(a[1]),
        "sinh" => a[0].sinh(),
        "cosh" => a[0].cosh(),
        other => unreachable!("{other}"),
    }
}

/// What the program makes of a text: for many points at once, and for one number where there is no
/// point; `Err` with the code of its mistake.
fn found(text: &str) -> Result<f64, (Code, String)> {
    let mut scope = Scope::default();
    let name = Name { text: "a".to_string(), span: Span::new(0, 1) };
    let refused =
        |mistake: karamelo::script::diagnostic::Diagnostic| (mistake.code, mistake.message);
    scope.assign(&name, &Argument::bare(text), None).map_err(refused)?;
    let formula = scope.formula(&name).map_err(refused)?;
    let (board, now) = (Board::default(), Instant { time: VALUES[0], ..Instant::default() });
    let [x, y0] = [[VALUES[1]; 65], [VALUES[2]; 65]];
    let points = Points { current: [&x, &y0, &x], reference: [&x, &y0, &x] };
    let mut values = [0.0; 65];
    formula.fill(&board, &now, &points, &mut values);
    assert!(values.iter().all(|value| value.to_bits() == values[0].to_bits()), "{text}");
    if !formula.reads_point() {
        let alone = formula.value(&board, &now);
        assert!(same(alone, values[0]), "{text}: {alone} alone, {} at points", values[0]);
    }
    Ok(values[0])
}

fn same(a: f64, b: f64) -> bool {
    a == b || (a.is_nan() && b.is_nan())
}

/// What is wrong with an expression.
fn judged(case: u64) -> Option<String> {
    let mut random = Random::of_case(case);
    let (depth, names) = (1 + random.below(5), random.one_in(2));
    let tree = tree(&mut random, depth, names);
    let mut text = String::new();
    tree.write_within(&mut random, &mut text, false);
    let exact = tree.value();
    match found(&text) {
        Ok(value) if tree.is_constant() && !exact.is_finite() => {
            Some(format!("{text}: {value}, which is not finite, is accepted"))
        }
        Ok(value) if same(value, exact) => None,
        Ok(value) => Some(format!("{text}: {value} instead of {exact}")),
        Err((Code::NotFinite, _)) if tree.has_infinite_part() => None,
        Err((code, message)) => Some(format!("{text}: {} {message}", code.number())),
    }
}

#[test]
fn random_expressions_have_the_values_of_their_trees() {
    let wrong: Vec<String> = (0..cases(10_000)).filter_map(judged).collect();
    assert!(wrong.is_empty(), "{} wrong, first {:#?}", wrong.len(), &wrong[..wrong.len().min(10)]);
}

#[test]
fn the_judge_of_expressions_sees_a_wrong_sign_and_a_wrong_grouping() {
    let two = || Box::new(Tree::Number(2.0, "2".to_string()));
    let three = || Box::new(Tree::Number(3.0, "3".to_string()));
    // -(2^2), and (2^3)^2 against 2^(3^2).
    let square = Tree::Sign('-', Box::new(Tree::Pair("^", two(), two())));
    assert_eq!((square.value(), found("-2^2").unwrap()), (-4.0, -4.0));
    assert_ne!(square.value(), found("(-2)^2").unwrap());
    let tower = Tree::Pair("^", Box::new(Tree::Pair("^", two(), three())), two());
    let mut text = String::new();
    tower.write(&mut Random::of_case(3), &mut text);
    assert!(text.contains('('), "{text}");
    assert_eq!((tower.value(), found("2^3^2").unwrap()), (64.0, 512.0));
}
