//! `contact` and `delete_contact`: bodies with velocities of their own on the grid.

use super::hook::two_solids;
use super::scene::Scene;
use super::{Action, action};
use crate::model::contact::{Contact, Rule};
use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::formula::Quantity;

/// The manual of `contact`.
pub const MANUAL: &str = "\
For `ulmpm`. A solid that a contact names has masses, velocities and forces of its own at the nodes;
all others share theirs. Where two bodies have mass at a node they exchange momentum, after P2G (on
v), after the update (on v*), and after the second mapping (on the velocities that strains follow
from). With m12 = m1 m2/(m1 + m2) and v12 = v1 - v2 at the node:
  normal       n = (g1 - g2)/|g1 - g2| out of s1, g = sum m grad N (round an axis m/r), or n = g1/|g1|
               or -g2/|g2| if the bodies lie farther apart along it, as at corners
  approaching  v12.n > gap/dt; otherwise nothing happens
  slip         s2 gets the impulse J = m12 (v12.n - gap/dt) n from s1
  frictional   and min(mu |J|, m12 |v_t|) against the slip v_t = v12 - (v12.n) n, mu >= 0
  stick        J = m12 (v12 - gap/dt n): one velocity until the bodies part
The gap is the distance along n, at least 0, between the outermost particles around the node, each with
the radius R = V^(1/d)/2, and less far by d^2/(2 h) if it lies d + R beside the node. With `on_nodes`
the gap is 0 and n is along g1 - g2, as in the literature: bodies then meet as soon as they share
nodes, up to a cell apart (splines: two), and corners catch on deformable faces.
Momentum is conserved at every node. `all` means every two solids; a contact of two solids stands
before it. Two bodies that no contact names together move with one velocity at the nodes they share,
as on one grid. Where more than two meet, pairs act one after the other in order of definition.
A rigid body counts as infinitely heavy; in place of g1 - g2 its own surface makes the normal. It keeps its velocity
and gets the force (`velocity_particles` on it publishes that).
Fixes on nodes act on the nodes of every body; a group of nodes with `solid, s1` only on those that
s1 has (together with all solids that no contact names, if s1 is one of them).
A dump of the grid has a row for each node of each field, one after the other.
Publishes the force on s1 (`all`: on the first solid) in ID_x, ID_y, ID_z and the heat of friction so
far in ID_s, that of the last step not yet included; with `thermo-mechanical` half of it heats each body. May change between runs.
Which contact for what: this one needs no search for pairs and rubs as Coulomb says on rigid bodies,
within 1 %; between two deformable bodies friction comes out too large, by a tenth for a block on a
floor. `fix contact/hertz` and `contact/minimize_penetration` act between particles, which
makes faces bumpy: their friction is larger than mu, but they work in `tlmpm`.
Source: Bardenhagen, Brackbill, Sulsky 2000; Bardenhagen et al. 2001; on gaps and corners Nairn 2013.";

/// A contact as declared.
pub struct ContactEntry {
    /// Numbers of its two solids; `None`: every two.
    pub solids: Option<[usize; 2]>,
}

/// `contact(ID, stick|slip|frictional, s1, s2|all [, mu] [, on_nodes])`
pub fn contact(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    if scene.method.is_some_and(|choice| choice.method.total) {
        let message = "`contact` needs `ulmpm`: in total Lagrangian methods bodies share no nodes";
        return Err(Diagnostic::error(Code::NotCombined, args.command.span, message)
            .label("not with this method")
            .help("`fix(ID, contact/minimize_penetration, s1, s2, mu)` acts between particles"));
    }
    let id = args.word("a contact ID")?;
    refuse_names_of_others(scene, &id)?;
    let words = ["stick", "slip", "frictional"];
    let chosen = args.choice("a contact style", &words)?;
    let solids = bodies(args, scene)?;
    let rule = match chosen {
        0 => Rule::Stick,
        1 => Rule::Slip,
        _ => {
            let mu = args.within("the coefficient of friction mu", 0.0, f64::INFINITY)?;
            Rule::Frictional(mu.value)
        }
    };
    let touching = !args.keyword("on_nodes");
    scene.contacts.declare(&id, ContactEntry { solids })?;
    for (component, suffix) in ["x", "y", "z", "s"].into_iter().enumerate() {
        let name = format!("{}_{suffix}", id.text);
        args.scope.check_result(&name, id.span)?;
        args.scope.publish(&name, Quantity::Contact { id: id.text.clone(), component });
    }
    let (force, heat) = Default::default();
    let contact = Contact { name: id.text, rule, solids, touching, force, heat };
    Ok(action(move |session| session.simulation.add_contact(contact)))
}

/// A fix or compute of the same ID would publish results of the same names.
fn refuse_names_of_others(scene: &Scene, id: &Name) -> Result<(), Diagnostic> {
    let kind = match (scene.fixes.position(&id.text), scene.computes.position(&id.text)) {
        (Some(_), _) => "fix",
        (_, Some(_)) => "compute",
        _ => return Ok(()),
    };
    let message = format!("the {kind} `{}` publishes results of the same names", id.text);
    Err(Diagnostic::error(Code::Duplicate, id.span, message).label("taken above"))
}

/// Reads `s1, s2` or `all`; nothing may bind the same two before.
fn bodies(args: &mut Args<'_>, scene: &Scene) -> Result<Option<[usize; 2]>, Diagnostic> {
    let span = args.next_span();
    let solids = if args.keyword("all") {
        if scene.solids.iter().count() < 2 {
            let message = "contact needs two solids above it";
            return Err(Diagnostic::error(Code::Missing, span, message).label("too few solids"));
        }
        None
    } else {
        let (solids, second) = two_solids(args, scene)?;
        let rigid = |solid: &usize| scene.solids.iter().nth(*solid).is_some_and(|(_, s)| s.rigid);
        if solids.iter().all(rigid) {
            let message = "contact of two rigid solids has no effect";
            args.remarks.push(
                Diagnostic::warning(Code::NoEffect, second.span, message)
                    .label("rigid bodies keep their velocities"),
            );
        }
        Some(solids)
    };
    let same = |known: &Option<[usize; 2]>| match (known, solids) {
        (Some([a, b]), Some(pair)) => [*a, *b] == pair || [*b, *a] == pair,
        (None, None) => true,
        _ => false,
    };
    match scene.contacts.iter().find(|(_, known)| same(&known.solids)) {
        Some((name, _)) => {
            let message = format!("the contact `{name}` acts between these bodies already");
            Err(Diagnostic::error(Code::Duplicate, span, message)
                .label("bound above")
                .help(format!("`delete_contact({name})` ends it")))
        }
        None => Ok(solids),
    }
}

/// `delete_contact(ID)`
pub fn delete_contact(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let id = args.word("a contact ID")?;
    scene.contacts.remove(&id)?;
    let name = id.text.clone();
    args.scope.withdraw(|quantity| matches!(quantity, Quantity::Contact { id, .. } if *id == name));
    Ok(action(move |session| session.simulation.delete_contact(&id.text)))
}
