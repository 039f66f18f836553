//! Names a script knows: variables, results, protected names, `-var` overrides.

use super::arguments::Name;
use super::compile;
use super::diagnostic::{Code, Diagnostic};
use super::formula::{Board, Formula, GroupFunction, Quantity, Slot};
use super::function;
use super::source::{Source, Span};
use super::suggest;
use super::syntax::Argument;
use super::tape::Operation;
use super::text;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Gives the numbers that only a simulation knows (for `value(...)`, `print`, and run-dependent
/// arguments).
pub trait Measure {
    /// Current value of a quantity.
    fn measure(&mut self, quantity: &Quantity) -> f64;
    /// Now.
    fn now(&mut self) -> super::formula::Instant;
}

/// What a group holds, as far as group functions ask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GroupKind {
    /// Not told: anything goes.
    Any,
    /// Particles.
    Particles,
    /// Grid nodes.
    Nodes,
}

/// Names that cannot be assigned and what they stand for.
const PROTECTED: [(&str, Operation); 10] = [
    ("x", Operation::Current(0)),
    ("y", Operation::Current(1)),
    ("z", Operation::Current(2)),
    ("x0", Operation::Reference(0)),
    ("y0", Operation::Reference(1)),
    ("z0", Operation::Reference(2)),
    ("time", Operation::Time),
    ("timestep", Operation::StepNumber),
    ("dt", Operation::StepSize),
    ("PI", Operation::Constant(std::f64::consts::PI)),
];

const REFERENCE: [&str; 3] = ["x0", "y0", "z0"];

fn protected(name: &str) -> Option<Operation> {
    PROTECTED.iter().find(|(word, _)| *word == name).map(|(_, operation)| *operation)
}

/// All names of a script so far.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    variables: BTreeMap<String, Formula>,
    overrides: BTreeSet<String>,
    results: BTreeMap<String, Slot>,
    groups: BTreeMap<String, GroupKind>,
    quantities: Vec<Quantity>,
    slots: HashMap<Quantity, Slot>,
    /// The name of each slot, as formulas print it.
    names: Vec<String>,
    /// Which of x0, y0, z0 an expression has read.
    reference_read: [bool; 3],
}

impl Scope {
    /// A scope with `-var` overrides, which win over assignments of the script.
    ///
    /// # Errors
    /// A bad name or expression; the spans lie in [`Scope::command_line`].
    pub fn new(overrides: &[(String, String)]) -> Result<Self, Diagnostic> {
        let mut scope = Self::default();
        let mut start = 0;
        for (name, value) in overrides {
            let name_start = start + "-var ".len();
            let value_start = name_start + name.len() + 1;
            let value_end = value_start + value.len();
            let name = Name { text: name.clone(), span: Span::new(name_start, value_start - 1) };
            if super::token::identifier(&name.text) != name.text.len() || name.text.is_empty() {
                return Err(bad_name(&name));
            }
            let span = Span::new(value_start, value_end);
            scope.assign(&name, &Argument { span, text: value.clone(), quoted: false }, None)?;
            if scope.variables.get(&name.text).is_some_and(|formula| !formula.is_known()) {
                let message = "there is no run yet to take a value of";
                return Err(Diagnostic::error(Code::Type, span, message).label("depends on a run"));
            }
            start = value_end + 1;
        }
        scope.overrides = overrides.iter().map(|(name, _)| name.clone()).collect();
        Ok(scope)
    }

    /// Goes on with the names of an earlier script; variables of this one stay.
    ///
    /// # Errors
    /// A variable that the earlier script knows as a result, or that reads a simulation which is
    /// not there yet.
    pub fn continue_from(&mut self, mut earlier: Scope) -> Result<(), String> {
        if !self.quantities.is_empty() {
            return Err("an expression above reads a simulation that is not there yet".to_string());
        }
        for (name, formula) in std::mem::take(&mut self.variables) {
            if earlier.results.contains_key(&name) {
                return Err(format!("the variable `{name}` has the name of a result in the file"));
            }
            earlier.variables.insert(name, formula);
        }
        earlier.overrides.append(&mut self.overrides);
        *self = earlier;
        Ok(())
    }

