//! `eos`, `strength`, `damage`, `temperature`, `material`.

use super::scene::{Names, Scene};
use super::{Action, action};
use crate::damage::DAMAGE;
use crate::eos::EOS;
use crate::material::{Families, Family, MATERIALS};
use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::strength::STRENGTH;
use crate::style::{self, Style};
use crate::temperature::TEMPERATURE;

/// Builds an object of a family from its arguments.
type Build<T> = fn(&mut Args<'_>) -> Result<T, Diagnostic>;

/// `family(ID, style, ...)`
fn declare<T>(
    family: &str,
    table: &'static [Style<Build<T>>],
    names: &mut Names<T>,
    args: &mut Args<'_>,
) -> Result<Action, Diagnostic> {
    let id = args.word(&format!("a {family} ID"))?;
    names.check_free(&id)?;
    let word = args.word(&format!("a {family} style"))?;
    let (row, build) = style::find(family, table, &word)?;
    args.expect_usage(row.usage);
    let object = build(args)?;
    names.declare(&id, object)?;
    Ok(action(|_| ()))
}

/// `eos(ID, style, ...)`
pub fn eos(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    declare("eos", EOS, &mut scene.eos, args)
}

/// `strength(ID, style, ...)`
pub fn strength(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    declare("strength", STRENGTH, &mut scene.strengths, args)
}

/// `damage(ID, style, ...)`
pub fn damage(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    declare("damage", DAMAGE, &mut scene.damages, args)
}

/// `temperature(ID, style, ...)`
pub fn temperature(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    declare("temperature", TEMPERATURE, &mut scene.temperatures, args)
}

/// `material(ID, style, ...)` and its old form `material(ID, eosID, strengthID [, damageID])`.
pub fn material(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let id = args.word("a material ID")?;
    scene.materials.check_free(&id)?;
    let mut style_name = None;
    if let Some(second) = args.peek() {
        let known = MATERIALS.iter().any(|style| style.name == second);
        if !known && scene.eos.position(second).is_some() {
            let given: Vec<&str> = (0..).map_while(|ahead| args.peek_at(ahead)).collect();
            let modern = format!("material({}, eos-strength, {})", id.text, given.join(", "));
            args.old_form(&modern);
            style_name = Some(Name { text: "eos-strength".to_string(), span: args.next_span() });
        }
    }
    let word = match style_name {
        Some(word) => word,
        None => args.word("a material style")?,
    };
    let (row, build) = style::find("material", MATERIALS, &word)?;
    args.expect_usage(row.usage);
    let law = build(
        args,
        &Families {
            eos: &|name| scene.eos.find(name).cloned_or(scene, name, "an eos"),
            strength: &|name| scene.strengths.find(name).cloned_or(scene, name, "a strength"),
            either: &|name| either(scene, name),
        },
    )?;
    scene.materials.declare(&id, law)?;
    Ok(action(|_| ()))
}

/// A damage or a temperature law.
fn either(scene: &Scene, name: &Name) -> Result<Family, Diagnostic> {
    let [damage, temperature] =
        [scene.damages.position(&name.text), scene.temperatures.position(&name.text)];
    if damage.is_some() && temperature.is_some() {
        let message = format!("`{}` is both a damage and a temperature ID", name.text);
        return Err(
            Diagnostic::error(Code::UnknownName, name.span, message).label("rename one of them")
        );
    }
    if temperature.is_some() {
        return scene.temperatures.find(name).map(|(_, law)| Family::Temperature(law.clone()));
    }
    let found = scene.damages.find(name).cloned_or(scene, name, "a damage or a temperature");
    found.map(Family::Damage)
}

/// An object that was looked for.
trait Found<T> {
    /// Its copy, or the mistake; an ID of another family is called by its name.
    fn cloned_or(self, scene: &Scene, name: &Name, wanted: &str) -> Result<T, Diagnostic>;
}

impl<T: Clone> Found<T> for Result<(usize, &T), Diagnostic> {
    fn cloned_or(self, scene: &Scene, name: &Name, wanted: &str) -> Result<T, Diagnostic> {
        self.map(|(_, object)| object.clone()).map_err(|unknown| {
            let of = [
                ("an eos", scene.eos.position(&name.text)),
                ("a strength", scene.strengths.position(&name.text)),
                ("a damage", scene.damages.position(&name.text)),
                ("a temperature", scene.temperatures.position(&name.text)),
                ("a material", scene.materials.position(&name.text)),
            ];
            let Some((family, _)) = of.into_iter().find(|(_, place)| place.is_some()) else {
                return unknown;
            };
            let message = format!("`{}` is {family} ID, not {wanted} ID", name.text);
            Diagnostic::error(Code::UnknownName, name.span, message)
                .label(format!("expected {wanted} ID"))
        })
    }
}
