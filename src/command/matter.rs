//! `region` and `group`.

use super::scene::{GroupEntry, Scene};
use super::{Action, action};
use crate::fix::GroupKind;
use crate::model::group::GroupId;
use crate::region::{REGIONS, RegionContext};
use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::scope;
use crate::style;

/// `region(ID, style, ...)`
pub fn region(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let id = args.word("a region ID")?;
    scene.regions.check_free(&id)?;
    let dimension = scene.need_domain(args.command)?.dimension;
    let word = args.word("a region style")?;
    let (row, build) = style::find("region", REGIONS, &word)?;
    args.expect_usage(row.usage);
    let regions = &scene.regions;
    let find = |name: &Name| regions.find(name).map(|(_, region)| region.clone());
    let read = |name: &Name| scene.read_file(name);
    let region = build(args, &RegionContext { dimension, find: &find, read: &read })?;
    scene.regions.declare(&id, region)?;
    Ok(action(|_| ()))
}

/// `group(ID, particles|nodes, region, regionID [, all | solid, s1, ...])`
pub fn group(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let id = args.word("a group ID")?;
    if id.text == "all" {
        return Err(Diagnostic::error(Code::Duplicate, id.span, "the group `all` is predefined")
            .label("choose another ID"));
    }
    let domain = scene.need_domain(args.command)?;
    let kinds = [GroupKind::Particles, GroupKind::Nodes];
    let kind = kinds[args.choice("kind of members", &["particles", "nodes"])?];
    args.choice("way to choose members", &["region"])?;
    if kind == GroupKind::Nodes && domain.cell.is_nan() {
        let message = "a group of nodes needs the cell size, which the first solid brings";
        return Err(Diagnostic::error(Code::Order, args.command.span, message)
            .label("too early: give h in `dimension`"));
    }
    let region_name = args.word("a region ID")?;
    let region = scene.regions.find(&region_name)?.1.clone();
    let solids = listed_solids(args, scene)?;
    match scene.groups.find(&id) {
        Ok((_, known)) if known.kind != kind => {
            let message = format!("the group `{}` holds members of another kind", id.text);
            return Err(Diagnostic::error(Code::GroupKind, id.span, message)
                .label("a repeated `group` adds members of the same kind"));
        }
        Ok(_) => {}
        Err(_) => {
            let none = scene.solids.is_empty() && !scene.tried.contains(&"solid");
            if kind == GroupKind::Particles && none {
                let message = "a group of particles needs its solids above it";
                return Err(Diagnostic::error(Code::Order, args.command.span, message)
                    .label("too early: there is no solid yet"));
            }
            let entry = GroupEntry { id: GroupId(scene.groups.iter().count()), kind };
            scene.groups.set(&id.text, entry);
            let held = match kind {
                GroupKind::Nodes => scope::GroupKind::Nodes,
                _ => scope::GroupKind::Particles,
            };
            args.scope.declare_group_of(&id.text, held);
        }
    }
    let empty = Diagnostic::warning(
        Code::EmptyGroup,
        region_name.span,
        format!("the group `{}` has no members", id.text),
    )
    .label("nothing inside");
    Ok(action(move |session| {
        let simulation = &mut session.simulation;
        let any = match kind {
            GroupKind::Nodes => simulation.add_node_group(&id.text, region, solids.as_deref()),
            _ => simulation.add_particle_group(&id.text, region.as_ref(), solids.as_deref()) > 0,
        };
        if !any {
            session.warnings.push(empty);
        }
    }))
}

/// Reads `[all | solid, s1, ...]`: the numbers of the solids, `None` for all.
fn listed_solids(args: &mut Args<'_>, scene: &Scene) -> Result<Option<Vec<usize>>, Diagnostic> {
    if args.remaining() == 0 || args.keyword("all") {
        return Ok(None);
    }
    args.choice("choice of solids", &["solid", "all"])?;
    let mut solids = Vec::new();
    loop {
        let name = args.word("a solid ID")?;
        if name.text == "all" && args.remaining() == 0 {
            return Ok(None);
        }
        solids.push(scene.solids.find(&name)?.0);
        if args.remaining() == 0 {
            return Ok(Some(solids));
        }
    }
}
