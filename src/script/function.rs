//! Operators and functions of expressions (language.md 2).

use super::formula::GroupFunction;

/// An operator between two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// `a ^ b`, `a ** b`
    Power,
    /// `a * b`
    Multiply,
    /// `a / b`
    Divide,
    /// `a + b`
    Add,
    /// `a - b`
    Subtract,
    /// `a < b`
    Less,
    /// `a <= b`
    LessEqual,
    /// `a > b`
    Greater,
    /// `a >= b`
    GreaterEqual,
    /// `a == b`
    Equal,
    /// `a != b`
    NotEqual,
    /// `a && b`
    And,
    /// `a || b`
    Or,
}

/// How tightly the signs `-a`, `+a`, `!a` bind: below power, above product.
pub const SIGN_LEVEL: u8 = 6;

impl Operator {
    /// As written.
    pub fn text(self) -> &'static str {
        match self {
            Self::Power => "^",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Less => "<",
            Self::LessEqual => "<=",
            Self::Greater => ">",
            Self::GreaterEqual => ">=",
            Self::Equal => "==",
            Self::NotEqual => "!=",
            Self::And => "&&",
            Self::Or => "||",
        }
    }

    /// How tightly it binds: the first column of the table in language.md 2.
    pub fn level(self) -> u8 {
        match self {
            Self::Power => 7,
            Self::Multiply | Self::Divide => 5,
            Self::Add | Self::Subtract => 4,
            Self::Less | Self::LessEqual | Self::Greater | Self::GreaterEqual => 3,
            Self::Equal | Self::NotEqual => 2,
            Self::And => 1,
            Self::Or => 0,
        }
    }

    /// Does it compare? Then it cannot be chained.
    pub fn compares(self) -> bool {
        matches!(self.level(), 2 | 3)
    }
}

/// What a function does with its arguments.
#[derive(Clone, Copy, Debug)]
pub enum Action {
    /// Of one number.
    One(fn(f64) -> f64),
    /// Of two numbers.
    Two(fn(f64, f64) -> f64),
    /// Of two numbers or more, from the left.
    Fold(fn(f64, f64) -> f64),
    /// `if`.
    If,
    /// `value`, `evaluate`.
    Value,
    /// Of a group and an axis.
    Group(GroupFunction),
}

/// A function that expressions may call.
#[derive(Debug)]
pub struct Function {
    /// The word in the script.
    pub name: &'static str,
    /// The call, as messages show it.
    pub usage: &'static str,
    /// What it does.
    pub action: Action,
}

const fn one(name: &'static str, usage: &'static str, action: fn(f64) -> f64) -> Function {
    Function { name, usage, action: Action::One(action) }
}

const fn two(name: &'static str, usage: &'static str, action: fn(f64, f64) -> f64) -> Function {
    Function { name, usage, action: Action::Two(action) }
}

const fn row(name: &'static str, usage: &'static str, action: Action) -> Function {
    Function { name, usage, action }
}

/// Every function.
pub const FUNCTIONS: &[Function] = &[
    one("exp", "exp(a)", f64::exp),
    one("exp2", "exp2(a)", f64::exp2),
    one("expm1", "expm1(a)", f64::exp_m1),
    one("log", "log(a)", f64::ln),
    one("ln", "ln(a)", f64::ln),
    one("log10", "log10(a)", f64::log10),
    one("log2", "log2(a)", f64::log2),
    one("log1p", "log1p(a)", f64::ln_1p),
    one("sqrt", "sqrt(a)", f64::sqrt),
    one("cbrt", "cbrt(a)", f64::cbrt),
    two("hypot", "hypot(a, b)", f64::hypot),
    two("pow", "pow(a, b)", f64::powf),
    one("abs", "abs(a)", f64::abs),
    one("sign", "sign(a)", sign),
    row("min", "min(a, b, ...)", Action::Fold(smaller)),
    row("max", "max(a, b, ...)", Action::Fold(larger)),
    one("floor", "floor(a)", f64::floor),
    one("ceil", "ceil(a)", f64::ceil),
    one("trunc", "trunc(a)", f64::trunc),
    one("round", "round(a)", f64::round),
    two("mod", "mod(a, b)", modulo),
    two("remainder", "remainder(a, b)", libm::remainder),
    one("sin", "sin(a)", f64::sin),
    one("cos", "cos(a)", f64::cos),
    one("tan", "tan(a)", f64::tan),
    one("asin", "asin(a)", f64::asin),
    one("acos", "acos(a)", f64::acos),
    one("atan", "atan(a)", f64::atan),
    two("atan2", "atan2(y, x)", f64::atan2),
    one("sinh", "sinh(a)", f64::sinh),
    one("cosh", "cosh(a)", f64::cosh),
    one("tanh", "tanh(a)", f64::tanh),
    one("asinh", "asinh(a)", libm::asinh),
    one("acosh", "acosh(a)", libm::acosh),
    one("atanh", "atanh(a)", libm::atanh),
    one("erf", "erf(a)", libm::erf),
    one("erfc", "erfc(a)", libm::erfc),
    one("tgamma", "tgamma(a)", libm::tgamma),
    one("lgamma", "lgamma(a)", libm::lgamma),
    one("inv_norm", "inv_norm(p)", inv_norm),
    row("if", "if(condition, a, b)", Action::If),
    row("value", "value(a)", Action::Value),
    row("evaluate", "evaluate(a)", Action::Value),
    row("xcm", "xcm(group, x|y|z)", Action::Group(GroupFunction::Xcm)),
    row(
        "internal_force",
        "internal_force(group, x|y|z)",
        Action::Group(GroupFunction::InternalForce),
    ),
    row(
        "external_force",
        "external_force(group, x|y|z)",
        Action::Group(GroupFunction::ExternalForce),
    ),
];

