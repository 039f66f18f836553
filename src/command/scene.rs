//! What the statements read so far have declared.

use super::contact::ContactEntry;
use super::files;
use super::method::Choice;
use crate::damage::Damage;
use crate::eos::Eos;
use crate::fix::GroupKind;
use crate::material::Law;
use crate::model::domain::Domain;
use crate::model::group::GroupId;
use crate::region::Region;
use crate::scheme::SchemeKind;
use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::suggest;
use crate::simulation::fill::Filling;
use crate::strength::Strength;
use crate::temperature::Temperature;
use std::cell::RefCell;
use std::path::PathBuf;
use std::sync::Arc;

/// Objects of one kind, by ID: each kind has its own name space.
pub struct Names<T> {
    kind: &'static str,
    list: Vec<(String, T)>,
}

impl<T> Names<T> {
    fn new(kind: &'static str) -> Self {
        Self { kind, list: Vec::new() }
    }

    /// Declares an object.
    ///
    /// # Errors
    /// The ID is taken.
    pub fn declare(&mut self, name: &Name, object: T) -> Result<usize, Diagnostic> {
        self.check_free(name)?;
        self.list.push((name.text.clone(), object));
        Ok(self.list.len() - 1)
    }

    /// Refuses an ID that is taken.
    ///
    /// # Errors
    /// The ID is taken.
    pub fn check_free(&self, name: &Name) -> Result<(), Diagnostic> {
        if self.position(&name.text).is_none() {
            return Ok(());
        }
        let message = format!("the {} ID `{}` is used twice", self.kind, name.text);
        Err(Diagnostic::error(Code::Duplicate, name.span, message).label("taken above"))
    }

    /// Place of an object in the order of definition.
    pub fn position(&self, name: &str) -> Option<usize> {
        self.list.iter().position(|(known, _)| known == name)
    }

    /// Finds an object.
    ///
    /// # Errors
    /// There is none of that ID; the nearest one is proposed.
    pub fn find(&self, name: &Name) -> Result<(usize, &T), Diagnostic> {
        match self.position(&name.text) {
            Some(place) => Ok((place, &self.list[place].1)),
            None => {
                let message = format!("there is no {} `{}`", self.kind, name.text);
                let known = self.list.iter().map(|(known, _)| known.as_str());
                let otherwise = match self.list.is_empty() {
                    true => format!("no {} is defined above", self.kind),
                    false => String::new(),
                };
                Err(Diagnostic::error(Code::UnknownName, name.span, message)
                    .label(format!("not a {} ID", self.kind))
                    .help(suggest::help(&name.text, known, &otherwise)))
            }
        }
    }

    /// Removes an object.
    ///
    /// # Errors
    /// There is none of that ID.
    pub fn remove(&mut self, name: &Name) -> Result<T, Diagnostic> {
        let (place, _) = self.find(name)?;
        Ok(self.list.remove(place).1)
    }

    /// Adds an object, or replaces the one of that ID.
    pub fn set(&mut self, name: &str, object: T) {
        match self.position(name) {
            Some(place) => self.list[place].1 = object,
            None => self.list.push((name.to_string(), object)),
        }
    }

    /// All objects in the order of definition.
    pub fn iter(&self) -> impl Iterator<Item = &(String, T)> {
        self.list.iter()
    }

    /// Is nothing declared?
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }
}

/// A solid as declared.
pub struct SolidEntry {
    /// What its particles come from.
    pub filling: Filling,
    /// The cells its particles were put in.
    pub cells: Domain,
    /// It keeps its shape and gives no time step.
    pub rigid: bool,
}

/// A group as declared.
#[derive(Clone, Copy)]
pub struct GroupEntry {
    /// Its index.
    pub id: GroupId,
    /// What it holds.
    pub kind: GroupKind,
}

/// A fix, compute or dump as declared.
pub struct Declared {
    /// Runs above the declaration.
    pub runs: usize,
}

