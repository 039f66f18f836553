//! What must hold for every input: values as an independent evaluator gives them, and no panic.

use super::arguments::{Args, Name, Place};
use super::diagnostic;
use super::formula::{Board, Instant, Points};
use super::scope::Scope;
use super::source::{Source, Span};
use super::syntax::{self, Argument, Statement};
use proptest::prelude::*;

/// An expression as a tree, which the program itself never makes.
#[derive(Clone, Debug)]
enum Tree {
    Number(f64),
    Name(usize),
    Sign(char, Box<Tree>),
    Pair(&'static str, Box<Tree>, Box<Tree>),
    One(&'static str, Box<Tree>),
    Max(Vec<Tree>),
    If(Box<[Tree; 3]>),
}

const NAMES: [&str; 6] = ["x", "y", "z", "x0", "time", "dt"];
const PAIRS: [&str; 13] = ["+", "-", "*", "/", "^", "<", "<=", ">", ">=", "==", "!=", "&&", "||"];

fn tree() -> impl Strategy<Value = Tree> {
    let leaf = prop_oneof![
        (0u32..20).prop_map(|quarters| Tree::Number(f64::from(quarters) / 4.0)),
        (0..NAMES.len()).prop_map(Tree::Name),
    ];
    leaf.prop_recursive(6, 60, 3, |inner| {
        let boxed = inner.clone().prop_map(Box::new);
        prop_oneof![
            (prop::sample::select(vec!['-', '!']), boxed.clone())
                .prop_map(|(sign, a)| Tree::Sign(sign, a)),
            (prop::sample::select(PAIRS.to_vec()), boxed.clone(), boxed.clone())
                .prop_map(|(pair, a, b)| Tree::Pair(pair, a, b)),
            (prop::sample::select(vec!["sin", "abs", "floor", "erf"]), boxed)
                .prop_map(|(name, a)| Tree::One(name, a)),
            prop::collection::vec(inner.clone(), 2..4).prop_map(Tree::Max),
            [inner.clone(), inner.clone(), inner].prop_map(|three| Tree::If(Box::new(three))),
        ]
    })
}

/// The tree as text, every operator in parentheses.
fn write(tree: &Tree) -> String {
    match tree {
        Tree::Number(number) => format!("{number}"),
        Tree::Name(name) => NAMES[*name].to_string(),
        Tree::Sign(sign, a) => format!("({sign} {})", write(a)),
        Tree::Pair(pair, a, b) => format!("({}\t{pair}\n{})", write(a), write(b)),
        Tree::One(name, a) => format!("{name} ({})", write(a)),
        Tree::Max(list) => {
            format!("max({})", list.iter().map(write).collect::<Vec<_>>().join(" , "))
        }
        Tree::If(three) => {
            format!("if({},{},{})", write(&three[0]), write(&three[1]), write(&three[2]))
        }
    }
}

fn truth(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

fn evaluate(tree: &Tree, names: &[f64; 6]) -> f64 {
    let of = |tree: &Tree| evaluate(tree, names);
    match tree {
        Tree::Number(number) => *number,
        Tree::Name(name) => names[*name],
        Tree::Sign('-', a) => -of(a),
        Tree::Sign(_, a) => truth(of(a) == 0.0),
        Tree::One("sin", a) => of(a).sin(),
        Tree::One("abs", a) => of(a).abs(),
        Tree::One("floor", a) => of(a).floor(),
        Tree::One(_, a) => libm::erf(of(a)),
        Tree::Max(list) => list.iter().map(of).fold(f64::NEG_INFINITY, |a, b| {
            if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
        }),
        Tree::If(three) if of(&three[0]) != 0.0 => of(&three[1]),
        Tree::If(three) => of(&three[2]),
        Tree::Pair(pair, a, b) => {
            let (a, b) = (of(a), of(b));
            match *pair {
                "+" => a + b,
                "-" => a - b,
                "*" => a * b,
                "/" => a / b,
                "^" if b == 2.0 => a * a,
                "^" => a.powf(b),
                "<" => truth(a < b),
                "<=" => truth(a <= b),
                ">" => truth(a > b),
                ">=" => truth(a >= b),
                "==" => truth(a == b),
                "!=" => truth(a != b),
                "&&" => truth(a != 0.0 && b != 0.0),
                _ => truth(a != 0.0 || b != 0.0),
            }
        }
    }
}

fn same(found: f64, expected: f64) -> bool {
    found.is_nan() && expected.is_nan()
        || found == expected
        || (found - expected).abs() <= 1e-12 * expected.abs()
}

const SCRIPT: &str = "# two disks\nE = 1e+3\nL = 1.\nhL = 0.5*L\nmethod(ulmpm, FLIP, linear, hL)\n\
    region(r, block, -hL, hL, # more\n  INF, max(1, 2))\r\nv = if(x < 0, -1, value(time))\n\
    fix(v0, initial_velocity_particles, \"a b\", v, -v, NULL)\nEtot = xcm(all, x)^2**-1\nquit\n";

/// Reads everything as a rehearsal would, without knowing any command.
fn rehearse(text: &str) {
    let source = Source::new("soup", text);
    let (statements, mut list) = syntax::parse(&source);
    let mut scope = Scope::default();
    for statement in &statements {
        match statement {
            Statement::Assign { name, value } => match scope.assign(name, value, None) {
                Ok((_, remarks)) => list.extend(remarks),
                Err(error) => list.push(error),
            },
            Statement::Call { name, arguments, span } => {
                let mut args = Args::new(name, *span, arguments, &mut scope, None);
                list.extend(args.word("a word").err());
                while args.remaining() > 0 {
                    list.extend(args.component("a number", Place::Point).err());
                }
                list.extend(args.finish().err());
            }
            Statement::Quit { .. } => {}
        }
    }
    for diagnostic in &list {
        let Span { start, end } = diagnostic.span;
        assert!(start <= end && end <= source.text.len(), "{diagnostic:?}");
        assert!(
            source.text.is_char_boundary(start) && source.text.is_char_boundary(end),
            "{diagnostic:?}"
        );
    }
    let shown = diagnostic::render(&list, &source, false);
    assert_eq!(shown.is_empty(), list.is_empty());
}

proptest! {
    #[test]
    fn formulas_give_what_an_independent_evaluator_gives(
        tree in tree(),
        x in prop::collection::vec(prop::sample::select(vec![-2.0, -0.5, 0.0, 0.25, 1.0, 3.0]), 70),
    ) {
        let text = write(&tree);
        let Ok(formula) = Scope::default().compile(&Argument::bare(&text), None) else {
            // Only parts that are never finite may be refused.
            let refused = Scope::default().compile(&Argument::bare(&text), None).expect_err("refused");
            prop_assert_eq!(refused.code, diagnostic::Code::NotFinite);
            return Ok(());
        };
        let (board, now) = (Board::default(), Instant { time: 0.75, dt: 0.125, step: 6 });
        let half: Vec<f64> = x.iter().map(|x| 0.5 * x).collect();
        let points = Points { current: [&x, &half, &x], reference: [&half, &x, &half] };
        let mut out = vec![0.0; x.len()];
        formula.fill(&board, &now, &points, &mut out);
        for (found, x) in out.iter().zip(&x) {
            let expected = evaluate(&tree, &[*x, 0.5 * x, *x, 0.5 * x, 0.75, 0.125]);
            prop_assert!(same(*found, expected), "{} at {}: {} {}", text, x, found, expected);
        }
        if !formula.reads_point() {
            prop_assert!(same(formula.value(&board, &now), out[0]));
        }
        if !formula.text().contains("inf") && !formula.text().contains("NaN") {
            let again = Scope::default().compile(&Argument::bare(formula.text()), None).expect("its own text");
            let mut read_back = vec![0.0; x.len()];
            again.fill(&board, &now, &points, &mut read_back);
            prop_assert!(read_back.iter().zip(&out).all(|(a, b)| same(*a, *b)), "{}", formula.text());
        }
    }

    #[test]
    fn byte_soup_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let (source, _) = Source::from_bytes("soup", &bytes);
        rehearse(&source.text);
    }

    #[test]
    fn token_soup_never_panics(words in prop::collection::vec(prop::sample::select(vec![
        "a", "x0", "if", "max", "xcm", "value", "quit", "1", "1.", ".5e", "e", "é", "(", "(", ")", ")", ",", "\"",
        "#", "=", "==", "<", "!", "&&", "^", "-", "+", "*", "\n", "\n", "\r\n", " ", "\t", "NULL", "all",
    ]), 0..60)) {
        rehearse(&words.concat());
    }

    #[test]
    fn mutated_scripts_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), 0..3, any::<char>()), 1..6),
    ) {
        let mut text: Vec<char> = SCRIPT.chars().collect();
        for (index, kind, character) in changes {
            // One more than there is, so that the text may be empty.
            let place = index.index(text.len() + 1).min(text.len().saturating_sub(1));
            match kind {
                0 => drop(text.splice(place..text.len().min(place + 1), [])),
                1 => text.insert(place, character),
                _ => text.truncate(place),
            }
        }
        rehearse(&text.into_iter().collect::<String>());
    }
}