/// The function of that name.
pub fn find(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|function| function.name == name)
}

/// 1, 0, -1 as the number is above, at or below zero.
fn sign(a: f64) -> f64 {
    if a > 0.0 {
        1.0
    } else if a < 0.0 {
        -1.0
    } else {
        a
    }
}

/// The smaller one; not a number if one of them is not.
fn smaller(a: f64, b: f64) -> f64 {
    if a < b || a.is_nan() { a } else { b }
}

/// The larger one; not a number if one of them is not.
fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// a - b floor(a/b).
fn modulo(a: f64, b: f64) -> f64 {
    a - b * (a / b).floor()
}

/// Quantile of the standard normal law: the z with Phi(z) = p, to about 1e-16.
///
/// With q = p - 1/2: z = q A(r)/B(r), r = 0.425^2 - q^2, if |q| <= 0.425; else with
/// r = sqrt(-ln min(p, 1-p)): z = sign(q) C(r-1.6)/D(r-1.6) for r <= 5, sign(q) E(r-5)/F(r-5) beyond.
///
/// # Source
/// Wichura 1988, Algorithm AS 241, PPND16.
fn inv_norm(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180625 - q * q;
        return q * polynomial(&CENTRE[0], r) / polynomial(&CENTRE[1], r);
    }
    let tail = if q < 0.0 { p } else { 1.0 - p };
    if tail == 0.0 {
        return f64::INFINITY.copysign(q);
    }
    // A negative tail has no logarithm: outside of [0, 1] the result is not a number.
    let r = (-tail.ln()).sqrt();
    let z = if r <= 5.0 {
        polynomial(&TAIL[0], r - 1.6) / polynomial(&TAIL[1], r - 1.6)
    } else {
        polynomial(&FAR_TAIL[0], r - 5.0) / polynomial(&FAR_TAIL[1], r - 5.0)
    };
    if q < 0.0 { -z } else { z }
}

fn polynomial(coefficients: &[f64; 8], r: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, coefficient| sum * r + coefficient)
}

/// A and B of AS 241.
const CENTRE: [[f64; 8]; 2] = [
    [
        3.387_132_872_796_366_5,
        133.141_667_891_784_38,
        1_971.590_950_306_551_3,
        13_731.693_765_509_46,
        45_921.953_931_549_87,
        67_265.770_927_008_7,
        33_430.575_583_588_13,
        2_509.080_928_730_122_7,
    ],
    [
        1.0,
        42.313_330_701_600_91,
        687.187_007_492_057_9,
        5_394.196_021_424_751,
        21_213.794_301_586_597,
        39_307.895_800_092_71,
        28_729.085_735_721_943,
        5_226.495_278_852_854,
    ],
];

/// C and D of AS 241.
const TAIL: [[f64; 8]; 2] = [
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        0.241_780_725_177_450_6,
        0.022_723_844_989_269_184,
        7.745_450_142_783_414e-4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        0.689_767_334_985_1,
        0.148_103_976_427_480_08,
        0.015_198_666_563_616_457,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ],
];

