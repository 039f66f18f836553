//! Formulas: compiled once to a flat tape, evaluated per step or per chunk of points.

use super::program::Program;
use super::tape::{Context, Operation, with_stack};
use super::text;
use std::sync::Arc;

/// Place on the board of one published quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Slot(pub usize);

/// Sums and means over groups that a formula may name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GroupFunction {
    /// Mass-weighted mean position \[L\].
    Xcm,
    /// Sum of the internal nodal forces of the last step \[M L/T^2\].
    InternalForce,
    /// Sum of the external nodal forces of the last step \[M L/T^2\].
    ExternalForce,
}

impl GroupFunction {
    /// The word in the script.
    pub fn word(self) -> &'static str {
        match self {
            GroupFunction::Xcm => "xcm",
            GroupFunction::InternalForce => "internal_force",
            GroupFunction::ExternalForce => "external_force",
        }
    }
}

/// What a slot of the board holds.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// Result of a fix: 0..=3 for x, y, z, s.
    Fix {
        /// The fix.
        id: String,
        /// 0..=3 for x, y, z, s.
        component: usize,
    },
    /// Result of a compute: index into its suffixes.
    Compute {
        /// The compute.
        id: String,
        /// Index into its suffixes.
        component: usize,
    },
    /// Result of a contact: 0..=3 for x, y, z, s.
    Contact {
        /// The contact.
        id: String,
        /// 0..=3 for x, y, z, s.
        component: usize,
    },
    /// Group function on an axis.
    Group {
        /// Which.
        function: GroupFunction,
        /// Over which group.
        group: String,
        /// 0, 1, 2 for x, y, z.
        axis: usize,
    },
}

/// Current values of all published quantities.
#[derive(Clone, Debug, Default)]
pub struct Board {
    /// One value per slot.
    pub values: Vec<f64>,
}

