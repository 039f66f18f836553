//! Dumps of the grid.

use super::lammps::{Part, Table, Values, corners};
use super::series::{Format, Series};
use super::share::{Rows, Share};
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
use std::ops::Range;

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

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        self.series.keep(checkpoint);
    }

    fn write(&mut self, snapshot: &Snapshot<'_>) -> Result<Vec<String>, Fault> {
        let world = snapshot.world;
        let lattices = 0..world.grid.lattices.len();
        let files: Vec<Listing<'_>> = match self.images {
            false => vec![Listing::new(world, lattices, false)],
            true => lattices.map(|number| Listing::new(world, number..number + 1, true)).collect(),
        };
        let parts: Vec<Nodes> = files
            .iter()
            .map(|listing| Nodes::of(world, listing, self.group, &self.names))
            .collect();
        let corners = corners(world, parts.iter().flat_map(|part| part.points.iter().copied()));
        let files = files.iter().zip(&parts);
        let tables: Vec<Table<'_>> = files
            .map(|(listing, part)| part.table(snapshot, listing, &self.names, corners))
            .collect();
        self.series.write(&world.ranks, &tables)
    }
}

/// Number of a lattice and index of one of its nodes.
type Numbered = (usize, [usize; 3]);

/// Which nodes stand in a file, and in what order: those of some lattices by ascending id, or those of
/// one lattice as an image, the first axis fastest.
struct Listing<'a> {
    lattices: &'a [Lattice],
    /// Number of the first of them.
    first: usize,
    /// Nodes before each of them in the order of ids.
    before: Vec<u64>,
    image: bool,
}

impl<'a> Listing<'a> {
    fn new(world: &'a World, numbers: Range<usize>, image: bool) -> Self {
        let lattices = &world.grid.lattices;
        let mut next: u64 = lattices[..numbers.start].iter().map(Lattice::count).sum();
        let mut before = Vec::new();
        for lattice in &lattices[numbers.clone()] {
            before.push(next);
            next += lattice.count();
        }
        Self { lattices: &lattices[numbers.clone()], first: numbers.start, before, image }
    }

    fn id(&self, (lattice, node): Numbered) -> u64 {
        let number = lattice - self.first;
        self.before[number] + self.lattices[number].number(node) + 1
    }

    /// Nodes stand in the file by ascending key: the id, or the place in the image.
    fn key(&self, node: Numbered) -> u64 {
        if !self.image {
            return self.id(node);
        }
        let [nx, ny, _] = self.lattices[0].nodes;
        let [i, j, k] = node.1;
        ((k * ny + j) * nx + i) as u64
    }

    /// The keys of all nodes.
    fn keys(&self) -> Range<u64> {
        let count: u64 = self.lattices.iter().map(Lattice::count).sum();
        let first = if self.image { 0 } else { self.before.first().map_or(0, |before| before + 1) };
        first..first + count
    }

    /// The node of a key.
    fn node(&self, key: u64) -> Numbered {
        if self.image {
            let [nx, ny, _] = self.lattices[0].nodes;
            let key = key as usize;
            return (self.first, [key % nx, key / nx % ny, key / (nx * ny)]);
        }
        let number = self.before.partition_point(|before| *before < key).saturating_sub(1);
        let [_, ny, nz] = self.lattices[number].nodes;
        let place = (key - 1 - self.before[number]) as usize;
        (self.first + number, [place / (ny * nz), place / nz % ny, place % nz])
    }
}

/// The nodes of a file that this process formats, in the order of the file.
struct Nodes {
    nodes: Vec<Numbered>,
    /// One for each name.
    columns: Vec<Vec<f64>>,
    /// Their current places \[L\].
    points: Vec<[f64; 3]>,
    order: Vec<u32>,
    part: Part,
}

impl Nodes {
    /// Of the nodes of a group.
    fn of(world: &World, listing: &Listing<'_>, group: GroupId, names: &[String]) -> Self {
        let ranks = &world.ranks;
        let members = &world.groups[group].members;
        let member =
            |node: &Numbered| members.holds_node(node.0, world.grid.lattices[node.0].place(node.1));
        let all = listing.keys();
        let share = Share::of_range(all.clone(), ranks.size());
        let own = share.range(ranks.rank());
        let own = own.start.max(all.start)..own.end.min(all.end);
        let nodes: Vec<Numbered> = own.map(|key| listing.node(key)).filter(member).collect();
        let known = ranks.is_alone();
        let mut part = Self {
            columns: names.iter().map(|name| values(name, world, &nodes, known)).collect(),
            points: nodes.iter().map(|node| place(world, *node, known)).collect(),
            order: (0..nodes.len() as u32).collect(),
            part: Part::of(nodes.len(), ranks),
            nodes,
        };
        if !known {
            let active = active_nodes(world).filter(|node| {
                (listing.first..listing.first + listing.lattices.len()).contains(&node.0)
                    && member(node)
            });
            part.learn(world, listing, &share, &active.collect::<Vec<_>>(), names);
        }
        part
    }