/// E and F of AS 241.
const FAR_TAIL: [[f64; 8]; 2] = [
    [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        0.296_560_571_828_504_87,
        0.026_532_189_526_576_124,
        0.001_242_660_947_388_078_4,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        0.599_832_206_555_888,
        0.136_929_880_922_735_8,
        0.014_875_361_290_850_615,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_7e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{E, FRAC_PI_4, LN_2, PI};

    fn call(name: &str, a: f64) -> f64 {
        match find(name).expect("a function").action {
            Action::One(action) => action(a),
            _ => panic!("`{name}` does not take one number"),
        }
    }

    fn call_two(name: &str, a: f64, b: f64) -> f64 {
        match find(name).expect("a function").action {
            Action::Two(action) | Action::Fold(action) => action(a, b),
            _ => panic!("`{name}` does not take two numbers"),
        }
    }

    fn near(found: f64, expected: f64) -> bool {
        (found - expected).abs() <= 4.0 * f64::EPSILON * expected.abs().max(1e-300)
    }

    #[test]
    fn functions_of_one_number_at_special_points() {
        let cases = [
            ("exp", 1.0, E),
            ("exp2", 10.0, 1024.0),
            ("expm1", 1e-20, 1e-20),
            ("log", E, 1.0),
            ("ln", 2.0, LN_2),
            ("log10", 1e-3, -3.0),
            ("log2", 8.0, 3.0),
            ("log1p", 1e-20, 1e-20),
            ("sqrt", 2.25, 1.5),
            ("cbrt", -27.0, -3.0),
            ("abs", -2.5, 2.5),
            ("sign", -3.0, -1.0),
            ("sign", 0.0, 0.0),
            ("sign", 1e-300, 1.0),
            ("floor", -1.5, -2.0),
            ("ceil", -1.5, -1.0),
            ("trunc", -1.5, -1.0),
            ("round", 2.5, 3.0),
            ("round", -2.5, -3.0),
            ("sin", PI / 6.0, 0.5),
            ("cos", PI, -1.0),
            ("tan", FRAC_PI_4, 1.0),
            ("asin", 1.0, PI / 2.0),
            ("acos", -1.0, PI),
            ("atan", 1.0, FRAC_PI_4),
            ("sinh", LN_2, 0.75),
            ("cosh", LN_2, 1.25),
            ("tanh", LN_2, 0.6),
            ("asinh", 0.75, LN_2),
            ("acosh", 1.25, LN_2),
            ("atanh", 0.6, LN_2),
            ("erf", 1.0, 0.842_700_792_949_714_9),
            ("erfc", 5.0, 1.537_459_794_428_035e-12),
            ("tgamma", 5.0, 24.0),
            ("tgamma", 0.5, PI.sqrt()),
            ("lgamma", 0.5, PI.sqrt().ln()),
            ("lgamma", 2.0, 0.0),
        ];
        for (name, a, expected) in cases {
            assert!(near(call(name, a), expected), "{name}({a}) = {}", call(name, a));
        }
    }

    #[test]
    fn functions_of_two_numbers_at_special_points() {
        let cases = [
            ("hypot", 3e200, 4e200, 5e200),
            ("pow", 2.0, -1.0, 0.5),
            ("mod", -1.0, 3.0, 2.0),
            ("mod", 5.5, -2.0, -0.5),
            ("remainder", 5.0, 3.0, -1.0),
            ("remainder", 3.0, 2.0, -1.0),
            ("remainder", 1.0, 2.0, 1.0),
            ("atan2", -1.0, -1.0, -3.0 * FRAC_PI_4),
            ("min", 1.0, -2.0, -2.0),
            ("max", 1.0, -2.0, 1.0),
        ];
        for (name, a, b, expected) in cases {
            assert!(near(call_two(name, a, b), expected), "{name}({a}, {b})");
        }
    }

    #[test]
    fn extremes_keep_what_is_not_a_number() {
        for name in ["min", "max"] {
            assert!(call_two(name, f64::NAN, 1.0).is_nan());
            assert!(call_two(name, 1.0, f64::NAN).is_nan());
        }
        assert!(call("sign", f64::NAN).is_nan());
    }

    #[test]
    fn normal_quantile_inverts_the_normal_law() {
        let law = |z: f64| 0.5 * libm::erfc(-z / 2f64.sqrt());
        for p in [1e-300, 1e-20, 1e-12, 1e-5, 0.01, 0.0749, 0.0751, 0.2, 0.5, 0.7, 0.9249, 0.9251] {
            let back = law(inv_norm(p));
            // The law loses digits in its far tail: d ln p = -z dz.
            let tolerance = 4e-16 * (1.0 + inv_norm(p).powi(2));
            assert!((back / p - 1.0).abs() < tolerance, "{p} {back}");
        }
        assert_eq!(inv_norm(0.5), 0.0);
        assert!((inv_norm(0.975) - 1.959_963_984_540_054).abs() < 5e-16);
        assert!((inv_norm(0.25) + inv_norm(0.75)).abs() < 1e-16);
    }

    #[test]
    fn normal_quantile_at_and_beyond_its_ends() {
        assert_eq!(inv_norm(0.0), f64::NEG_INFINITY);
        assert_eq!(inv_norm(1.0), f64::INFINITY);
        for p in [-0.1, 1.1, f64::NAN] {
            assert!(inv_norm(p).is_nan());
        }
    }

    #[test]
    fn the_table_is_sound() {
        for function in FUNCTIONS {
            assert_eq!(FUNCTIONS.iter().filter(|other| other.name == function.name).count(), 1);
            assert!(function.usage.starts_with(&format!("{}(", function.name)));
        }
        assert!(find("sine").is_none());
    }
}
