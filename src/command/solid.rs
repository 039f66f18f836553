//! `solid`: bodies from regions, meshes and lists.

use super::domain::check_cells;
use super::method::{Choice, check_domain, check_nodes};
use super::scene::{Scene, SolidEntry};
use super::{Action, action};
use crate::geometry::{Mistake, Point, Points, gmsh, list};
use crate::kernel::sort;
use crate::memory;
use crate::method::Method;
use crate::model::domain::Domain;
use crate::region::{Bounds, Region};
use crate::script::arguments::{Args, Name};
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::source::Span;
use crate::simulation::fill::Filling;
use std::collections::HashSet;
use std::ops::ControlFlow;
use std::sync::Arc;

/// So many solids above are searched for an overlap.
const MOST_OVERLAPS: usize = 100;

/// Cell sizes of solid and grid may differ by this part of them.
const SAME_CELL: f64 = 1e-9;

/// Bytes that a particle takes, about.
const BYTES_EACH: f64 = 300.0;

/// What a solid is made from, as the words after its ID tell.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    /// A region and the particles per cell and axis.
    Region,
    /// A region and the particles per axis of its bounding box, an old form.
    Counts,
    /// A mesh.
    Mesh,
    /// A list of particles.
    List,
}

/// What a solid is made from.
struct Body {
    /// The region or file.
    name: Name,
    /// Where the number of particles is given.
    count: Span,
    filling: Filling,
}

/// `solid(ID, region, regionID, ppc, matID, h [, T0])`, `solid(ID, mesh|file, name, matID, h
/// [, T0])`, and old forms.
pub fn solid(args: &mut Args<'_>, scene: &mut Scene) -> Result<Action, Diagnostic> {
    scene.tried.push("solid");
    let id = args.word("a solid ID")?;
    scene.solids.check_free(&id)?;
    let mut domain = scene.need_domain(args.command)?;
    let default_method = scene.method.is_none();
    let choice = scene.need_method(args);
    check_domain(&choice, args.command.span, scene.axisymmetric, domain.dimension)?;
    let form = form_of_solid(args, scene, &id, domain.dimension);
    let body = read_body(args, scene, form, domain.dimension)?;
    check_elements(&body, &choice)?;
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
        let bounds = body.filling.bounds();
        let method = Method { axisymmetric: scene.axisymmetric, ..choice.method };
        let lower = method.lower_limits(bounds.lower);
        domain = domain.of_limits(lower, bounds.upper, cell.value);
        check_bounded(&domain, &body.name)?;
        check_cells(&domain, cell.span)?;
    }
    check_nodes(&domain, choice.method.shape, cell.span)?;
    if scene.box_follows_solids {
        follow_solid(args, scene, &domain, total)?;
    }
    check_size(&domain, &body, args)?;
    let span = body.count;
    let entry = SolidEntry { filling: body.filling, cells: domain, rigid: law.is_rigid() };
    check_grid(&entry, scene, total, span)?;
    if args.rehearsal() {
        check_solid(args, scene, &id, &body.name, &entry, total)?;
    }
    let filling = entry.filling.clone();
    scene.solids.declare(&id, entry)?;
    let (outer, follows) = (scene.need_domain(args.command)?, scene.box_follows_solids);
    Ok(action(move |session| {
        let simulation = &mut session.simulation;
        if brings_cell {
            simulation.set_domain(outer);
        }
        if follows {
            simulation.world.domain = outer;
        }
        if default_method {
            choice.take_effect(simulation);
        }
        simulation.add_filled_solid(&id.text, &material.text, law, &filling, domain.cell);
        if let Some(temperature) = temperature {
            simulation.heat_last_solid(temperature);
        }
    }))
}

