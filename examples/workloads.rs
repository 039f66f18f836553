//! How many steps a second: the workloads of two papers, `cargo run --release --example workloads`.
//!
//! Tables 3 to 5 of Sinaie, Nguyen, Nguyen, Bordas 2017 (Julia): two disks, a cantilever of tetrahedra,
//! a disk of steel into aluminium. Wyser, Alkhimenkov, Jaboyedoff, Podladchikov 2020 (fMPMM, MATLAB): a
//! slumping slope and a cantilever with more and more particles. One thread; CPU time where the system tells
//! it (Linux), else by the clock. A word tells which rows to play: those whose names contain it.

use karamelo::command::play::{perform, rehearse};
use karamelo::command::session::{Mode, Session};
use karamelo::output::{OutputOptions, Outputs};
use karamelo::script::diagnostic::{Severity, render};
use karamelo::script::source::Source;
use karamelo::simulation::Until;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

/// A row: its name, where its script lies and what is run of it, variables, and steps.
struct Row {
    name: String,
    file: String,
    text: String,
    variables: Vec<(&'static str, f64)>,
    steps: u64,
}

/// The two disks of table 3, `cells` along the box and `ppc` particles per cell and axis.
fn disks(cells: u32, ppc: u32) -> Row {
    let text = format!(
        "h = 1/{cells}
method(ulmpm, FLIP, linear, 1)
dimension(2, -0.5, 0.5, -0.5, 0.5, h)
region(r1, cylinder, -0.3, -0.3, 0.2)
region(r2, cylinder, 0.3, 0.3, 0.2)
material(matter, linear, 1000, 1000, 0.3)
solid(s1, region, r1, {ppc}, matter, h)
solid(s2, region, r2, {ppc}, matter, h)
group(g1, particles, region, r1, solid, s1)
group(g2, particles, region, r2, solid, s2)
fix(v1, initial_velocity_particles, g1, 0.1, 0.1)
fix(v2, initial_velocity_particles, g2, -0.1, -0.1)
set_dt(0.001)
run(1)
"
    );
    let name = format!("Julia, table 3: disks, {cells} x {cells} cells, {ppc} x {ppc} in a cell");
    Row { name, file: String::new(), text, variables: Vec::new(), steps: 3000 }
}

/// A scene of `inputs` with the method `method(...)`, without its outputs, after one step.
fn scene(name: String, file: &str, method: &str, variables: &[(&'static str, f64)]) -> Row {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs").join(file);
    let text = std::fs::read_to_string(&path).unwrap_or_default();
    let lines = text.lines().filter_map(|line| {
        let word = line.split('(').next().unwrap_or_default();
        match word {
            "dump" | "plot" | "save_plot" | "log_modify" | "compute" => None,
            "run_time" | "run" => Some("run(1)".to_string()),
            "method" if !method.is_empty() => Some(format!("method({method})")),
            _ => Some(line.to_string()),
        }
    });
    let text = lines.collect::<Vec<_>>().join("\n") + "\n";
    let file = path.display().to_string();
    Row { name, file, text, variables: variables.to_vec(), steps: 1000 }
}

/// All rows.
fn rows() -> Vec<Row> {
    let mut rows: Vec<Row> =
        [(20, 2), (20, 4), (40, 2), (80, 4)].map(|(cells, ppc)| disks(cells, ppc)).into();
    for cells in [16.0, 32.0, 64.0] {
        let name = format!("Julia, table 4: cantilever, {cells} x {} x {cells} cells", cells / 8.0);
        let mut row = scene(name, "cantilever/cantilever-3d.mpm", "", &[("cells", cells)]);
        row.text = row.text.replace("dt_factor(0.3)", "set_dt(2.5e-4)");
        rows.push(row);
    }
    for h in [1.2, 0.8] {
        let name = format!("Julia, table 5: disk into aluminium, cells of {h} mm");
        rows.push(scene(name, "disk-impact/disk-impact.mpm", "", &[("h", h)]));
    }
    for h in [2.0, 1.0, 0.5] {
        let name = format!("fMPMM: slump, uGIMP, cells of {h} m");
        let method = "ulmpm, FLIP, gimp, 1";
        rows.push(scene(name, "slope-slump/slope-slump.mpm", method, &[("h", h)]));
    }
    for h in [0.25, 0.125, 0.0625] {
        let name = format!("fMPMM: cantilever, CPDI2q, cells of {h} m");
        let method = "ulcpdi, FLIP, linear, 1, Q4";
        rows.push(scene(name, "cantilever/cantilever.mpm", method, &[("h", h)]));
    }
    rows
}

/// Number of particles and steps per second of a row.
fn play(row: &Row) -> Result<(usize, f64), String> {
    let variables: Vec<(String, String)> =
        row.variables.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
    let (script, found) = rehearse(Source::new(row.file.clone(), &row.text), &variables);
    let mistakes: Vec<_> =
        found.into_iter().filter(|remark| remark.severity == Severity::Error).collect();
    if !mistakes.is_empty() {
        return Err(render(&mistakes, &script.source, false));
    }
    let title = row.name.clone();
    let options = OutputOptions { quiet: true, log: None, title, mute: false };
    let mut session = Session::new(Outputs::new(options), Mode::Run);
    perform(&script, &mut session).map_err(|_| "the first step failed".to_string())?;
    let (clock, cpu) = (Instant::now(), cpu_time());
    session.simulation.run(Until::Steps(row.steps)).map_err(|fault| fault.to_string())?;
    let spent = cpu.zip(cpu_time()).map(|(before, after)| after - before);
    // CPU time comes in hundredths of a second.
    let spent = spent.filter(|spent| *spent > 0.0).unwrap_or(clock.elapsed().as_secs_f64());
    Ok((session.simulation.world.particles.len(), row.steps as f64 / spent))
}

/// CPU time of this process so far \[s\], where there is a `/proc`: user and system time in ticks of a
/// hundredth of a second, fields 14 and 15.
fn cpu_time() -> Option<f64> {
    let line = std::fs::read_to_string("/proc/self/stat").ok()?;
    // The second field is a name in parentheses that may contain blanks.
    let fields: Vec<&str> = line.rsplit(')').next()?.split_whitespace().collect();
    let ticks = |field: usize| fields.get(field - 3)?.parse::<f64>().ok();
    Some((ticks(14)? + ticks(15)?) / 100.0)
}

/// The name of the processor, where the system tells it.
fn processor() -> String {
    let information = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let line = information.lines().find(|line| line.starts_with("model name"));
    let name = line.and_then(|line| line.split(':').nth(1)).map(|name| name.trim().to_string());
    name.unwrap_or_else(|| format!("unknown {} processor", std::env::consts::ARCH))
}

fn main() -> ExitCode {
    let wanted = std::env::args().nth(1).unwrap_or_default();
    let _ = rayon::ThreadPoolBuilder::new().num_threads(1).build_global();
    println!("{}, one thread", processor());
    println!("{:<64}{:>10}{:>14}{:>10}", "", "particles", "steps/s", "M p-s/s");
    let mut all_well = true;
    for row in rows().iter().filter(|row| row.name.contains(&wanted)) {
        match play(row) {
            Ok((particles, speed)) => {
                let work = speed * particles as f64 / 1e6;
                println!("{:<64}{particles:>10}{speed:>14.0}{work:>10.2}", row.name);
            }
            Err(reason) => {
                all_well = false;
                eprintln!("{}: {reason}", row.name);
            }
        }
    }
    if all_well { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
