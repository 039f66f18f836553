//! `karamelo-rs styles`: the registry as a manual.

use crate::command::COMMANDS;
use crate::compute::COMPUTES;
use crate::damage::DAMAGE;
use crate::eos::EOS;
use crate::fix::{FIXES, acts_on_solids};
use crate::material::MATERIALS;
use crate::method::METHODS;
use crate::output::DUMPS;
use crate::region::REGIONS;
use crate::scheme::SCHEMES;
use crate::script::suggest;
use crate::shape::SHAPES;
use crate::shape::corners::DOMAINS;
use crate::strength::STRENGTH;
use crate::style::Style;
use crate::temperature::TEMPERATURE;
use crate::transfer::TRANSFERS;
use std::fmt::Write;

/// What the manual says of a style.
pub struct Entry {
    /// The word in the script.
    pub name: &'static str,
    usage: &'static str,
    /// One sentence.
    pub summary: &'static str,
    /// Equation as coded, units, source.
    pub manual: &'static str,
    /// Can it be used, or is the name reserved?
    pub available: bool,
}

fn entries<B>(table: &'static [Style<B>]) -> Vec<Entry> {
    let entry = |style: &'static Style<B>| Entry {
        name: style.name,
        usage: style.usage,
        summary: style.summary,
        manual: style.manual,
        available: style.build.is_some(),
    };
    table.iter().map(entry).collect()
}

/// The families, in the order of the manual.
pub const FAMILIES: [&str; 15] = [
    "command",
    "method",
    "transfer",
    "shape",
    "domain",
    "scheme",
    "region",
    "material",
    "eos",
    "strength",
    "damage",
    "temperature",
    "fix",
    "compute",
    "dump",
];

/// The styles of a family; `None` if there is no such family.
pub fn family(name: &str) -> Option<Vec<Entry>> {
    Some(match name {
        "command" => entries(COMMANDS),
        "method" => entries(METHODS),
        "transfer" => entries(TRANSFERS),
        "shape" => entries(SHAPES),
        "domain" => entries(DOMAINS),
        "scheme" => entries(SCHEMES),
        "region" => entries(REGIONS),
        "material" => entries(MATERIALS),
        "eos" => entries(EOS),
        "strength" => entries(STRENGTH),
        "damage" => entries(DAMAGE),
        "temperature" => entries(TEMPERATURE),
        "fix" => entries(FIXES),
        "compute" => entries(COMPUTES),
        "dump" => entries(DUMPS),
        _ => return None,
    })
}

/// How a style of a family is written in a script.
pub fn written(family: &str, entry: &Entry) -> String {
    let before = match family {
        "command" => return format!("{}({})", entry.name, entry.usage),
        "method" => format!("method({}", entry.name),
        "transfer" => {
            let terms = if entry.name == "XPIC" { ", m" } else { "" };
            let blend = if entry.usage.contains("alpha") {
                format!(", {}", entry.usage)
            } else {
                String::new()
            };
            return format!("method(type, {}{terms}, shape{blend})", entry.name);
        }
        "shape" => return format!("method(type, sub, {})", entry.name),
        "scheme" => return format!("scheme({})", entry.name),
        "fix" if acts_on_solids(entry.name) => format!("fix(ID, {}", entry.name),
        "fix" | "compute" => format!("{family}(ID, {}, group", entry.name),
        "dump" => format!("dump(ID, group, {}, N, file", entry.name),
        _ => format!("{family}(ID, {}", entry.name),
    };
    match entry.usage {
        "" => format!("{before})"),
        usage => format!("{before}, {usage})"),
    }
}

/// Everything, a family, or one style.
///
/// # Errors
/// There is no such family or style; the nearest one is named.
pub fn text(family_name: Option<&str>, name: Option<&str>) -> Result<String, String> {
    let Some(family_name) = family_name else {
        let mut text = String::new();
        for family_name in FAMILIES {
            let _ = writeln!(text, "{}", list(family_name)?);
        }
        return Ok(text);
    };
    match name {
        None => list(family_name),
        Some(name) => describe(family_name, name),
    }
}

fn known(family_name: &str) -> Result<Vec<Entry>, String> {
    family(family_name).ok_or_else(|| {
        let otherwise = format!("families: {}", FAMILIES.join(", "));
        let help = suggest::help(family_name, FAMILIES.into_iter(), &otherwise);
        format!("there is no family `{family_name}`: {help}")
    })
}

fn list(family_name: &str) -> Result<String, String> {
    let mut text = format!("{family_name}\n");
    for entry in known(family_name)? {
        let note = if entry.available { "" } else { " (not available yet)" };
        let _ = writeln!(text, "  {:<30} {}{note}", entry.name, entry.summary);
    }
    Ok(text)
}

fn describe(family_name: &str, name: &str) -> Result<String, String> {
    let all = known(family_name)?;
    let Some(entry) = all.iter().find(|entry| entry.name == name) else {
        let help = suggest::help(name, all.iter().map(|entry| entry.name), "");
        return Err(format!("there is no {family_name} style `{name}`: {help}"));
    };
    let mut text = format!("{}\n\n{}\n", written(family_name, entry), entry.summary);
    if !entry.available {
        text.push_str("Known, but not available yet.\n");
    }
    if !entry.manual.is_empty() {
        let _ = writeln!(text, "\n{}", entry.manual);
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_style_can_be_described() {
        for family_name in FAMILIES {
            for entry in family(family_name).unwrap() {
                let text = describe(family_name, entry.name).unwrap();
                assert!(text.contains(entry.summary), "{}", entry.name);
                assert!(!entry.summary.is_empty(), "{}", entry.name);
            }
        }
    }

    #[test]
    fn a_misspelled_style_is_answered_with_the_nearest_one() {
        let message = text(Some("material"), Some("neohookean")).unwrap_err();
        assert!(message.contains("neo-hookean"), "{message}");
    }
}