/// Reads the word that says what the solid is made from.
fn form_of_solid(args: &mut Args<'_>, scene: &Scene, id: &Name, dimension: usize) -> Form {
    let word = args.peek().map(str::to_string);
    // The modern line with the region and all that follows from a place on.
    let modern = |args: &Args<'_>, numbers: &[&str], from: usize| {
        let region = args.peek().unwrap_or("regionID");
        let rest = (from..).map_while(|ahead| args.peek_at(ahead));
        let words: Vec<&str> = numbers.iter().copied().chain(rest).collect();
        format!("solid({}, region, {region}, {})", id.text, words.join(", "))
    };
    match word.as_deref() {
        Some("region") => {
            args.keyword("region");
        }
        Some("mesh") => {
            args.keyword("mesh");
            return Form::Mesh;
        }
        Some("file") => {
            args.keyword("file");
            return Form::List;
        }
        Some(old @ ("rectangle" | "cylinder" | "block")) if args.remaining() > 4 => {
            args.keyword(old);
            if old == "block" && has_counts(args, scene, dimension) {
                let line = modern(args, &["ppc"], 1 + dimension);
                args.old_form(&line);
                return Form::Counts;
            }
            let line = modern(args, &[], 1);
            args.old_form(&line);
        }
        Some(_) if args.remaining() > 3 => {
            let line = modern(args, &[], 1);
            args.old_form(&line);
        }
        _ => {}
    }
    Form::Region
}

/// Does one number per axis of the body follow the region, and not one per cell and axis? The
/// place of the material tells.
fn has_counts(args: &Args<'_>, scene: &Scene, dimension: usize) -> bool {
    let is_material = |place: usize| {
        args.peek_at(place).is_some_and(|word| scene.materials.position(word).is_some())
    };
    match (is_material(2), is_material(1 + dimension)) {
        (true, _) => false,
        (false, true) => dimension > 1,
        // A misspelt material: a number stands where the other form has the material.
        (false, false) => {
            let number = |word: &str| word.starts_with(|first: char| first.is_ascii_digit());
            dimension > 1 && args.peek_at(2).is_some_and(number)
        }
    }
}

/// Reads region or file, and the numbers of particles.
fn read_body(
    args: &mut Args<'_>,
    scene: &Scene,
    form: Form,
    dimension: usize,
) -> Result<Body, Diagnostic> {
    if form == Form::Mesh || form == Form::List {
        let name = args.word("a file name")?;
        let bytes = scene.read_file(&name)?;
        let points = match form {
            Form::Mesh => gmsh::read(&bytes, dimension).and_then(|mesh| mesh.points()),
            _ => list::read(&bytes, dimension),
        };
        let points = points.map_err(|Mistake { line, what }| {
            Diagnostic::in_file(&name.text, line, name.span, &what)
        })?;
        for remark in &points.remarks {
            let message = format!("{}: {remark}", name.text);
            args.remarks.push(
                Diagnostic::warning(Code::OddFile, name.span, message).label("looks like a slip"),
            );
        }
        let count = name.span;
        return Ok(Body { name, count, filling: Filling::Points(Arc::new(points)) });
    }
    let name = args.word("a region ID")?;
    let region = scene.regions.find(&name)?.1.clone();
    let count = args.next_span();
    if form == Form::Counts {
        let points = spread(args, region.as_ref(), &name, dimension)?;
        return Ok(Body { name, count, filling: Filling::Points(Arc::new(points)) });
    }
    let even = scene.method.is_some_and(|choice| choice.method.shape.has_domains());
    let particles_per_cell = args.count("the number of particles per cell and axis", 1)? as usize;
    Ok(Body { name, count, filling: Filling::Region { region, particles_per_cell, even } })
}

/// So many particles per axis, spread evenly over the bounding box of a region.
fn spread(
    args: &mut Args<'_>,
    region: &dyn Region,
    name: &Name,
    dimension: usize,
) -> Result<Points, Diagnostic> {
    let span = args.next_span();
    let mut counts = [1; 3];
    for count in &mut counts[..dimension] {
        *count = args.count("the number of particles along an axis", 1)? as usize;
    }
    let Bounds { mut lower, mut upper } = region.bounds();
    lower[dimension..].fill(0.0);
    upper[dimension..].fill(0.0);
    if lower.iter().chain(&upper).any(|limit| limit.is_infinite()) {
        return Err(Diagnostic::error(Code::Range, name.span, "the region must be bounded")
            .label("reaches to infinity")
            .help("the particles are spread over the limits of the region"));
    }
    let total: f64 = counts.iter().map(|count| *count as f64).product();
    check_memory(args, total, span)?;
    let step: [f64; 3] = std::array::from_fn(|a| (upper[a] - lower[a]) / counts[a] as f64);
    let volume: f64 = step[..dimension].iter().product();
    let mut points = Points { lower, upper, ..Points::default() };
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            for k in 0..counts[2] {
                let number = [i, j, k].map(|n| n as f64 + 0.5);
                let place = std::array::from_fn(|axis| lower[axis] + number[axis] * step[axis]);
                if region.contains(place) && volume > 0.0 {
                    points.list.push(Point { place, volume });
                }
            }
        }
    }
    Ok(points)
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

