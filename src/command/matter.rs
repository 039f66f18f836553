//! `region`, `solid`, `group`.

use super::domain::check_cells;
use super::method::check_nodes;
use super::scene::{GroupEntry, Scene, SolidEntry};
use super::session::Stop;
use super::{Action, action};
use crate::fix::GroupKind;
use crate::memory;
use crate::model::domain::Domain;
use crate::model::group::GroupId;
use crate::region::{REGIONS, Region, RegionContext};
use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::scope;
use crate::simulation::fill;
use crate::style;
use std::ops::ControlFlow;

/// So many solids above are searched for an overlap.
const MOST_OVERLAPS: usize = 100;

/// Cell sizes of solid and grid may differ by this part of them.
const SAME_CELL: f64 = 1e-9;

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
    let region = build(args, &RegionContext { dimension, find: &find })?;
    scene.regions.declare(&id, region)?;
    Ok(action(|_| ()))
}

/// `solid(ID, region, regionID, ppc, matID, h [, T0])` and its old forms.
pub fn solid(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    scene.tried.push("solid");
    let id = args.word("a solid ID")?;
    scene.solids.check_free(&id)?;
    let mut domain = scene.need_domain(args.command)?;
    let default_method = scene.method.is_none();
    let choice = scene.need_method(args);
    form_of_solid(args, &id)?;
    let region_name = args.word("a region ID")?;
    let region = scene.regions.find(&region_name)?.1.clone();
    let count_span = args.next_span();
    let particles_per_cell = args.count("the number of particles per cell and axis", 1)? as usize;
    let material = args.word("a material ID")?;
    let law = scene.materials.find(&material)?.1.clone();
    let cell = args.positive("the cell size h")?;
    let brings_cell = domain.cell.is_nan();
    if brings_cell {
        domain.cell = cell.value;
        check_cells(&domain, cell.span)?;
        scene.domain = Some(domain);
    }
    let total = choice.method.total;
    if !total && cell.known && (cell.value - domain.cell).abs() > SAME_CELL * domain.cell {
        return Err(args.out_of_range(
            &cell,
            &format!("the cell size of the solid must be that of the grid, {}", domain.cell),
        ));
    }
    let temperature = match args.remaining() {
        0 => None,
        _ => Some(args.number("the initial temperature T0")?.value),
    };
    if total {
        let bounds = region.bounds();
        domain = domain.of_limits(bounds.lower, bounds.upper, cell.value);
        check_bounded(&domain, &region_name)?;
        check_cells(&domain, cell.span)?;
    }
    check_nodes(&domain, choice.method.shape, cell.span)?;
    if scene.box_follows_solids {
        follow_solid(args, scene, &domain, total)?;
    }
    check_size(&domain, region.as_ref(), particles_per_cell, args, count_span)?;
    if args.rehearsal() {
        let entry = SolidEntry { region: region.clone(), particles_per_cell, cells: domain };
        check_solid(args, scene, &id, &region_name, &entry, total)?;
    }
    let cells = domain;
    let entry = SolidEntry { region: region.clone(), particles_per_cell, cells };
    scene.solids.declare(&id, entry)?;
    let (domain, follows) = (scene.need_domain(args.command)?, scene.box_follows_solids);
    Ok(action(move |session| {
        let simulation = &mut session.simulation;
        if brings_cell {
            simulation.set_domain(domain);
        }
        if follows {
            simulation.world.domain = domain;
        }
        if default_method {
            simulation.set_method(choice.method);
            simulation.transfer = choice.transfer;
        }
        let (name, material, region) = (&id.text, &material.text, region.as_ref());
        simulation.add_solid_of_cell(name, material, law, region, particles_per_cell, cells.cell);
        if let Some(temperature) = temperature {
            simulation.heat_last_solid(temperature);
        }
    }))
}

/// Reads the word that says what the solid is made from.
fn form_of_solid(args: &mut Args<'_>, id: &Name) -> Result<(), Diagnostic> {
    let word = args.peek().map(str::to_string);
    let modern = |region: &str| format!("solid({}, region, {region}, ppc, matID, h)", id.text);
    match word.as_deref() {
        Some("region") => {
            args.keyword("region");
        }
        Some("mesh" | "file") => {
            let message = "solids from files are known, but not available yet";
            return Err(Diagnostic::error(Code::NotAvailable, args.next_span(), message)
                .label("not available yet"));
        }
        Some(old @ ("rectangle" | "cylinder" | "block")) if args.remaining() > 4 => {
            args.keyword(old);
            let region = args.peek().unwrap_or("regionID").to_string();
            args.old_form(&modern(&region));
        }
        Some(region) if args.remaining() > 3 => {
            let line = modern(region);
            args.old_form(&line);
        }
        _ => {}
    }
    Ok(())
}