    /// The overrides as a text to show mistakes in.
    pub fn command_line(overrides: &[(String, String)]) -> Source {
        let words: Vec<String> =
            overrides.iter().map(|(name, value)| format!("-var {name} {value}")).collect();
        Source { name: "command line".to_string(), text: words.join(" ") }
    }

    /// May a fix or compute publish this result name? `place` is the span of its ID.
    ///
    /// # Errors
    /// A variable or protected name is in the way.
    pub fn check_result(&self, name: &str, place: Span) -> Result<(), Diagnostic> {
        let what = if protected(name).is_some() {
            "a protected name"
        } else if self.variables.contains_key(name) {
            "a variable"
        } else {
            return Ok(());
        };
        Err(Diagnostic::error(
            Code::Duplicate,
            place,
            format!("the result `{name}` has the name of {what}"),
        )
        .label(format!("publishes `{name}`"))
        .help("rename one of them"))
    }

    /// Publishes a result name; the slot of an equal quantity is reused. [`Scope::check_result`]
    /// tells first whether the name is free.
    pub fn publish(&mut self, name: &str, quantity: Quantity) -> Slot {
        let slot = self.slot(quantity, || name.to_string());
        self.names[slot.0] = name.to_string();
        self.results.insert(name.to_string(), slot);
        slot
    }

    fn slot(&mut self, quantity: Quantity, name: impl FnOnce() -> String) -> Slot {
        if let Some(slot) = self.slots.get(&quantity) {
            return *slot;
        }
        let slot = Slot(self.quantities.len());
        self.quantities.push(quantity.clone());
        self.names.push(name());
        self.slots.insert(quantity, slot);
        slot
    }

    /// Withdraws every result name of a deleted fix or compute.
    pub fn withdraw(&mut self, quantities: impl Fn(&Quantity) -> bool) {
        let all = &self.quantities;
        self.results.retain(|_, slot| !quantities(&all[slot.0]));
    }

    /// Declares a group, so that group functions know it.
    pub fn declare_group(&mut self, name: &str) {
        self.declare_group_of(name, GroupKind::Any);
    }

    /// Declares a group of a kind, so that group functions refuse the wrong one.
    pub fn declare_group_of(&mut self, name: &str, kind: GroupKind) {
        self.groups.insert(name.to_string(), kind);
    }

    /// What each slot holds.
    pub fn quantities(&self) -> &[Quantity] {
        &self.quantities
    }

    pub(super) fn slot_name(&self, slot: Slot) -> String {
        self.names[slot.0].clone()
    }

    /// Performs `name = expression`. `None` as measure: rehearsal. Returns the echo line and remarks.
    ///
    /// # Errors
    /// Whatever is wrong with the expression; a protected or read-only name. The name is known
    /// afterwards all the same, so that one mistake is reported once.
    pub fn assign(
        &mut self,
        name: &Name,
        value: &Argument,
        measure: Option<&mut dyn Measure>,
    ) -> Result<(String, Vec<Diagnostic>), Diagnostic> {
        if self.overrides.contains(&name.text) {
            let note = Diagnostic::note(
                Code::CommandLine,
                name.span,
                format!("`{}` is set on the command line", name.text),
            )
            .label("this assignment is skipped");
            return Ok((self.echo(&name.text), vec![note]));
        }
        let may_assign = self.check_assignable(name);
        let formula = may_assign.and_then(|()| {
            let formula = self.compile(value, measure)?;
            self.check_value(name, value, &formula)?;
            Ok(formula)
        });
        if let Err(error) = formula {
            if error.code != Code::Protected {
                self.variables.insert(name.text.clone(), Formula::unknown());
            }
            return Err(error);
        }
        self.variables.insert(name.text.clone(), formula?);
        let remarks = match protected(&name.text) {
            Some(_) => vec![shadowed(name)],
            None => Vec::new(),
        };
        Ok((self.echo(&name.text), remarks))
    }

    fn echo(&self, name: &str) -> String {
        let text = self.variables.get(name).map_or("?", |formula| formula.text());
        format!("{name} = {text}")
    }