/// Refuses bodies whose particles cannot have the domains of the method.
fn check_elements(body: &Body, choice: &Choice) -> Result<(), Diagnostic> {
    let Some(needed) = choice.domain.and_then(|domain| domain.corners) else { return Ok(()) };
    let fits = match &body.filling {
        Filling::Region { .. } => false,
        Filling::Points(points) => {
            let all = points.corners.iter().all(|corners| corners.places().len() == needed);
            all && !points.corners.is_empty()
        }
    };
    if fits {
        return Ok(());
    }
    let (message, help) = match needed {
        3 => ("`T3` needs a mesh of triangles", "`Q4` takes any body"),
        _ => ("`Tet4` needs a mesh of tetrahedra", "`H8` takes any body"),
    };
    Err(Diagnostic::error(Code::NotCombined, body.name.span, message)
        .label("its particles have other corners")
        .help(help))
}

/// Refuses a body without bounds.
fn check_bounded(cells: &Domain, name: &Name) -> Result<(), Diagnostic> {
    let bounded = (0..cells.dimension)
        .all(|axis| cells.lower[axis].is_finite() && cells.upper[axis].is_finite());
    if bounded {
        return Ok(());
    }
    let message = "in total Lagrangian methods the region of a solid must be bounded";
    Err(Diagnostic::error(Code::Range, name.span, message)
        .label("reaches to infinity")
        .help("the solid's own grid spans the limits of its region"))
}

/// Refuses more particles than memory can hold, before any is made.
fn check_size(domain: &Domain, body: &Body, args: &Args<'_>) -> Result<(), Diagnostic> {
    let Filling::Region { region, particles_per_cell, .. } = &body.filling else {
        return Ok(());
    };
    let bounds = region.bounds();
    let most: f64 = (0..domain.dimension)
        .map(|axis| {
            let low = bounds.lower[axis].max(domain.lower[axis]);
            let high = bounds.upper[axis].min(domain.upper[axis]);
            // Cells that the region only touches are searched too.
            ((high - low).max(0.0) / domain.cell + 1.0) * *particles_per_cell as f64
        })
        .product();
    // A region fills at least about half of its bounds, unless it was cut from a larger one.
    check_memory(args, 0.5 * most, body.count)
}

/// Refuses a grid that memory cannot hold: it lies between the outermost particles of all solids, in
/// total Lagrangian methods of each.
fn check_grid(
    solid: &SolidEntry,
    scene: &Scene,
    total: bool,
    span: Span,
) -> Result<(), Diagnostic> {
    let mut common = Bounds { lower: [f64::INFINITY; 3], upper: [f64::NEG_INFINITY; 3] };
    let (mut all, mut own) = (0.0, 0.0);
    for solid in scene.solids.iter().map(|(_, solid)| solid).chain([solid]) {
        let (bounds, cells) = (solid.filling.bounds(), &solid.cells);
        own = 1.0;
        for axis in 0..cells.dimension {
            let low = bounds.lower[axis].max(cells.lower[axis]);
            let high = bounds.upper[axis].min(cells.upper[axis]);
            common.lower[axis] = common.lower[axis].min(low);
            common.upper[axis] = common.upper[axis].max(high);
            own *= ((high - low) / cells.cell).max(0.0) + 1.0;
        }
        all += own;
    }
    let between =
        |axis: usize| ((common.upper[axis] - common.lower[axis]) / solid.cells.cell).max(0.0) + 1.0;
    let updated: f64 = (0..solid.cells.dimension).map(between).product();
    let nodes = if total { all } else { updated };
    let bytes = nodes * sort::BYTES_EACH;
    if bytes <= memory::available() && nodes < f64::from(u32::MAX) {
        return Ok(());
    }
    let message = format!(
        "the grid would need about {nodes:.2e} nodes and {} of memory; {} are free",
        memory::text(bytes),
        memory::text(memory::available())
    );
    let mistake = Diagnostic::error(Code::TooLarge, span, message).label("too many cells");
    Err(if total || updated <= own {
        mistake
    } else {
        mistake.help("the grid reaches from one solid to the other: are they too far apart?")
    })
}

