//! Scenes as scripts of this program and of Karamelo.

use crate::input;
use std::fmt::Write;

/// Whose script language.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Dialect {
    /// This program's.
    Ours,
    /// Karamelo's.
    Karamelo,
}

/// Timed, or smaller: to count instructions, and for `--quick`.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Size {
    /// As in the table.
    Full,
    /// Some thousand particles.
    Small,
}

/// The statements that define the material `matter`, in both dialects.
pub struct Matter {
    ours: &'static str,
    karamelo: &'static str,
}

/// Young's modulus and density 1024, Poisson's ratio 3/8.
pub const ELASTIC: Matter = Matter {
    ours: "material(matter, linear, 1024, 1024, 0.375)",
    karamelo: "material(matter, linear, 1024, 1024, 0.375)",
};

/// What is run. Literals are short binary fractions where both programs must agree in all digits:
/// Karamelo reads numbers as float32.
pub enum Scene {
    /// A square or cube, two particles per cell and axis, shaken by a shear; constant time step.
    Block {
        dimension: usize,
        method: &'static str,
        shape: &'static str,
        matter: &'static Matter,
        /// Along an edge, in full size and small.
        cells: [u32; 2],
    },
    /// A script of `inputs/` with such a block, as users run it. Not for Karamelo.
    Input { dimension: usize, file: &'static str, cells: [u32; 2] },
    /// The two disks of the Karamelo paper, without dumps. Its literals are no binary fractions.
    Disks,
}

impl Scene {
    /// Number of particles.
    pub fn particles(&self, size: Size) -> u64 {
        match self {
            Scene::Block { dimension, cells, .. } | Scene::Input { dimension, cells, .. } => {
                u64::from(2 * cells[size as usize]).pow(*dimension as u32)
            }
            Scene::Disks => 416,
        }
    }

    /// The script of a run of so many steps; `None` if the dialect has no words for it.
    pub fn script(&self, size: Size, steps: u32, dialect: Dialect) -> Option<String> {
        let mut text = match self {
            Scene::Input { file, cells, .. } => {
                return (dialect == Dialect::Ours)
                    .then(|| input::text(file, cells[size as usize], steps));
            }
            Scene::Block { dimension, method, shape, matter, cells } => {
                let cells = cells[size as usize];
                block(*dimension, [method, shape], matter, cells, dialect)
            }
            Scene::Disks => disks(dialect),
        };
        // Karamelo shows no last row of its own accord.
        let every = if dialect == Dialect::Ours { 0 } else { steps };
        let _ = write!(
            text,
            "compute(Ek, kinetic_energy, all)
compute(Es, strain_energy, all)
log_modify(custom, step, dt, time, Ek, Es)
set_output({every})
run({steps})
"
        );
        Some(text)
    }
}

/// Karamelo has no objective rate, and in UL is compared with none.
fn rate(dialect: Dialect) -> &'static str {
    if dialect == Dialect::Ours { "stress_rate(none)\n" } else { "" }
}

/// Arguments that only Karamelo wants: the temperature of a solid, the third component in a plane.
fn extra(dialect: Dialect, word: &'static str) -> &'static str {
    if dialect == Dialect::Karamelo { word } else { "" }
}

fn block(
    dimension: usize,
    [method, shape]: [&str; 2],
    matter: &Matter,
    cells: u32,
    dialect: Dialect,
) -> String {
    // An edge between 1 and 2, waves of speed 1.35, so that a wave passes 2/3 of a cell in a step.
    let h = 0.5_f64.powi(cells.ilog2() as i32);
    let edge = f64::from(cells) * h;
    let each = |lower: f64, upper: f64| vec![format!("{lower}, {upper}"); dimension].join(", ");
    // A turning shear about the middle: the fastest particle moves 1/50 of a cell in a step.
    let shear = |axis: &str| format!("0.03125*{axis}-{}", 0.015625 * edge);
    let axes: &[&str] = if dimension == 2 { &["y", "x"] } else { &["y", "z", "x"] };
    let velocity: Vec<String> = axes.iter().map(|axis| shear(axis)).collect();
    let rate = if method == "ulmpm" { rate(dialect) } else { "" };
    format!(
        "method({method}, FLIP, {shape}, 1)
{rate}dimension({dimension}, {domain}, {h})
region(body, block, {body})
{matter}
solid(block, region, body, 2, matter, {h}{temperature})
fix(shake, initial_velocity_particles, all, {velocity}{third})
set_dt({dt})
",
        domain = each(-4.0 * h, edge + 4.0 * h),
        body = each(0.0, edge),
        matter = if dialect == Dialect::Ours { matter.ours } else { matter.karamelo },
        temperature = extra(dialect, ", 0"),
        velocity = velocity.join(", "),
        third = if dimension == 2 { extra(dialect, ", NULL") } else { "" },
        dt = 0.5 * h,
    )
}

fn disks(dialect: Dialect) -> String {
    let [temperature, third] = [extra(dialect, ", 0"), extra(dialect, ", NULL")];
    let rate = rate(dialect);
    let mut text = format!(
        "method(ulmpm, FLIP, linear, 1)
{rate}dimension(2, -0.5, 0.5, -0.5, 0.5, 0.05)
material(matter, linear, 1000, 1000, 0.3)
set_dt(0.01)
"
    );
    for (disk, centre, speed) in [("lower", -0.3, 0.1), ("upper", 0.3, -0.1)] {
        let _ = write!(
            text,
            "region({disk}Region, cylinder, {centre}, {centre}, 0.2)
solid({disk}, region, {disk}Region, 2, matter, 0.05{temperature})
group({disk}Particles, particles, region, {disk}Region, solid, {disk})
fix({disk}Start, initial_velocity_particles, {disk}Particles, {speed}, {speed}{third})
"
        );
    }
    text
}