    fn check_assignable(&self, name: &Name) -> Result<(), Diagnostic> {
        let text = &name.text;
        if self.results.contains_key(text) {
            let message =
                format!("`{text}` is a result of a fix or compute and cannot be assigned");
            return Err(Diagnostic::error(Code::Protected, name.span, message).label("read-only"));
        }
        let reference = REFERENCE.iter().position(|word| word == text);
        match reference {
            Some(axis) if self.reference_read[axis] => {
                Err(is_protected(name)
                    .help("an earlier statement reads it as the reference position"))
            }
            None if protected(text).is_some() => Err(is_protected(name)),
            _ => Ok(()),
        }
    }

    fn check_value(
        &self,
        name: &Name,
        value: &Argument,
        formula: &Formula,
    ) -> Result<(), Diagnostic> {
        match formula.as_constant() {
            Some(constant) if !constant.is_finite() && formula.is_known() => {
                Err(Diagnostic::error(
                    Code::NotFinite,
                    value.span,
                    format!("`{}` is {}", name.text, text::number(constant)),
                )
                .label("not a finite number"))
            }
            None if protected(&name.text).is_some() => {
                Err(is_protected(name).help("only a constant may take its place, for old scripts"))
            }
            _ => Ok(()),
        }
    }

    /// The formula of a variable or result, for log_modify and plot.
    ///
    /// # Errors
    /// An unknown name, with the nearest known one.
    pub fn formula(&self, name: &Name) -> Result<Formula, Diagnostic> {
        if let Some(slot) = self.results.get(&name.text) {
            return Ok(Formula::new(vec![Operation::Slot(*slot)], &|slot| self.slot_name(slot)));
        }
        if let Some(formula) = self.variables.get(&name.text) {
            return Ok(formula.clone());
        }
        match protected(&name.text) {
            Some(operation) => Ok(Formula::new(vec![operation], &|slot| self.slot_name(slot))),
            None => Err(self.unknown(name)),
        }
    }

    fn unknown(&self, name: &Name) -> Diagnostic {
        let text = &name.text;
        let error =
            Diagnostic::error(Code::UnknownName, name.span, format!("unknown name `{text}`"))
                .label("not a variable or result");
        if let Some(function) = function::find(text) {
            return error.help(format!("a function takes arguments: `{}`", function.usage));
        }
        let known = self.variables.keys().chain(self.results.keys()).map(String::as_str);
        let known = known.chain(PROTECTED.iter().map(|(word, _)| *word));
        error.help(suggest::help(text, known, ""))
    }

    /// Compiles an expression; without a measure, numbers that depend on a run stay unknown.
    ///
    /// # Errors
    /// Mistakes of form, unknown names, parts that are never finite.
    pub fn compile(
        &mut self,
        value: &Argument,
        measure: Option<&mut dyn Measure>,
    ) -> Result<Formula, Diagnostic> {
        compile::compile(value, self, measure)
    }

    pub(super) fn resolve(&mut self, name: &str, span: Span) -> Result<Formula, Diagnostic> {
        let formula = self.formula(&Name { text: name.to_string(), span })?;
        if let Some(axis) = REFERENCE.iter().position(|word| *word == name) {
            self.reference_read[axis] = true;
        }
        Ok(formula)
    }

    pub(super) fn group_slot(
        &mut self,
        function: GroupFunction,
        group: &str,
        axis: usize,
        span: Span,
    ) -> Result<Slot, Diagnostic> {
        let kind = self.groups.get(group).copied().or((group == "all").then_some(GroupKind::Any));
        let word = function.word();
        let refused = match function {
            GroupFunction::Xcm => GroupKind::Nodes,
            GroupFunction::InternalForce | GroupFunction::ExternalForce => GroupKind::Particles,
        };
        match kind {
            None => {
                let known = self.groups.keys().map(String::as_str).chain(["all"]);
                Err(Diagnostic::error(Code::UnknownName, span, format!("unknown group `{group}`"))
                    .label("not a group")
                    .help(suggest::help(group, known, "")))
            }
            Some(kind) if kind == refused => {
                let needed = if kind == GroupKind::Nodes { "particles" } else { "nodes" };
                Err(Diagnostic::error(
                    Code::GroupKind,
                    span,
                    format!("`{word}` needs a group of {needed}"),
                )
                .label(format!("not a group of {needed}")))
            }
            Some(_) => {
                let quantity = Quantity::Group { function, group: group.to_string(), axis };
                Ok(self.slot(quantity, || {
                    format!("{word}({}, {})", quoted(group), ["x", "y", "z"][axis])
                }))
            }
        }
    }
}