/// All declarations so far.
pub struct Scene {
    /// Where the script lies.
    pub folder: PathBuf,
    /// What `method` chose, or the default from the first solid on.
    pub method: Option<Choice>,
    /// What `scheme` chose.
    pub scheme: SchemeKind,
    /// Box and cells.
    pub domain: Option<Domain>,
    /// x is a radius.
    pub axisymmetric: bool,
    /// The box is that around the solids (old scripts, total Lagrangian).
    pub box_follows_solids: bool,
    /// Regions.
    pub regions: Names<Arc<dyn Region>>,
    /// Equations of state.
    pub eos: Names<Arc<dyn Eos>>,
    /// Strength laws.
    pub strengths: Names<Arc<dyn Strength>>,
    /// Damage laws.
    pub damages: Names<Arc<dyn Damage>>,
    /// Temperature laws.
    pub temperatures: Names<Arc<dyn Temperature>>,
    /// Materials.
    pub materials: Names<Arc<dyn Law>>,
    /// Solids.
    pub solids: Names<SolidEntry>,
    /// Groups; the first is `all`.
    pub groups: Names<GroupEntry>,
    /// Contacts.
    pub contacts: Names<ContactEntry>,
    /// Fixes.
    pub fixes: Names<Declared>,
    /// Computes.
    pub computes: Names<Declared>,
    /// Dumps.
    pub dumps: Names<Declared>,
    /// Plots.
    pub plots: Names<Declared>,
    /// `set_dt` has given the time step.
    pub fixed_dt: bool,
    /// F-bar is on.
    pub averaged_dilation: bool,
    /// Number of runs so far.
    pub runs: usize,
    /// Commands a run needs that have been tried, well or not.
    pub tried: Vec<&'static str>,
    /// Number of calls so far, this one among them.
    pub calls: usize,
    /// Names and CRC-32 of the files read so far.
    pub files: RefCell<Vec<(String, u32)>>,
}

impl Default for Scene {
    fn default() -> Self {
        let mut groups = Names::new("group");
        groups.set("all", GroupEntry { id: GroupId::ALL, kind: GroupKind::All });
        Self {
            folder: PathBuf::new(),
            method: None,
            scheme: SchemeKind::Musl,
            domain: None,
            axisymmetric: false,
            box_follows_solids: false,
            regions: Names::new("region"),
            eos: Names::new("eos"),
            strengths: Names::new("strength"),
            damages: Names::new("damage"),
            temperatures: Names::new("temperature"),
            materials: Names::new("material"),
            solids: Names::new("solid"),
            groups,
            contacts: Names::new("contact"),
            fixes: Names::new("fix"),
            computes: Names::new("compute"),
            dumps: Names::new("dump"),
            plots: Names::new("plot"),
            fixed_dt: false,
            averaged_dilation: false,
            runs: 0,
            tried: Vec::new(),
            calls: 0,
            files: RefCell::default(),
        }
    }
}

/// A mistake that only follows from one reported above: it has no message and is not shown.
fn reported_above(at: &Name) -> Diagnostic {
    Diagnostic::error(Code::Order, at.span, "")
}

impl Scene {
    /// The bytes of a file that a statement names.
    ///
    /// # Errors
    /// It cannot be read.
    pub fn read_file(&self, name: &Name) -> Result<Vec<u8>, Diagnostic> {
        let bytes = files::read(name, &self.folder)?;
        self.files.borrow_mut().push((name.text.clone(), crc32fast::hash(&bytes)));
        Ok(bytes)
    }

    /// The box, which `dimension` must have given above.
    ///
    /// # Errors
    /// There is none yet.
    pub fn need_domain(&self, at: &Name) -> Result<Domain, Diagnostic> {
        self.domain.ok_or_else(|| match self.tried.contains(&"dimension") {
            true => reported_above(at),
            false => Diagnostic::error(
                Code::Order,
                at.span,
                format!("`{}` needs `dimension(...)` above it", at.text),
            )
            .label("too early"),
        })
    }

    /// Is the method known to be `thermo-mechanical`?
    pub fn conducts_heat(&self) -> bool {
        self.method.is_some_and(|choice| choice.method.conducts_heat)
    }

    /// The method, or the default of old scripts with a warning.
    pub fn need_method(&mut self, args: &mut Args<'_>) -> Choice {
        *self.method.get_or_insert_with(|| {
            let message = "no `method` stands above: the default is taken";
            args.remarks.push(
                Diagnostic::warning(Code::Compatibility, args.command.span, message)
                    .label("total Lagrangian, FLIP, linear")
                    .help("the modern line is `method(tlmpm, FLIP, linear, 0.99)`"),
            );
            Choice::default()
        })
    }

    /// Refuses a command below the first run.
    ///
    /// # Errors
    /// There is a run above.
    pub fn before_runs(&self, at: &Name) -> Result<(), Diagnostic> {
        if self.runs == 0 {
            return Ok(());
        }
        let message = format!("`{}` stands below a run", at.text);
        Err(Diagnostic::error(Code::Order, at.span, message)
            .label("too late: put it above the first run"))
    }

    /// Declares a fix, or one that replaces the fix of that ID if a run lies between.
    ///
    /// # Errors
    /// The ID is taken and its fix has never acted.
    pub fn replace(
        names: &mut Names<Declared>,
        name: &Name,
        runs: usize,
    ) -> Result<(), Diagnostic> {
        if names.find(name).is_ok_and(|(_, known)| known.runs == runs) {
            let message = format!(
                "the {} ID `{}` is used twice without a run between",
                names.kind, name.text
            );
            return Err(Diagnostic::error(Code::Duplicate, name.span, message)
                .label("the one above would never act"));
        }
        names.set(&name.text, Declared { runs });
        Ok(())
    }
}
