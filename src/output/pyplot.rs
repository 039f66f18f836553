//! Pictures of particles and nodes (`pyplot`).

use super::canvas::{Anchor, Canvas, Colour, Mark};
use super::frame::{self, Frame, MARGIN};
use super::share::{Rows, Share};
use super::{BuildDump, Dump, DumpTarget, Snapshot, file, number};
use crate::fault::Fault;
use crate::fix::GroupKind;
use crate::plan::Plan;
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::shape::ShapeKind;
use crate::style::Style;
use crate::world::World;
use std::path::PathBuf;

/// The row of the table.
pub const STYLE: Style<BuildDump> = Style {
    name: "pyplot",
    usage: "[w, h]",
    summary: "pictures: nodes as crosses, particles as dots coloured by solid",
    manual: "\
w x h pixels, 1200 x 780 unless given; the suffix .pdf, .png or .svg chooses the format. `*` in
the name is the step, without it the picture is overwritten. 3-D is seen along -z.",
    build: Some(build),
};

/// Largest side of a picture.
const LARGEST: f64 = 16384.0;

/// More nodes than this are not drawn one by one.
const MOST_CROSSES: usize = 40_000;

fn build(args: &mut Args<'_>, target: &DumpTarget) -> Result<Box<dyn Dump>, Diagnostic> {
    if target.kind != GroupKind::All {
        let message = "a picture shows the group `all`";
        return Err(
            Diagnostic::error(Code::GroupKind, target.group_span, message).label("not `all`")
        );
    }
    target.need_suffix("a picture", &[".pdf", ".png", ".svg"])?;
    let mut size = [1200.0, 780.0];
    if args.remaining() > 0 {
        size = [
            args.within("the width", 16.0, LARGEST)?.value,
            args.within("the height", 16.0, LARGEST)?.value,
        ];
    }
    let [width, height] = size.map(|side| side as u32);
    Ok(Box::new(Picture { pattern: target.file.clone(), width, height }))
}

struct Picture {
    pattern: String,
    width: u32,
    height: u32,
}

impl Dump for Picture {
    fn needs(&self, plan: &mut Plan, _dimension: usize) {
        plan.node_places = true;
    }

    fn write(&mut self, snapshot: &Snapshot<'_>) -> Result<Vec<String>, Fault> {
        let path = PathBuf::from(self.pattern.replace('*', &snapshot.step.to_string()));
        let canvas = draw(snapshot, self.width, self.height);
        if snapshot.world.ranks.is_first() {
            file::write_whole(&path, &canvas.encode(&path))?;
        }
        Ok(vec![self.pattern.clone()])
    }
}

/// The picture of a snapshot, in the first process.
fn draw(snapshot: &Snapshot<'_>, width: u32, height: u32) -> Canvas {
    let world = snapshot.world;
    let limits = frame::limits(&world.domain);
    let frame = Frame::new(limits, f64::from(width), f64::from(height));
    let mut canvas = Canvas::new(width, height);
    crosses(&mut canvas, &frame, world);
    dots(&mut canvas, &frame, world);
    frame.axes(&mut canvas);
    let title = format!("t = {}", number::brief(snapshot.time));
    canvas.text([0.5 * width as f32, 0.5 * MARGIN as f32], 16.0, Anchor::Middle, title);
    canvas
}