/// Points where a formula is evaluated; all slices of one length.
#[derive(Clone, Copy)]
pub struct Points<'a> {
    /// x, y, z \[L\].
    pub current: [&'a [f64]; 3],
    /// x0, y0, z0 \[L\].
    pub reference: [&'a [f64]; 3],
}

/// The instant at which a formula is evaluated.
#[derive(Clone, Copy, Debug, Default)]
pub struct Instant {
    /// `time` \[T\].
    pub time: f64,
    /// `dt` \[T\].
    pub dt: f64,
    /// `timestep`.
    pub step: u64,
}

/// A compiled expression. Cloning is cheap.
#[derive(Clone, Debug)]
pub struct Formula(Arc<Tape>);

#[derive(Debug)]
struct Tape {
    operations: Vec<Operation>,
    /// The same for many points.
    program: Program,
    /// Values alive at the same time.
    depth: usize,
    slots: Vec<Slot>,
    text: String,
}

impl Formula {
    /// A formula that is one number.
    pub fn constant(value: f64) -> Self {
        Self::new(vec![Operation::Constant(value)], &|_| String::new())
    }

    /// A formula that is one number which only a run can tell.
    pub(super) fn unknown() -> Self {
        Self::new(vec![Operation::Unknown], &|_| String::new())
    }

    /// A formula from a complete tape: `operations` leave exactly one value.
    pub(super) fn new(operations: Vec<Operation>, name: &dyn Fn(Slot) -> String) -> Self {
        let mut depth = 0;
        let mut alive = 0;
        for operation in &operations {
            alive = alive + 1 - operation.operands();
            depth = depth.max(alive);
        }
        let mut slots: Vec<Slot> = operations
            .iter()
            .filter_map(|operation| match operation {
                Operation::Slot(slot) => Some(*slot),
                _ => None,
            })
            .collect();
        slots.sort_unstable();
        slots.dedup();
        let program = Program::new(&operations);
        let text = text::formula(&operations, name);
        Self(Arc::new(Tape { operations, program, depth, slots, text }))
    }

    pub(super) fn operations(&self) -> &[Operation] {
        &self.0.operations
    }

    fn any(&self, test: impl Fn(&Operation) -> bool) -> bool {
        self.0.operations.iter().any(test)
    }

    /// The value, if it depends on nothing; NaN if only a run can tell it.
    pub fn as_constant(&self) -> Option<f64> {
        match self.0.operations[..] {
            [Operation::Constant(value)] => Some(value),
            [Operation::Unknown] => Some(f64::NAN),
            _ => None,
        }
    }

    /// False in the rehearsal if it contains a number that only a run can tell.
    pub fn is_known(&self) -> bool {
        !self.any(|operation| matches!(operation, Operation::Unknown))
    }

    /// Does it read x, y, z, x0, y0 or z0?
    pub fn reads_point(&self) -> bool {
        self.any(Operation::reads_point)
    }

    /// Does it read x0, y0 or z0?
    pub fn reads_reference(&self) -> bool {
        self.any(|operation| matches!(operation, Operation::Reference(_)))
    }

    /// Does it read x, y or z?
    pub fn reads_current(&self) -> bool {
        self.any(|operation| matches!(operation, Operation::Current(_)))
    }

    /// Does it read time, dt or timestep?
    pub fn reads_time(&self) -> bool {
        use Operation::{StepNumber, StepSize, Time};
        self.any(|operation| matches!(operation, Time | StepSize | StepNumber))
    }

    /// The slots it reads, in ascending order.
    pub fn slots(&self) -> &[Slot] {
        &self.0.slots
    }

    /// What it computes, as text: variables inserted, constants folded.
    pub fn text(&self) -> &str {
        &self.0.text
    }

    /// Value where there is no point; NaN if it reads one.
    pub fn value(&self, board: &Board, now: &Instant) -> f64 {
        if let Some(value) = self.as_constant() {
            return value;
        }
        let context = Context { board, now, points: None };
        with_stack(self.0.depth, |stack| context.scalar(&self.0.operations, stack))
    }

    /// Values at points: `out[i]` for each point (any number; evaluated in blocks of 64).
    pub fn fill(&self, board: &Board, now: &Instant, points: &Points<'_>, out: &mut [f64]) {
        self.0.program.fill(&Context { board, now, points: Some(points) }, out);
    }
}

#[cfg(test)]
mod tests {
    use super::super::scope::Scope;
    use super::super::syntax::Argument;
    use super::*;

    const NOW: Instant = Instant { time: 0.5, dt: 0.25, step: 2 };

    fn compile(text: &str) -> Formula {
        let mut scope = Scope::default();
        scope.publish("Ek_s", Quantity::Fix { id: "Ek".to_string(), component: 3 });
        scope
            .compile(&Argument::bare(text), None)
            .unwrap_or_else(|error| panic!("{text}: {}", error.message))
    }

    fn value(text: &str) -> f64 {
        compile(text).value(&Board { values: vec![8.0] }, &NOW)
    }

    #[test]
    fn every_operator_folded_and_at_work() {
        let cases = [
            ("2^3", 8.0),
            ("2**-1", 0.5),
            ("7*3", 21.0),
            ("7/2", 3.5),
            ("7+3", 10.0),
            ("7-3", 4.0),
            ("-7", -7.0),
            ("2<3", 1.0),
            ("3<3", 0.0),
            ("3<=3", 1.0),
            ("4<=3", 0.0),
            ("4>3", 1.0),
            ("3>3", 0.0),
            ("3>=3", 1.0),
            ("2>=3", 0.0),
            ("3==3", 1.0),
            ("2==3", 0.0),
            ("3!=3", 0.0),
            ("2!=3", 1.0),
            ("2&&3", 1.0),
            ("2&&0", 0.0),
            ("0||3", 1.0),
            ("0||0", 0.0),
            ("!3", 0.0),
            ("!0", 1.0),
            ("if(2,3,4)", 3.0),
            ("if(0,3,4)", 4.0),
            ("max(1,3,2)", 3.0),
            ("hypot(3,4)", 5.0),
            ("-3^2", -9.0),
        ];
        for (text, expected) in cases {
            assert_eq!(compile(text).as_constant(), Some(expected), "{text}");
            // `time*0 + 2` instead of `2`, so that nothing can be folded.
            let digits: String = text
                .chars()
                .map(|c| if c.is_ascii_digit() { format!("(time*0 + {c})") } else { c.to_string() })
                .collect();
            assert_eq!(value(&digits), expected, "{digits}");
        }
    }

    #[test]
    fn names_of_a_run() {
        assert_eq!(value("time + 10*dt + 100*timestep + 1000*Ek_s"), 0.5 + 2.5 + 200.0 + 8000.0);
        assert_eq!(compile("Ek_s + time").slots(), [Slot(0)]);
        assert!(value("x").is_nan(), "there is no point");
        assert!(compile("Ek_s").value(&Board::default(), &NOW).is_nan(), "nothing on the board");
    }

    #[test]
    fn formulas_say_what_they_read() {
        let cases = [
            ("1", 0),
            ("x", 1),
            ("x0*time", 7),
            ("dt", 4),
            ("timestep", 4),
            ("z0", 3),
            ("Ek_s", 0),
        ];
        for (text, expected) in cases {
            let formula = compile(text);
            let reads = [formula.reads_point(), formula.reads_reference(), formula.reads_time()];
            let bits = reads
                .iter()
                .enumerate()
                .map(|(bit, reads)| usize::from(*reads) << bit)
                .sum::<usize>();
            assert_eq!(bits, expected, "{text}");
        }
        assert_eq!(Formula::constant(2.5).text(), "2.5");
    }

    #[test]
    fn points_in_any_number() {
        let formula = compile("if(x < y0, (x + z)*sin(time), sqrt(Ek_s + 1)) - 2*y");
        let board = Board { values: vec![8.0] };
        for count in [0, 1, 63, 64, 65, 200] {
            let column =
                |shift: f64| -> Vec<f64> { (0..count).map(|n| (n as f64 + shift).cos()).collect() };
            let columns: Vec<Vec<f64>> = (0..6).map(|axis| column(f64::from(axis))).collect();
            let current = [&columns[0][..], &columns[1][..], &columns[2][..]];
            let reference = [&columns[3][..], &columns[4][..], &columns[5][..]];
            let mut out = vec![0.0; count];
            formula.fill(&board, &NOW, &Points { current, reference }, &mut out);
            for n in 0..count {
                let [x, y, z, y0] = [0, 1, 2, 4].map(|axis: usize| columns[axis][n]);
                let branch = if x < y0 { (x + z) * 0.5f64.sin() } else { 3.0 };
                assert_eq!(out[n], branch - 2.0 * y);
            }
        }
    }

    #[test]
    fn the_other_branch_does_not_leak() {
        let x = [-1.0, 4.0];
        let points = Points { current: [&x; 3], reference: [&x; 3] };
        let mut out = [0.0; 2];
        compile("if(x > 0, sqrt(x), 1/(x + 1 - x - 1 + 2))").fill(
            &Board::default(),
            &NOW,
            &points,
            &mut out,
        );
        assert_eq!(out, [0.5, 2.0]);
    }

    #[test]
    fn deep_formulas_find_room() {
        let deep = "x+(".repeat(60) + "y" + &")".repeat(60);
        let x = [1.0; 70];
        let mut out = [0.0; 70];
        compile(&deep).fill(
            &Board::default(),
            &NOW,
            &Points { current: [&x; 3], reference: [&x; 3] },
            &mut out,
        );
        assert_eq!(out, [61.0; 70]);
    }
}
