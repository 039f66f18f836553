//! Dumps of particles.

use super::field::{Columns, Fields};
use super::lammps::{Part, Table, corners};
use super::series::{Format, Series};
use super::{BuildDump, Dump, DumpTarget, Snapshot};
use crate::fault::Fault;
use crate::fix::GroupKind;
use crate::model::checkpoint::Checkpoint;
use crate::model::group::GroupId;
use crate::plan::Plan;
use crate::script::arguments::Args;
use crate::script::diagnostic::{Code, Diagnostic};
use crate::style::Style;

const USAGE: &str = "field, ...";

const MANUAL: &str = "\
Fields: x y z x0 y0 z0 vx vy vz speed s11 s22 s33 s12 s13 s23 seq e11 e22 e33 e12 e13 e23 volume
mass damage damage_init bx by bz ep epdot T ienergy gamma F11 .. F33 J rho p radius, and the set
`ovito` with the names that OVITO knows: places, velocities, radius (half the edge of a cube of the
particle's volume), Orientation and AsphericalShape (boxes R, h/2 diag U with F = R U, which leave no
gaps), StressTensor, DeformationGradient; then seq, and ep, damage, T where a material has them.
Quantities the run does not have are 0.
With `axisymmetric` the index 1 is the radius, 2 the axis, 3 the hoop; mass and volume are per
radian, radius is sqrt(V/x)/2.
One file per snapshot if the name has a `*` (the step), otherwise one growing file.";

const VTK_MANUAL: &str = "\
The fields of `particle`, also the set `ovito`, as points in files *.vtp. Components become one
array: v, x0, b, s, e, F, and StressTensor, DeformationGradient, Orientation, AsphericalShape of the
set; x y z are the points; id and type are always there. A name with a `*` (the step) makes one file
per snapshot and `NAME.pvd`, the series with its times: `dump(d, all, particle/vtk, 100, rod.*.vtp,
vx, vy, vz, seq)` writes rod.0.vtp, rod.100.vtp, ... and rod.vtp.pvd, which ParaView opens. Without
`*` the file is replaced.";

const fn row(name: &'static str, summary: &'static str, build: BuildDump) -> Style<BuildDump> {
    Style { name, usage: USAGE, summary, manual: MANUAL, build: Some(build) }
}

/// The row of `particle`.
pub const TEXT: Style<BuildDump> =
    row("particle", "particles as LAMMPS text", |args, target| build(args, target, Format::Text));

/// The row of `particle/gz`.
pub const GZIP: Style<BuildDump> =
    row("particle/gz", "the same, compressed", |args, target| build(args, target, Format::Gzip));

/// The row of `particle/bin`.
pub const BINARY: Style<BuildDump> =
    row("particle/bin", "particles in LAMMPS's binary layout", |args, target| {
        build(args, target, Format::Binary)
    });

/// The row of `particle/vtk`.
pub const VTK: Style<BuildDump> = Style {
    manual: VTK_MANUAL,
    ..row("particle/vtk", "particles for ParaView", |args, target| {
        target.need_suffix("a file of points", &[".vtp"])?;
        build(args, target, Format::Vtk)
    })
};

fn build(
    args: &mut Args<'_>,
    target: &DumpTarget,
    format: Format,
) -> Result<Box<dyn Dump>, Diagnostic> {
    if target.kind == GroupKind::Nodes {
        let message = "a dump of particles needs `all` or a group of particles";
        return Err(Diagnostic::error(Code::GroupKind, target.group_span, message)
            .label("this is a group of nodes"));
    }
    let mut fields = Fields::default();
    loop {
        fields.add(args.word("a field")?)?;
        if args.remaining() == 0 {
            break;
        }
    }
    let series = Series::new(&target.file, format);
    Ok(Box::new(ParticleDump { group: target.group, fields, series }))
}

struct ParticleDump {
    group: GroupId,
    fields: Fields,
    series: Series,
}

impl Dump for ParticleDump {
    fn needs(&self, plan: &mut Plan, dimension: usize) {
        self.fields.needs(plan, dimension);
    }

    fn keep(&mut self, checkpoint: &mut Checkpoint) {
        self.series.keep(checkpoint);
    }

    fn write(&mut self, snapshot: &Snapshot<'_>) -> Result<Vec<String>, Fault> {
        let world = snapshot.world;
        let particles = &world.particles;
        let mut order: Vec<u32> =
            particles.of_group(&world.groups, self.group).map(|p| p as u32).collect();
        order.sort_unstable_by_key(|p| particles.id[*p as usize]);
        let (names, fields) = self.fields.of(world);
        let columns = Columns::new(world);
        let ranks = &world.ranks;
        let table = Table {
            step: snapshot.step,
            time: snapshot.time,
            corners: corners(world, particles.position.iter().map(|x| [x[0], x[1], x[2]])),
            names: &names,
            order: &order,
            id: Box::new(|p| u64::from(particles.id[p])),
            kind: Box::new(|p| u64::from(particles.solid[p]) + 1),
            values: fields.into_iter().map(|field| columns.values(field)).collect(),
            point: Box::new(|p| world.place(p)),
            lattice: None,
            part: Part { before: 0, all: order.len() },
        };
        let points = self.series.has_points();
        table
            .dealt_out(ranks, points, |table| self.series.write(ranks, std::slice::from_ref(table)))
    }
}
