//! Pictures of particles and nodes (`pyplot`).

use super::canvas::{Anchor, Canvas, Colour, Mark};
use super::frame::{self, Frame, MARGIN};
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

    fn shows_nodes(&self) -> bool {
        true
    }

    fn write(&mut self, snapshot: &Snapshot<'_>) -> Result<Vec<String>, Fault> {
        let path = PathBuf::from(self.pattern.replace('*', &snapshot.step.to_string()));
        file::write_whole(&path, &draw(snapshot, self.width, self.height).encode(&path))?;
        Ok(vec![self.pattern.clone()])
    }
}

/// The picture of a snapshot.
fn draw(snapshot: &Snapshot<'_>, width: u32, height: u32) -> Canvas {
    let world = snapshot.world;
    let limits = frame::limits(&world.domain);
    let frame = Frame::new(limits, f64::from(width), f64::from(height));
    let mut canvas = Canvas::new(width, height);
    crosses(&mut canvas, &frame, world);
    // Storage changes as particles move; a picture does not.
    let mut order: Vec<usize> = (0..world.particles.len()).collect();
    order.sort_unstable_by_key(|p| world.particles.id[*p]);
    for solid in 0..world.solids.len() {
        let of_solid = |p: &usize| world.particles.solid[*p] as usize == solid;
        let place = |p: usize| {
            let [x, y, ..] = world.particles.position[p];
            frame.pixel(x, y)
        };
        let centres = order.iter().copied().filter(of_solid).map(place).collect();
        let spacing = world.solids[solid].cells.cell / world.solids[solid].particles_per_cell;
        let radius = (0.4 * spacing * frame.scale).clamp(0.5, 20.0) as f32;
        canvas.marks.push(Mark::Dots { centres, radius, colour: Colour::of(solid) });
    }
    outlines(&mut canvas, &frame, world, &order);
    frame.axes(&mut canvas);
    let title = format!("t = {}", number::brief(snapshot.time));
    canvas.text([0.5 * width as f32, 0.5 * MARGIN as f32], 16.0, Anchor::Middle, title);
    canvas
}

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
    for lattice in lattices {
        for i in 0..lattice.nodes[0] {
            for j in 0..lattice.nodes[1] {
                let node = [i, j, lattice.window.lower[2]];
                let [x, y, _] = match lattice.window.local(node) {
                    Some(local) => world.grid.places().of(local).0,
                    None => lattice.place(node),
                };
                let [x, y] = frame.pixel(x, y);
                segments.push([[x - ARM, y], [x + ARM, y]]);
                segments.push([[x, y - ARM], [x, y + ARM]]);
            }
        }
    }
    canvas.marks.push(Mark::Lines { segments, width: 0.7, colour: Colour::GREY });
}

/// The edges of the domains of particles (CPDI).
fn outlines(canvas: &mut Canvas, frame: &Frame, world: &World, order: &[usize]) {
    let ShapeKind::Corners(kind) = world.method.shape else { return };
    let edges = kind.edges(world.domain.dimension);
    let mut segments = Vec::new();
    for p in order {
        let corners = world.corners(*p);
        let pixel = |c: usize| frame.pixel(corners[c][0], corners[c][1]);
        segments.extend(edges.iter().map(|[from, to]| [pixel(*from), pixel(*to)]));
    }
    canvas.marks.push(Mark::Lines { segments, width: 0.5, colour: Colour::BLACK });
}