/// All particles, by id: storage changes as particles move; a picture does not.
fn dots(canvas: &mut Canvas, frame: &Frame, world: &World) {
    let particles = &world.particles;
    let edges = match world.method.shape {
        ShapeKind::Corners(kind) => kind.edges(world.domain.dimension),
        _ => &[],
    };
    let corners = edges.iter().flatten().max().map_or(0, |last| last + 1);
    let counted: Vec<usize> = particles.counted().collect();
    let domains: Vec<Vec<[f64; 3]>> = match corners {
        0 => Vec::new(),
        _ => counted.iter().map(|p| world.corners(*p)).collect(),
    };
    // Of each particle its solid, its place and the corners of its domain.
    let number = |row: usize, column: usize| match column {
        0 => f64::from(particles.solid[counted[row]]),
        1 | 2 => particles.position[counted[row]][column - 1],
        _ => domains[row][(column - 3) / 2][(column - 3) % 2],
    };
    let keys: Vec<u64> = counted.iter().map(|p| u64::from(particles.id[*p])).collect();
    let rows = Rows::deal(&world.ranks, &Share::to_first(), &keys, 3 + 2 * corners, number);
    let order: Vec<usize> = rows.order().into_iter().map(|row| row as usize).collect();
    let pixel = |row: usize, column: usize| {
        frame.pixel(rows.number(row, column), rows.number(row, column + 1))
    };
    for (number, solid) in world.solids.iter().enumerate() {
        let of_solid = |row: &usize| rows.number(*row, 0) as usize == number;
        let centres = order.iter().copied().filter(of_solid).map(|row| pixel(row, 1)).collect();
        let spacing = solid.cells.cell / solid.particles_per_cell;
        let radius = (0.4 * spacing * frame.scale).clamp(0.5, 20.0) as f32;
        canvas.marks.push(Mark::Dots { centres, radius, colour: Colour::of(number) });
    }
    if let ShapeKind::Corners(_) = world.method.shape {
        let of_edge =
            |row: usize| edges.iter().map(move |edge| edge.map(|c| pixel(row, 3 + 2 * c)));
        let segments = order.into_iter().flat_map(of_edge).collect();
        canvas.marks.push(Mark::Lines { segments, width: 0.5, colour: Colour::BLACK });
    }
}

/// All nodes of the lowest layer that particles reach.
fn crosses(canvas: &mut Canvas, frame: &Frame, world: &World) {
    const ARM: f32 = 2.0;
    // Lattices of contact lie on one another.
    let count = if world.method.total { world.grid.lattices.len() } else { 1 };
    let lattices = &world.grid.lattices[..count.min(world.grid.lattices.len())];
    let counts = lattices.iter().map(|lattice| lattice.nodes[0].saturating_mul(lattice.nodes[1]));
    if counts.fold(0, usize::saturating_add) > MOST_CROSSES {
        return;
    }
    let mut segments = Vec::new();
    for (number, lattice) in lattices.iter().enumerate() {
        let moved = moved_nodes(world, number);
        let key = |row: &u32| moved.key(*row as usize);
        let order = moved.order();
        for i in 0..lattice.nodes[0] {
            for j in 0..lattice.nodes[1] {
                let known = order.binary_search_by_key(&node_key([i, j, 0]), key);
                let [x, y] = match known.map(|place| order[place] as usize) {
                    Ok(row) => [0, 1].map(|axis| moved.number(row, axis)),
                    Err(_) => {
                        let [x, y, _] = lattice.place([i, j, 0]);
                        [x, y]
                    }
                };
                let [x, y] = frame.pixel(x, y);
                segments.push([[x - ARM, y], [x + ARM, y]]);
                segments.push([[x, y - ARM], [x, y + ARM]]);
            }
        }
    }
    canvas.marks.push(Mark::Lines { segments, width: 0.7, colour: Colour::GREY });
}

/// Key of a node of a layer.
fn node_key([i, j, _]: [usize; 3]) -> u64 {
    (i as u64) << 32 | j as u64
}

/// Current places of the nodes of a lattice that are not where they were, in the first process: those
/// of the lowest layer that particles reach.
fn moved_nodes(world: &World, number: usize) -> Rows {
    let grid = &world.grid;
    let window = grid.lattices[number].window;
    let of_lattice = |place: &usize| window.places().contains(place) && grid.counts(*place);
    let active = || grid.runs.iter().cloned().flatten().filter(of_lattice);
    let heights = active().map(|place| -(window.node(place)[2] as f64));
    let [lowest] = world.ranks.largest([heights.fold(f64::NEG_INFINITY, f64::max)]);
    let lowest = |place: &usize| -(window.node(*place)[2] as f64) == lowest;
    let layer: Vec<usize> = match world.method.total {
        true => active().filter(lowest).collect(),
        false => Vec::new(),
    };
    let keys: Vec<u64> = layer.iter().map(|place| node_key(window.node(*place))).collect();
    let number = |row: usize, axis: usize| grid.places().of(layer[row]).0[axis];
    Rows::deal(&world.ranks, &Share::to_first(), &keys, 2, number)
}
