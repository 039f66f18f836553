//! Dumps of the grid.

use super::lammps::{Table, Values, corners};
use super::series::{Format, Series};
use super::{BuildDump, Dump, DumpTarget, Snapshot};
use crate::fault::Fault;
use crate::fix::GroupKind;
use crate::model::checkpoint::Checkpoint;
use crate::model::group::{Group, GroupId};
use crate::model::lattice::Lattice;
use crate::plan::Plan;
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::script::suggest;
use crate::style::Style;
use crate::world::World;

const FIELDS: [&str; 16] = [
    "x", "y", "z", "vx", "vy", "vz", "bx", "by", "bz", "mass", "mask", "rigid", "T", "ntypex",
    "ntypey", "ntypez",
];

const MANUAL: &str = "\
Fields: x y z vx vy vz bx by bz mass mask rigid T ntypex ntypey ntypez: mass and velocity as the
particles give them at the end of the step, b the external force of the step, T as the particles
give it in `thermo-mechanical` runs. Every node stands in
the file once, with id (i ny + j) nz + k + 1, in total Lagrangian methods solid by solid (type) and
at its current place, with `contact` body by body (all solids that no contact names together); nodes
without particles are 0. rigid is 1 on nodes that a rigid body carries
along; they have its velocity, and the mass of the other bodies.";

const fn row(name: &'static str, summary: &'static str, build: BuildDump) -> Style<BuildDump> {
    Style { name, usage: "field, ...", summary, manual: MANUAL, build: Some(build) }
}

/// The row of `grid`.
pub const TEXT: Style<BuildDump> =
    row("grid", "nodes as LAMMPS text", |args, target| build(args, target, Format::Text));

/// The row of `grid/gz`.
pub const GZIP: Style<BuildDump> =
    row("grid/gz", "the same, compressed", |args, target| build(args, target, Format::Gzip));

/// The row of `grid/bin`.
pub const BINARY: Style<BuildDump> =
    row("grid/bin", "nodes in LAMMPS's binary layout", |args, t| build(args, t, Format::Binary));

const VTK_MANUAL: &str = "\
The fields of `grid` in files *.vti, regular lattices of all nodes at their reference places, or
*.vtp, points at their current places. Components become one array: v, b; id and type are always
there. Where there are several lattices (total Lagrangian solids, bodies in contact) a snapshot is a
file *.vti for each. A name with a `*` (the step) makes one file per snapshot and `NAME.pvd`, the series
with its times, which ParaView opens: `dump(d, all, grid/vtk, 100, grid.*.vti, vx, vy, vz, mass)`.";

/// The row of `grid/vtk`.
pub const VTK: Style<BuildDump> = Style {
    manual: VTK_MANUAL,
    ..row("grid/vtk", "nodes for ParaView", |args, target| {
        target.need_suffix("a file of nodes", &[".vti", ".vtp"])?;
        if target.file.ends_with(IMAGE) && target.kind == GroupKind::Nodes {
            let message = "a lattice has the nodes of the group `all`";
            return Err(Diagnostic::error(Code::GroupKind, target.group_span, message)
                .label("not `all`")
                .help("a file *.vtp takes any group of nodes"));
        }
        build(args, target, Format::Vtk)
    })
};

/// Files of regular lattices.
const IMAGE: &str = ".vti";

fn build(
    args: &mut Args<'_>,
    target: &DumpTarget,
    format: Format,
) -> Result<Box<dyn Dump>, Diagnostic> {
    if target.kind == GroupKind::Particles {
        let message = "a dump of the grid needs `all` or a group of nodes";
        return Err(Diagnostic::error(Code::GroupKind, target.group_span, message)
            .label("this is a group of particles"));
    }
    let mut names = Vec::new();
    loop {
        let name = args.word("a field")?;
        if !FIELDS.contains(&name.text.as_str()) {
            let message = format!("a dump of the grid has no field `{}`", name.text);
            let otherwise = format!("fields: {}", FIELDS.join(" "));
            return Err(Diagnostic::error(Code::UnknownField, name.span, message)
                .label("not a field")
                .help(suggest::help(&name.text, FIELDS.into_iter(), &otherwise)));
        }
        names.push(name.text);
        if args.remaining() == 0 {
            break;
        }
    }
    let images = format == Format::Vtk && target.file.ends_with(IMAGE);
    let series = Series::new(&target.file, format);
    Ok(Box::new(GridDump { group: target.group, names, series, images }))
}

struct GridDump {
    group: GroupId,
    names: Vec<String>,
    series: Series,
    /// Each lattice is a regular one of its own.
    images: bool,
}

impl Dump for GridDump {
    fn needs(&self, plan: &mut Plan, _dimension: usize) {
        let any = |names: [&str; 3]| self.names.iter().any(|name| names.contains(&name.as_str()));
        plan.external_force |= any(["bx", "by", "bz"]);
        plan.node_places |= any(["x", "y", "z"]);
    }

    fn shows_nodes(&self) -> bool {
        true
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        self.series.keep(checkpoint);
    }

