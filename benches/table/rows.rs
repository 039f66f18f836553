//! The cases of the table: a row is one line.

use crate::scene::{ELASTIC, Scene};

/// What a row is held to.
#[derive(Clone, Copy)]
pub enum Goal {
    /// At least so many million particle-steps per second of CPU time, one thread, without set-up.
    Speed(f64),
    /// Two threads at least so many times as fast as one, by the clock, without set-up.
    SpeedUp(f64),
    /// At most so many milliseconds of CPU time for the whole process.
    Whole(f64),
}

/// A case.
pub struct Row {
    /// What `--case` looks for.
    pub name: &'static str,
    /// What is run.
    pub scene: Scene,
    /// Steps that are timed.
    pub steps: u32,
    /// What is expected of it.
    pub goal: Goal,
    /// Most instructions per particle-step, if there is such a bound.
    pub budget: Option<u64>,
}

const fn row(name: &'static str, scene: Scene, steps: u32, goal: Goal, budget: Option<u64>) -> Row {
    Row { name, scene, steps, goal, budget }
}

/// An elastic block; `cells` along an edge when timed and when instructions are counted.
const fn block(
    dimension: usize,
    method: &'static str,
    shape: &'static str,
    cells: [u32; 2],
) -> Scene {
    Scene::Block { dimension, method, shape, matter: &ELASTIC, cells }
}

/// A script of `inputs/`: adaptive time step, Jaumann rate.
const fn input(dimension: usize, file: &'static str, cells: [u32; 2]) -> Scene {
    Scene::Input { dimension, file, cells }
}

const HAT: &str = "linear";
const QUADRATIC: &str = "quadratic-spline";
const CUBIC: &str = "cubic-spline";

/// All cases. The blocks have `set_dt` and no objective rate: the work that Karamelo does, too.
#[rustfmt::skip]
pub const ROWS: &[Row] = &[
    row("3-D UL linear", block(3, "ulmpm", HAT, [21, 10]), 200, Goal::Speed(22.0), Some(550)),
    row("3-D UL quadratic", block(3, "ulmpm", QUADRATIC, [21, 8]), 100, Goal::Speed(9.0), None),
    row("3-D UL cubic", block(3, "ulmpm", CUBIC, [21, 8]), 60, Goal::Speed(5.0), Some(2300)),
    row("2-D UL linear", block(2, "ulmpm", HAT, [136, 45]), 400, Goal::Speed(42.0), Some(320)),
    row("2-D UL cubic", block(2, "ulmpm", CUBIC, [136, 30]), 160, Goal::Speed(17.0), Some(800)),
    row("3-D TL linear", block(3, "tlmpm", HAT, [21, 10]), 160, Goal::Speed(14.0), Some(1150)),
    row("block.mpm", input(3, "block.mpm", [21, 10]), 160, Goal::Speed(22.0), Some(550)),
    row("square.mpm", input(2, "square.mpm", [136, 45]), 160, Goal::Speed(42.0), Some(320)),
    row("copper-block.mpm", input(3, "copper-block.mpm", [21, 10]), 80, Goal::Speed(17.0), Some(900)),
    row("two threads, 74 k", block(3, "ulmpm", HAT, [21, 10]), 200, Goal::SpeedUp(1.6), None),
    row("two threads, 1 M", block(3, "ulmpm", HAT, [50, 12]), 20, Goal::SpeedUp(1.8), None),
    row("two disks", Scene::Disks, 350, Goal::Whole(12.0), None),
];