#[test]
fn the_unchanged_script_is_faultless() {
    let source = Source::new("a", SCRIPT);
    let (statements, mistakes) = syntax::parse(&source);
    assert_eq!((statements.len(), mistakes.len()), (9, 0));
    let mut scope = Scope::default();
    for statement in &statements {
        if let Statement::Assign { name, value } = statement {
            assert!(scope.assign(name, value, None).is_ok(), "{}", name.text);
        }
    }
    let name = Name { text: "Etot".to_string(), span: Span::default() };
    assert_eq!(scope.formula(&name).expect("defined").text(), "xcm(all, x)^0.5");
}

#[test]
fn places_are_right_behind_marks_tabs_and_long_characters() {
    let source = Source::new("a", "\u{feff}é = 1\r\n\tb = é*\u{1d6d1} # é\r\nf(\"é\",\tc d)\r\n");
    let (statements, mistakes) = syntax::parse(&source);
    assert!(mistakes.is_empty());
    let mut scope = Scope::default();
    let mut places = Vec::new();
    for statement in &statements {
        let mistake = match statement {
            Statement::Assign { name, value } => scope.assign(name, value, None).err(),
            Statement::Call { name, arguments, span } => {
                let mut args = Args::new(name, *span, arguments, &mut scope, None);
                args.word("a file").expect("a word");
                args.number("a number").err()
            }
            Statement::Quit { .. } => None,
        };
        if let Some(mistake) = mistake {
            places.push((
                source.position(mistake.span.start),
                diagnostic::render(&[mistake], &source, false),
            ));
        }
    }
    assert_eq!(places.iter().map(|(place, _)| *place).collect::<Vec<_>>(), [(2, 8), (3, 10)]);
    assert!(places[0].1.contains("--> a:2:8\n"), "{}", places[0].1);
    assert!(places[1].1.contains("--> a:3:10\n"), "{}", places[1].1);
}

#[test]
fn long_scripts_take_no_longer_than_their_length() {
    let lines = [
        "\n",
        "a = a + x\n",
        "f(",
        "f(a\n",
        "(1)\n",
        "\"",
        "#",
        "b,",
        "c = unknown\n",
        "f(,,,)\n",
        "1.2.3 ",
    ];
    let started = std::time::Instant::now();
    for line in lines {
        rehearse(&line.repeat(20_000 / line.len()));
        rehearse(&("f(a".to_string() + &line.repeat(20_000 / line.len())));
        rehearse(&("a = (".to_string() + &line.repeat(20_000 / line.len())));
    }
    assert!(started.elapsed().as_secs() < 60, "{:?}", started.elapsed());
}
