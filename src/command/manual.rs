//! Manual entries of commands that have no file of their own.

pub const METHOD: &str = "\
type: `ulmpm`, `tlmpm`, `ulcpdi`, `tlcpdi`. sub: a transfer; XPIC is followed by its number of terms.
shape: a shape function, `linear` with particle domains. alpha, for FLIP, AFLIP and ASFLIP: a number in
[0, 1], 1 damps nothing; or the words `time-constant, tau`. Options, in any order: `mechanical`
(default) or `thermo-mechanical` (heat is conducted), `gradient-enhanced`, the particle domain (`R4`, in
3-D `R8`, unless given).
  method(ulmpm, FLIP, cubic-spline, 0.99)
  method(tlmpm, APIC, linear)
  method(ulcpdi, FLIP, linear, 1, Q4)";

pub const SCHEME: &str = "Default: musl. Before the first run.";

pub const DIMENSION: &str = "\
d = 1, 2 (plane strain, or `axisymmetric`) or 3. `ulmpm`: one grid of cubes of size h from the lower
corner, as many as cover the box; the last may pass it. `tlmpm`: every solid has a grid of its own
cell size, and the box is for outputs alone.
  dimension(2, 0, 1, 0, 0.5, 0.01)";

pub const STRESS_RATE: &str = "\
For laws that add up stress, in updated Lagrangian methods: how the stored stress turns with the body.
Default: jaumann. `none` does not turn it, which is wrong in every body that does. In `tlmpm` always
Green-Naghdi.";

pub const ANTI_LOCKING: &str = "\
`fbar`: the volumetric part of L is averaged by way of the nodes, theta_I = sum N m tr L/m_I,
L <- L + (sum N theta - tr L)/d I. For nearly incompressible bodies on hats.";

pub const REGION: &str = "\
Regions select points; they never change the box, and may lie outside of it.
  region(disk, cylinder, 0, 0, 0.2)
  region(floor, block, INF, INF, INF, h/4)
  region(ring, difference, disk, hole)";

pub const MATERIAL: &str = "\
Stands before the solids that are made of it.
  material(rubber, neo-hookean, 1000, 1e6, 0.4)
  material(copper, eos-strength, pressure, flow, heat)";

pub const GROUP: &str = "\
Members are found once, by their reference places, in the solids that are named (default: all).
The group `all` is there from the start. A second `group` of the same ID adds members. Nodes of
`ulmpm` belong to the one grid, whatever solids are named, unless `contact` gives solids nodes of
their own.
  group(left_half, particles, region, left, solid, ball)
  group(walls, nodes, region, border)";

pub const FIX: &str = "\
Values may be formulas of time and place; NULL leaves a component alone. As many components as there
are dimensions; more are ignored. Publishes ID_x, ID_y, ID_z, ID_s, 0 where it reports nothing. A fix
of the same ID replaces this one if a run lies between.
  fix(weight, body_force, all, 0, -9.81)
  fix(shake, velocity_nodes, floor, 0.1*sin(20*time), 0)";

pub const COMPUTE: &str = "\
Computed when something reads it, at most once per step.
  compute(Ek, kinetic_energy, all)";

pub const SET_DT: &str = "\
A number is used from then on, with a warning if it is above the stable step, which names the limit;
above twice the stable step the run is refused, unless `force` stands behind the number. `auto` (default):
the largest stable step times `dt_factor`.";

pub const DT_FACTOR: &str = "\
f > 0, above 1 with a warning. Smaller steps cost time and make FLIP with a fixed alpha damp faster.";

pub const RUN_TIME: &str = "\
The last step is shortened to land on the end. Runs may follow each other; what lies between acts.";

pub const CONDITION: &str = "\
Tested before each step: a formula of time, results and group functions; 0 is false.
  run_while(time < 1 && Ek > 0.01)";

pub const LOG_MODIFY: &str = "\
Names: step, dt, time, dt_limit (what limits dt, a word), variables, results. step always comes first.
default: step, dt, time.
  log_modify(custom, step, time, Ek, wall_x)";

pub const DUMP: &str = "\
At step 0, at every Nth step, and at the end of a run if N divides it. `*` in the file name becomes the
step; without it one file grows. Directories must be there. gz and bin by the style.
  dump(p, all, particle/gz, 100, out.*.dump.gz, ovito, ep)
  dump(s, all, pyplot, 100, picture.*.png, 800, 600)";

pub const PLOT: &str = "\
Samples two names every N steps, for the figure of `save_plot`.
  plot(energy, 10, time, Ek)";

pub const SAVE_PLOT: &str = "\
.pdf, .png, .svg or .csv (the numbers), written at the end of every run. Without it: plot.pdf.";

pub const PRINT: &str = "\
The expression as written and its value of now, or a text in quotes.
  print(3*value(Ek))";