    /// Takes what the processes know that have particles near the nodes; `active`: those of which
    /// this process knows.
    fn learn(
        &mut self,
        world: &World,
        listing: &Listing<'_>,
        share: &Share,
        active: &[Numbered],
        names: &[String],
    ) {
        let keys: Vec<u64> = active.iter().map(|node| listing.key(*node)).collect();
        let columns: Vec<Vec<f64>> =
            names.iter().map(|name| values(name, world, active, true)).collect();
        let count = columns.len();
        let number = |row: usize, column: usize| match columns.get(column) {
            Some(column) => column[row],
            None => place(world, active[row], true)[column - count],
        };
        let rows = Rows::deal(&world.ranks, share, &keys, count + 3, number);
        for row in 0..rows.len() {
            let key = rows.key(row);
            let place = self.nodes.binary_search_by_key(&key, |node| listing.key(*node));
            let Ok(place) = place else { continue };
            for (number, column) in self.columns.iter_mut().enumerate() {
                column[place] = rows.number(row, number);
            }
            self.points[place] = std::array::from_fn(|axis| rows.number(row, count + axis));
        }
    }

    fn table<'a>(
        &'a self,
        snapshot: &Snapshot<'_>,
        listing: &'a Listing<'a>,
        names: &'a [String],
        corners: [[f64; 2]; 3],
    ) -> Table<'a> {
        Table {
            step: snapshot.step,
            time: snapshot.time,
            corners,
            names,
            order: &self.order,
            id: Box::new(|row| listing.id(self.nodes[row])),
            kind: Box::new(|row| self.nodes[row].0 as u64 + 1),
            values: self.columns.iter().map(|column| Values::Slice(column)).collect(),
            point: Box::new(|row| self.points[row]),
            lattice: listing.lattices.first().filter(|_| listing.image),
            part: self.part,
        }
    }
}

/// The nodes with particles near them that this process counts.
fn active_nodes(world: &World) -> impl Iterator<Item = Numbered> {
    let grid = &world.grid;
    let active = grid.runs.iter().cloned().flatten().filter(|place| grid.counts(*place));
    active.map(|place| {
        let lattice = grid.places().lattice(place);
        (lattice, grid.lattices[lattice].window.node(place))
    })
}

/// Current place of a node \[L\]; as long as it is not `known` to this process, the reference place.
fn place(world: &World, (lattice, node): Numbered, known: bool) -> [f64; 3] {
    let lattice = &world.grid.lattices[lattice];
    match lattice.window.local(node).filter(|_| known) {
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

/// The column of a field; of nodes not `known` to this process, as there are no particles near them.
fn values(name: &str, world: &World, nodes: &[Numbered], known: bool) -> Vec<f64> {
    let grid = &world.grid;
    let each =
        |value: &dyn Fn(Numbered) -> f64| nodes.iter().map(|node| value(*node)).collect::<Vec<_>>();
    let active =
        |(lattice, node): Numbered| grid.lattices[lattice].window.local(node).filter(|_| known);
    let rigid =
        |node| active(node).and_then(|local| grid.rigid.get(local)).copied().unwrap_or_default();
    let axis = |names: [&str; 3]| names.iter().position(|known| *known == name);
    if let Some(axis) = axis(["x", "y", "z"]) {
        return each(&|node| place(world, node, known)[axis]);
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
        _ => vec![0.0; nodes.len()],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::domain::Domain;

    #[test]
    fn a_key_leads_back_to_its_node() {
        let cells = |lower| Domain { dimension: 3, lower, upper: [3.0, 2.0, 4.0], cell: 1.0 };
        let lattices = [cells([0.0; 3]), cells([1.0; 3])].map(|cells| Lattice::new(cells, 1));
        for image in [false, true] {
            let lattices = if image { &lattices[1..] } else { &lattices };
            let (first, before) = if image { (1, vec![60]) } else { (0, vec![0, 60]) };
            let listing = Listing { lattices, first, before, image };
            let nodes: Vec<Numbered> = listing.keys().map(|key| listing.node(key)).collect();
            assert_eq!(nodes.len(), if image { 24 } else { 84 });
            assert!(listing.keys().zip(&nodes).all(|(key, node)| listing.key(*node) == key));
            let (second, last) = if image { ([1, 0, 0], 84) } else { ([0, 0, 1], 84) };
            assert_eq!((nodes[1], listing.id(nodes[nodes.len() - 1])), ((first, second), last));
        }
    }

    #[test]
    fn node_types_at_both_ends() {
        let types: Vec<f64> = (0..6).map(|i| node_type(i, 6)).collect();
        assert_eq!(types, [-2.0, -1.0, 0.0, 0.0, 1.0, 2.0]);
    }
}