/// Lets the box grow around a solid, as old scripts without a box expect.
fn follow_solid(
    args: &Args<'_>,
    scene: &mut Scene,
    cells: &Domain,
    total: bool,
) -> Result<(), Diagnostic> {
    if !total {
        let message = "`ulmpm` needs the box and cell size in `dimension`";
        return Err(Diagnostic::error(Code::Missing, args.command.span, message)
            .label("only total Lagrangian solids bring a grid of their own")
            .help("the modern line is `dimension(d, xlo, xhi, ..., h)`"));
    }
    scene.domain = scene.domain.map(|domain| domain.around(cells));
    Ok(())
}

/// Refuses a region without bounds.
fn check_bounded(cells: &Domain, region: &Name) -> Result<(), Diagnostic> {
    let bounded = (0..cells.dimension)
        .all(|axis| cells.lower[axis].is_finite() && cells.upper[axis].is_finite());
    if bounded {
        return Ok(());
    }
    let message = "in total Lagrangian methods the region of a solid must be bounded";
    Err(Diagnostic::error(Code::Range, region.span, message)
        .label("reaches to infinity")
        .help("the solid's own grid spans the limits of its region"))
}

/// Refuses more particles than memory can hold, before any is made.
fn check_size(
    domain: &Domain,
    region: &dyn Region,
    particles_per_cell: usize,
    args: &Args<'_>,
    span: crate::script::source::Span,
) -> Result<(), Diagnostic> {
    const BYTES_EACH: f64 = 300.0;
    let bounds = region.bounds();
    let volume: f64 = (0..domain.dimension)
        .map(|axis| {
            let low = bounds.lower[axis].max(domain.lower[axis]);
            let high = bounds.upper[axis].min(domain.upper[axis]);
            (high - low).max(0.0) / domain.cell * particles_per_cell as f64
        })
        .product();
    // A region fills at least about half of its bounds, unless it was cut from a larger one.
    let bytes = 0.5 * volume * BYTES_EACH;
    if bytes <= memory::available() && volume < 2.0 * f64::from(u32::MAX) {
        return Ok(());
    }
    let message = format!(
        "`{}` would need about {:.0} million particles and {} of memory; {} are free",
        args.command.text,
        0.5e-6 * volume,
        memory::text(bytes),
        memory::text(memory::available())
    );
    Err(Diagnostic::error(Code::TooLarge, span, message).label("too many particles"))
}

/// What only the places of the particles tell: none at all, cut by the box, on top of another.
fn check_solid(
    args: &mut Args<'_>,
    scene: &Scene,
    id: &Name,
    region_name: &Name,
    solid: &SolidEntry,
    total: bool,
) -> Result<(), Diagnostic> {
    let (domain, particles_per_cell) = (&solid.cells, solid.particles_per_cell);
    let region = solid.region.as_ref();
    let first = fill::visit(domain, region, particles_per_cell, ControlFlow::Break);
    if first.is_continue() {
        let message =
            format!("no particle of solid `{}` lies inside the region and the box", id.text);
        return Err(Diagnostic::error(Code::NothingLeft, region_name.span, message)
            .label("empty at this cell size")
            .help("compare the region with the limits of `dimension`, and its size with h"));
    }
    let bounds = region.bounds();
    let slack = 1e-9 * domain.cell;
    let cut = (0..domain.dimension).any(|axis| {
        let [low, high] = [bounds.lower[axis], bounds.upper[axis]];
        (low.is_finite() && low < domain.lower[axis] - slack)
            || (high.is_finite() && high > domain.upper[axis] + slack)
    });
    if cut && !total {
        let message = format!("solid `{}` is cut by the box", id.text);
        args.remarks.push(
            Diagnostic::warning(Code::CutByBox, region_name.span, message)
                .label("reaches beyond the limits of `dimension`"),
        );
    }
    for (other, entry) in scene.solids.iter().take(MOST_OVERLAPS) {
        let common = bounds.common(entry.region.bounds());
        if (0..domain.dimension).any(|axis| common.lower[axis] > common.upper[axis]) {
            continue;
        }
        let other_region = entry.region.as_ref();
        let hit = fill::visit(domain, region, particles_per_cell, |place| {
            match other_region.contains(place) {
                true => ControlFlow::Break(place),
                false => ControlFlow::Continue(()),
            }
        });
        if hit.is_break() {
            let message = format!("solid `{}` overlaps solid `{other}`", id.text);
            args.remarks.push(
                Diagnostic::warning(Code::Overlap, region_name.span, message)
                    .label("shares places with the other solid"),
            );
        }
    }
    Ok(())
}

/// `delete_particles(solid|all, region, ID)`
pub fn delete_particles(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    let solid = match args.keyword("all") {
        true => None,
        false => {
            let name = args.word("a solid ID or `all`")?;
            Some(scene.solids.find(&name)?.0)
        }
    };
    args.choice("way to choose particles", &["region"])?;
    let name = args.word("a region ID")?;
    let region = scene.regions.find(&name)?.1.clone();
    let nothing_left =
        Diagnostic::error(Code::NothingLeft, name.span, "no particle of the solid is left")
            .label("holds all of them");
    Ok(Box::new(move |session| match session.simulation.delete_particles(solid, region.as_ref()) {
        true => Ok(()),
        false => Err(Stop::Script(vec![nothing_left])),
    }))
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