fn quoted(word: &str) -> String {
    if super::token::word(word) == word.len() { word.to_string() } else { format!("\"{word}\"") }
}

fn is_protected(name: &Name) -> Diagnostic {
    Diagnostic::error(
        Code::Protected,
        name.span,
        format!("`{}` is protected and cannot be assigned", name.text),
    )
    .label("protected name")
    .help(format!("choose another name, such as `my_{}`", name.text))
}

fn shadowed(name: &Name) -> Diagnostic {
    let text = &name.text;
    Diagnostic::warning(
        Code::ProtectedConstant,
        name.span,
        format!("`{text}` no longer means the reference position in expressions below"),
    )
    .label("protected name used as a variable")
    .help(format!("choose another name, such as `start_{text}`"))
}

/// The mistake of a name that is no variable name.
pub(super) fn bad_name(name: &Name) -> Diagnostic {
    Diagnostic::error(Code::BadName, name.span, format!("`{}` is not a variable name", name.text))
        .label("not a variable name")
        .help("a variable name is a letter or `_`, then letters, digits, `_`")
}

/// The number a formula has now; `None` if only a run can tell it.
pub(super) fn current(
    formula: &Formula,
    scope: &Scope,
    measure: Option<&mut dyn Measure>,
) -> Option<f64> {
    if !formula.is_known() {
        return None;
    }
    if let Some(value) = formula.as_constant() {
        return Some(value);
    }
    let measure = measure?;
    let size = formula.slots().last().map_or(0, |slot| slot.0 + 1);
    let mut board = Board { values: vec![f64::NAN; size] };
    for slot in formula.slots() {
        board.values[slot.0] = measure.measure(&scope.quantities[slot.0]);
    }
    Some(formula.value(&board, &measure.now()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(text: &str) -> Name {
        Name { text: text.to_string(), span: Span::new(0, text.len()) }
    }

    fn set(scope: &mut Scope, variable: &str, value: &str) -> Result<String, Code> {
        let assigned = scope.assign(&name(variable), &Argument::bare(value), None);
        assigned.map(|(echo, _)| echo).map_err(|error| error.code)
    }

    fn with_result() -> Scope {
        let mut scope = Scope::default();
        scope.publish("Ek_s", Quantity::Fix { id: "Ek".to_string(), component: 3 });
        scope
    }

    #[test]
    fn protected_and_published_names_are_read_only() {
        let mut scope = with_result();
        for word in ["x", "y", "z", "time", "timestep", "dt", "PI", "Ek_s"] {
            assert_eq!(set(&mut scope, word, "1"), Err(Code::Protected), "{word}");
        }
        for word in ["E", "gamma", "phi", "exp"] {
            assert_eq!(set(&mut scope, word, "1"), Ok(format!("{word} = 1")));
        }
        assert_eq!(
            set(&mut scope, "a", "exp(exp) - E"),
            Ok(format!("a = {}", std::f64::consts::E - 1.0))
        );
    }

    #[test]
    fn reference_names_may_be_constants_if_nobody_read_them() {
        let mut scope = Scope::default();
        let (_, remarks) =
            scope.assign(&name("x0"), &Argument::bare("0.5"), None).expect("allowed");
        assert_eq!((remarks.len(), remarks[0].code), (1, Code::ProtectedConstant));
        assert_eq!(set(&mut scope, "a", "x0 + y0"), Ok("a = 0.5 + y0".to_string()));
        assert_eq!(set(&mut scope, "x0", "1"), Err(Code::Protected), "read above");
        assert_eq!(set(&mut scope, "y0", "1"), Err(Code::Protected), "read above");
        assert_eq!(set(&mut scope, "z0", "x"), Err(Code::Protected), "no constant");
        assert_eq!(set(&mut scope, "b", "z0"), Ok("b = z0".to_string()));
    }

    #[test]
    fn one_mistake_is_reported_once() {
        let mut scope = Scope::default();
        assert_eq!(set(&mut scope, "a", "b"), Err(Code::UnknownName));
        assert_eq!(set(&mut scope, "c", "2*a"), Ok("c = ?".to_string()));
    }

    #[test]
    fn unknown_names_have_suggestions() {
        let mut scope = with_result();
        assert!(set(&mut scope, "radius", "1").is_ok());
        for (text, help) in
            [("raduis", "radius"), ("EK_s", "Ek_s"), ("tme", "time"), ("sqrt", "sqrt(a)")]
        {
            let error = scope.formula(&name(text)).expect_err(text);
            assert_eq!(error.code, Code::UnknownName);
            assert!(error.help[0].contains(help), "{text}: {:?}", error.help);
        }
    }

    #[test]
    fn command_line_wins() {
        let list = [("N".to_string(), "2*20".to_string()), ("M".to_string(), "N + 1".to_string())];
        let mut scope = Scope::new(&list).expect("good");
        let (echo, remarks) =
            scope.assign(&name("N"), &Argument::bare("20"), None).expect("skipped");
        assert_eq!((echo.as_str(), remarks[0].code), ("N = 40", Code::CommandLine));
        assert_eq!(set(&mut scope, "a", "M"), Ok("a = 41".to_string()));
        for (variable, value, place, code) in [
            ("N", "1 2", "2", Code::MissingOperator),
            ("2N", "1", "2N", Code::BadName),
            ("dt", "1", "dt", Code::Protected),
            ("a", "value(time)", "value(time)", Code::Type),
        ] {
            let list = [list[0].clone(), (variable.to_string(), value.to_string())];
            let error = Scope::new(&list).expect_err(value);
            let shown = &Scope::command_line(&list).text[error.span.start..error.span.end];
            assert_eq!((error.code, shown), (code, place));
        }
    }

    #[test]
    fn groups_are_known_by_name_and_kind() {
        let mut scope = Scope::default();
        scope.declare_group_of("left", GroupKind::Nodes);
        scope.declare_group_of("work-piece", GroupKind::Particles);
        assert_eq!(
            set(&mut scope, "a", "xcm(work-piece, y)"),
            Ok("a = xcm(work-piece, y)".to_string())
        );
        assert_eq!(
            set(&mut scope, "a", "internal_force(all, x)"),
            Ok("a = internal_force(all, x)".to_string())
        );
        assert_eq!(set(&mut scope, "a", "external_force(left, x)").map(|_| ()), Ok(()));
        assert_eq!(set(&mut scope, "a", "external_force(work-piece, x)"), Err(Code::GroupKind));
        assert_eq!(set(&mut scope, "a", "xcm(left, x)"), Err(Code::GroupKind));
        assert_eq!(set(&mut scope, "a", "xcm(right, x)"), Err(Code::UnknownName));
        assert_eq!(scope.quantities().len(), 3);
    }

    #[test]
    fn results_share_slots_and_can_be_withdrawn() {
        let mut scope = with_result();
        let again = scope.publish("Ek_s", Quantity::Fix { id: "Ek".to_string(), component: 3 });
        assert_eq!((again, scope.quantities().len()), (Slot(0), 1));
        assert!(set(&mut scope, "v_x", "1").is_ok());
        assert_eq!(
            scope.check_result("v_x", Span::default()).map_err(|e| e.code),
            Err(Code::Duplicate)
        );
        assert!(scope.check_result("w_x", Span::default()).is_ok());
        scope.withdraw(|quantity| matches!(quantity, Quantity::Fix { id, .. } if id == "Ek"));
        assert_eq!(set(&mut scope, "a", "Ek_s"), Err(Code::UnknownName));
    }
}