    fn write(&mut self, snapshot: &Snapshot<'_>) -> Result<Vec<String>, Fault> {
        let world = snapshot.world;
        let nodes = all_nodes(world, self.group);
        let lattices = &world.grid.lattices;
        let mut before = vec![0];
        for lattice in lattices {
            before.push(before[before.len() - 1] + lattice.count());
        }
        // A row of each table for each node.
        let orders: Vec<(Vec<u32>, Option<&Lattice>)> = match self.images {
            false => vec![((0..nodes.len() as u32).collect(), None)],
            true => lattices
                .iter()
                .zip(&before)
                .map(|(lattice, first)| (first_axis_fastest(lattice, *first), Some(lattice)))
                .collect(),
        };
        let id = |place: usize| {
            let (lattice, node) = nodes[place];
            before[lattice] + lattices[lattice].number(node) + 1
        };
        let kind = |place: usize| nodes[place].0 as u64 + 1;
        let point = |row: usize| place(world, nodes[row]);
        let corners = corners(world, nodes.iter().map(|node| place(world, *node)));
        let tables: Vec<Table<'_>> = orders
            .iter()
            .map(|(order, lattice)| Table {
                step: snapshot.step,
                time: snapshot.time,
                corners,
                names: &self.names,
                order,
                id: &id,
                kind: &kind,
                values: self.names.iter().map(|name| values(name, world, &nodes)).collect(),
                point: &point,
                lattice: *lattice,
            })
            .collect();
        self.series.write(&tables)
    }
}

/// Rows of the nodes of a lattice with the first axis fastest, of all nodes with the last axis
/// fastest, the first of which is row `first`.
fn first_axis_fastest(lattice: &Lattice, first: u64) -> Vec<u32> {
    let [nx, ny, nz] = lattice.nodes;
    let mut rows = Vec::with_capacity(nx * ny * nz);
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                rows.push((first + lattice.number([i, j, k])) as u32);
            }
        }
    }
    rows
}

/// Number of a lattice and index of one of its nodes.
type Numbered = (usize, [usize; 3]);

/// The nodes of a group, by ascending id.
fn all_nodes(world: &World, group: GroupId) -> Vec<Numbered> {
    let members = &world.groups[group].members;
    let mut nodes = Vec::new();
    for (number, lattice) in world.grid.lattices.iter().enumerate() {
        let [nx, ny, nz] = lattice.nodes;
        for i in 0..nx {
            for j in 0..ny {
                for k in 0..nz {
                    if members.holds_node(number, lattice.place([i, j, k])) {
                        nodes.push((number, [i, j, k]));
                    }
                }
            }
        }
    }
    nodes
}

/// Current place of a node \[L\].
fn place(world: &World, (lattice, node): Numbered) -> [f64; 3] {
    let lattice = &world.grid.lattices[lattice];
    match lattice.window.local(node) {
        Some(local) => world.grid.places().of(local).0,
        None => lattice.place(node),
    }
}

/// Groups whose membership fits the digits of an f64.
const MASK_BITS: usize = 52;

/// Node type per axis (language.md 9.7): 0 inside, -2, -1 at the lower and 2, 1 at the upper end.
fn node_type(i: usize, count: usize) -> f64 {
    i.min(2) as f64 - (count - 1 - i).min(2) as f64
}

/// The column of a field.
fn values<'a>(name: &str, world: &'a World, nodes: &[Numbered]) -> Values<'a> {
    let grid = &world.grid;
    let each = |value: &dyn Fn(Numbered) -> f64| {
        Values::Made(nodes.iter().map(|node| value(*node)).collect())
    };
    let active = |(lattice, node): Numbered| grid.lattices[lattice].window.local(node);
    let rigid =
        |node| active(node).and_then(|local| grid.rigid.get(local)).copied().unwrap_or_default();
    let axis = |names: [&str; 3]| names.iter().position(|known| *known == name);
    if let Some(axis) = axis(["x", "y", "z"]) {
        return each(&|node| place(world, node)[axis]);
    }
    if let Some(axis) = axis(["vx", "vy", "vz"]) {
        return each(&|node| {
            let motion = active(node).map_or([0.0; 4], |local| grid.nodes[local].motion);
            let carried = rigid(node);
            if carried[3] > 0.0 {
                return carried[axis];
            }
            if motion[3] > grid.mass_cutoff { motion[axis] / motion[3] } else { 0.0 }
        });
    }
    if let Some(axis) = axis(["bx", "by", "bz"]) {
        return each(&|node| {
            active(node).and_then(|local| grid.external.get(local)).map_or(0.0, |b| b[axis])
        });
    }
    if let Some(axis) = axis(["ntypex", "ntypey", "ntypez"]) {
        return each(&|(lattice, node)| {
            let count = grid.lattices[lattice].nodes[axis];
            if count > 1 { node_type(node[axis], count) } else { 0.0 }
        });
    }
    match name {
        "T" => each(&|node| {
            active(node).and_then(|local| grid.temperature.get(local)).map_or(0.0, |t| t[0])
        }),
        "mass" => each(&|node| active(node).map_or(0.0, |local| grid.nodes[local].motion[3])),
        "rigid" => each(&|node| if rigid(node)[3] > 0.0 { 1.0 } else { 0.0 }),
        "mask" => each(&|(lattice, node)| {
            let place = grid.lattices[lattice].place(node);
            let groups = world.groups.0.iter().take(MASK_BITS).enumerate();
            let member = |(bit, group): (usize, &Group)| {
                if group.members.holds_node(lattice, place) { (1u64 << bit) as f64 } else { 0.0 }
            };
            groups.map(member).sum()
        }),
        _ => Values::Constant(0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn node_types_at_both_ends() {
        let types: Vec<f64> = (0..6).map(|i| node_type(i, 6)).collect();
        assert_eq!(types, [-2.0, -1.0, 0.0, 0.0, 1.0, 2.0]);
    }
}
