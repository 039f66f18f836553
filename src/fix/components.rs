//! Up to three formulas, one per axis, evaluated at the nodes or particles of a group.

use crate::fault::Fault;
use crate::fix::Target;
use crate::model::column::Column;
use crate::plan::Plan;
use crate::script::arguments::{Args, Place};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::formula::{Board, Formula, Instant, Points};

const BLOCK: usize = 64;

/// A vector of formulas; `NULL` leaves an axis alone.
#[derive(Clone, Debug)]
pub struct Components {
    id: String,
    axes: [Option<Formula>; 3],
}

/// Current and reference position of a member of a group.
pub type Position = ([f64; 3], [f64; 3]);

/// Position of particles: their places and their columns x0, y0, z0.
pub fn of_particles<'a>(
    places: &'a [[f64; 4]],
    reference: &'a [Vec<f64>],
) -> impl Fn(usize) -> Position + 'a {
    move |particle| {
        let [x, y, z, _] = places[particle];
        let original =
            std::array::from_fn(|axis| reference[axis].get(particle).copied().unwrap_or(0.0));
        ([x, y, z], original)
    }
}

impl Components {
    /// A vector of formulas for the fix of ID `id`.
    pub fn new(id: &str, axes: [Option<Formula>; 3]) -> Self {
        Self { id: id.to_string(), axes }
    }

    /// Reads as many components as dimensions, up to three; surplus ones are ignored.
    ///
    /// # Errors
    /// Too few components, or one that is no formula.
    pub fn read(
        args: &mut Args<'_>,
        target: &Target,
        names: [&str; 3],
    ) -> Result<Self, Diagnostic> {
        let mut axes = [None, None, None];
        for axis in 0..3 {
            if axis >= target.dimension && args.remaining() == 0 {
                break;
            }
            let span = args.next_span();
            let formula = args.component(names[axis], Place::Point)?;
            if axis < target.dimension {
                axes[axis] = formula;
            } else if formula.and_then(|f| f.as_constant()).is_some_and(|value| value != 0.0) {
                let dimension = target.dimension;
                let message = format!("{} is ignored in {dimension} dimensions", names[axis]);
                args.remarks.push(
                    Diagnostic::warning(Code::SurplusComponent, span, message)
                        .label("has no effect"),
                );
            }
        }
        Ok(Self::new(&target.id, axes))
    }

    /// The formulas that are not `NULL`.
    pub fn formulas(&self) -> Vec<&Formula> {
        self.axes.iter().flatten().collect()
    }

    /// Reference positions, if a formula reads them.
    pub fn needs(&self, plan: &mut Plan, dimension: usize) {
        plan.node_places |= self.axes.iter().flatten().any(|formula| formula.reads_current());
        if self.axes.iter().flatten().any(|formula| formula.reads_reference()) {
            plan.columns.extend(&[Column::X0, Column::Y0, Column::Z0][..dimension]);
        }
    }

    /// Calls `visit(member, values)` for each member; an axis that is `NULL` has no value.
    ///
    /// # Errors
    /// A value that is not finite.
    pub fn each(
        &self,
        board: &Board,
        now: &Instant,
        members: impl Iterator<Item = usize>,
        position: impl Fn(usize) -> Position,
        mut visit: impl FnMut(usize, [Option<f64>; 3]),
    ) -> Result<(), Fault> {
        let constant = |axis: &Option<Formula>| axis.as_ref().map(|formula| formula.as_constant());
        let constants = self.axes.each_ref().map(constant);
        if constants.iter().all(|axis| *axis != Some(None)) {
            let values = constants.map(Option::flatten);
            members.for_each(|member| visit(member, values));
            return Ok(());
        }
        let mut members = members.peekable();
        let mut block = Block::default();
        while members.peek().is_some() {
            block.gather(&position, &mut members);
            let values = block.evaluate(self, board, now)?;
            for (lane, member) in block.member[..block.len].iter().enumerate() {
                let value = |axis: usize| self.axes[axis].as_ref().map(|_| values[axis][lane]);
                visit(*member, [value(0), value(1), value(2)]);
            }
        }
        Ok(())
    }
}

struct Block {
    len: usize,
    member: [usize; BLOCK],
    current: [[f64; BLOCK]; 3],
    reference: [[f64; BLOCK]; 3],
}

impl Default for Block {
    fn default() -> Self {
        let points = [[0.0; BLOCK]; 3];
        Self { len: 0, member: [0; BLOCK], current: points, reference: points }
    }
}

impl Block {
    fn gather(
        &mut self,
        position: impl Fn(usize) -> Position,
        members: &mut impl Iterator<Item = usize>,
    ) {
        self.len = 0;
        for member in members.take(BLOCK) {
            let (current, reference) = position(member);
            for axis in 0..3 {
                self.current[axis][self.len] = current[axis];
                self.reference[axis][self.len] = reference[axis];
            }
            self.member[self.len] = member;
            self.len += 1;
        }
    }

    fn evaluate(
        &self,
        components: &Components,
        board: &Board,
        now: &Instant,
    ) -> Result<[[f64; BLOCK]; 3], Fault> {
        let points = Points {
            current: self.current.each_ref().map(|axis| &axis[..self.len]),
            reference: self.reference.each_ref().map(|axis| &axis[..self.len]),
        };
        let mut values = [[0.0; BLOCK]; 3];
        for (formula, values) in components.axes.iter().zip(&mut values) {
            let Some(formula) = formula else { continue };
            formula.fill(board, now, &points, &mut values[..self.len]);
            if let Some(lane) = values[..self.len].iter().position(|value| !value.is_finite()) {
                return Err(Fault::run(format!(
                    "fix `{}`: `{}` is {} at ({}, {}, {}), step {}, time {:.6e}",
                    components.id,
                    formula.text(),
                    values[lane],
                    self.current[0][lane],
                    self.current[1][lane],
                    self.current[2][lane],
                    now.step,
                    now.time
                )));
            }
        }
        Ok(values)
    }
}