/// Refuses more particles than memory can hold.
pub fn check_memory(args: &Args<'_>, count: f64, span: Span) -> Result<(), Diagnostic> {
    let bytes = count * BYTES_EACH;
    if bytes <= memory::available() && count < f64::from(u32::MAX) {
        return Ok(());
    }
    let message = format!(
        "`{}` would need about {:.0} million particles and {} of memory; {} are free",
        args.command.text,
        1e-6 * count,
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
    name: &Name,
    solid: &SolidEntry,
    total: bool,
) -> Result<(), Diagnostic> {
    let filling = &solid.filling;
    let first = filling.visit(&solid.cells, |_, _| ControlFlow::Break(()));
    if first.is_continue() {
        let (inside, help) = match filling {
            Filling::Region { .. } => {
                ("the region and the box", "with the limits of `dimension`, and its size with h")
            }
            Filling::Points(_) => ("the box", "with the limits of `dimension`"),
        };
        let message = format!("no particle of solid `{}` lies inside {inside}", id.text);
        return Err(Diagnostic::error(Code::NothingLeft, name.span, message)
            .label("empty at this cell size")
            .help(format!("compare the region {help}")));
    }
    if !total && is_cut(solid, scene.axisymmetric) {
        let message = format!("solid `{}` is cut by the box", id.text);
        args.remarks.push(
            Diagnostic::warning(Code::CutByBox, name.span, message)
                .label("reaches beyond the limits of `dimension`"),
        );
    }
    for (other, entry) in scene.solids.iter().take(MOST_OVERLAPS) {
        if overlap(solid, entry) {
            let message = format!("solid `{}` overlaps solid `{other}`", id.text);
            args.remarks.push(
                Diagnostic::warning(Code::Overlap, name.span, message)
                    .label("shares places with the other solid"),
            );
        }
    }
    Ok(())
}

/// Does the box cut something off?
fn is_cut(solid: &SolidEntry, axisymmetric: bool) -> bool {
    let domain = &solid.cells;
    if let Filling::Points(points) = &solid.filling {
        return points.list.iter().any(|point| !domain.contains(point.place));
    }
    let bounds = solid.filling.bounds();
    let slack = 1e-9 * domain.cell;
    (0..domain.dimension).any(|axis| {
        let [low, high] = [bounds.lower[axis], bounds.upper[axis]];
        // A region round the axis of a body of revolution goes on behind it.
        let behind = axis == 0 && axisymmetric && domain.lower[0].abs() < slack;
        (low.is_finite() && low < domain.lower[axis] - slack && !behind)
            || (high.is_finite() && high > domain.upper[axis] + slack)
    })
}

/// Does one solid have a particle in the region of the other?
fn overlap(solid: &SolidEntry, other: &SolidEntry) -> bool {
    let common = solid.filling.bounds().common(other.filling.bounds());
    if (0..solid.cells.dimension).any(|axis| common.lower[axis] > common.upper[axis]) {
        return false;
    }
    let (of, region) = match (&solid.filling, &other.filling) {
        (_, Filling::Region { region, .. }) => (solid, region),
        (Filling::Region { region, .. }, _) => (other, region),
        (Filling::Points(points), Filling::Points(others)) => {
            return coincide(points, others, solid.cells.dimension);
        }
    };
    let hit = of.filling.visit(&of.cells, |place, _| match region.contains(place) {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    });
    hit.is_break()
}

/// Do two lists have particles in one quarter of a particle's edge? Neighbours across a common
/// face of two bodies hardly ever do.
fn coincide(points: &Points, others: &Points, dimension: usize) -> bool {
    let edge = 0.25 * others.spacing(dimension);
    let cell = |point: &Point| point.place.map(|x| (x / edge).floor().to_bits());
    let taken: HashSet<[u64; 3]> = others.list.iter().map(cell).collect();
    points.list.iter().any(|point| taken.contains(&cell(point)))
}
