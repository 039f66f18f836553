//! The program as a user meets it: exit codes, messages, files.

mod pictures;
mod place;
mod readers;
mod shell;

use assert_cmd::cargo::cargo_bin;
use place::{Place, stderr, stdout};
use std::process::Command;

#[test]
fn a_run_ends_with_0_and_a_log_that_readers_understand() {
    let place = Place::new("log_modify(custom, dt, time, Ek, dt_limit)\nset_output(3)\nrun(10)\n");
    let output = place.run(&["in.mpm"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let log = place.read("log.mpm");
    let lines: Vec<&str> = log.lines().collect();
    let header = lines.iter().position(|line| line.trim_start().starts_with("Step ")).unwrap();
    assert!(lines[header - 1].starts_with("Per MPI rank memory allocation (min/avg/max) = "));
    let rows: Vec<Vec<&str>> = lines[header + 1..]
        .iter()
        .take_while(|line| !line.starts_with("Loop time of "))
        .map(|line| line.split_whitespace().collect())
        .collect();
    let steps: Vec<&str> = rows.iter().map(|row| row[0]).collect();
    assert_eq!(steps, ["0", "3", "6", "9", "10"]);
    assert!(rows.iter().all(|row| row.len() == 5));
    assert!(!lines[..header].iter().any(|line| line.contains("Step ")));
}

#[test]
fn hats_that_particles_cross_are_warned_about_behind_the_times_of_the_run() {
    // 0.4 cells, then 0.6.
    let flight = |time: f64| {
        let v = "fix(v, initial_velocity_particles, all, 1, 0)\nset_dt(0.002)\n";
        let place = Place::new(&format!("{v}run_time({time})\n"));
        assert_eq!(place.run(&["in.mpm", "--quiet"]).status.code(), Some(0));
        place.read("log.mpm")
    };
    assert!(!flight(0.04).contains("warning: "));
    let log = flight(0.06);
    let of = |words: &str| log.find(words).unwrap_or_else(|| panic!("no `{words}` in {log}"));
    assert!(
        of("Loop time of ") < of("warning: particles have moved by up to 0.6 cells under hats")
    );
}

#[test]
fn a_dump_of_the_grid_shows_the_mass_of_the_body_in_every_scene() {
    // The second scene has a fix between two steps' stress and P2G.
    for fix in ["body_force, all, 0, -1", "velocity_particles, left, 0, -0.1"] {
        let place =
            Place::new(&format!("fix(f, {fix})\ndump(d, all, grid, 5, g.*.txt, mass)\nrun(5)\n"));
        assert_eq!(place.run(&["in.mpm", "--quiet"]).status.code(), Some(0));
        for name in ["g.0.txt", "g.5.txt"] {
            let text = place.read(name);
            let masses = text.lines().skip(11).map(|line| line.split(' ').next_back().unwrap());
            let sum: f64 = masses.map(|mass| mass.parse::<f64>().unwrap()).sum();
            // 52 particles of 1000 (0.1/2)^2.
            assert!((sum - 52.0 * 2.5).abs() < 1e-9, "{fix} {name}: {sum}");
        }
    }
}

#[test]
fn a_mistake_ends_with_2_and_writes_nothing() {
    let place =
        Place::new("dump(d, all, particle, 1, d.*.txt, x)\nrun(1)\nfix(f, grav, all, 0, 0)\n");
    let output = place.run(&["in.mpm"]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(place.files(), ["in.mpm"]);
    let text = stderr(&output);
    assert!(text.contains("error[E0203]: unknown fix style `grav`"), "{text}");
    assert!(text.contains("--> in.mpm:12:8"), "{text}");
}

#[test]
fn a_particle_that_leaves_the_box_ends_with_1_and_is_named() {
    let place = Place::new(
        "fix(v, initial_velocity_particles, all, 2, 0)\ndump(d, all, particle, 5, d.*.txt, x)\nrun_time(1)\n",
    );
    let output = place.run(&["in.mpm"]);
    assert_eq!(output.status.code(), Some(1));
    let text = stderr(&output);
    for part in
        ["left the box", "of solid `ball`", "step ", "time ", "likely cause", "kept: d.*.txt"]
    {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(place.read("log.mpm").contains("Step"));
    assert!(place.files().contains(&"d.0.txt".to_string()));
}

#[test]
fn a_time_step_far_too_large_is_warned_about_and_stops_itself() {
    let place = Place::new(
        "fix(v, initial_velocity_particles, all, 0.5*(y-0.5), 0.5*x)\nset_dt(0.3, force)\nrun(200)\n",
    );
    let output = place.run(&["in.mpm"]);
    assert_eq!(output.status.code(), Some(1), "{}", stdout(&output));
    let text = stderr(&output);
    assert!(text.contains("W0205") && text.contains("above the stable one"), "{text}");
}

#[test]
fn a_time_step_above_twice_the_stable_one_is_refused_unless_it_is_forced() {
    // The stable step is 0.9 h/c.
    for (part, code, words) in [
        ("1.7", 0, "W0205"),
        ("1.9", 2, "above twice the stable one"),
        ("1.9, force", 0, "W0205"),
        ("0.8", 0, ""),
    ] {
        let (factor, force) = part.split_once(',').unwrap_or((part, ""));
        let force = if force.is_empty() { "" } else { ", force" };
        let rest = format!("set_dt({factor}*0.1/sqrt(13.461538){force})\nrun(1)\n");
        let place = Place::new(&rest);
        let output = place.run(&["in.mpm"]);
        assert_eq!(output.status.code(), Some(code), "{part}: {}", stderr(&output));
        assert!(stderr(&output).contains(words), "{part}: {}", stderr(&output));
        assert!(code == 0 || stderr(&output).contains("acoustic limit"));
        assert_eq!(words.is_empty(), stderr(&output).is_empty(), "{part}: {}", stderr(&output));
    }
}

#[test]
fn an_energy_ledger_that_does_not_close_warns_or_stops() {
    let play = |bounds: &str| {
        let place = Place::new(&format!(
            "fix(v, initial_velocity_particles, all, 0.1*x, 0)\n\
             compute(W, energy_ledger, all, {bounds})\nset_output(1)\nrun(20)\n"
        ));
        let output = place.run(&["in.mpm"]);
        (output.status.code(), stderr(&output), place.read("log.mpm"))
    };
    let told = |text: &str| text.matches("the energy ledger is off by").count();
    let (code, errors, log) = play("warn_above, 1e-9");
    assert_eq!((code, told(&log)), (Some(0), 1), "{errors}");
    let (code, errors, log) = play("stop_above, 1e-9");
    assert_eq!((code, told(&errors), told(&log)), (Some(1), 1, 0), "{errors}");
    assert!(errors.contains("step ") && errors.contains("more than 1e-9"), "{errors}");
    // Both: the smaller bound does not hide the other.
    let (code, errors, _) = play("stop_above, 1e-5, warn_above, 1e-9");
    assert_eq!((code, told(&errors)), (Some(1), 1), "{errors}");
    let (code, errors, log) = play("stop_above, 10, warn_above, 1e-9");
    assert_eq!((code, told(&log)), (Some(0), 1), "{errors}");
    let (code, errors, log) = play("stop_above, 10, warn_above, 10");
    assert_eq!((code, told(&log)), (Some(0), 0), "{errors}");
}

#[test]
fn files_that_cannot_be_read_or_written_end_with_3() {
    let place = Place::new("dump(d, all, particle, 1, nowhere/d.*.txt, x)\nrun(1)\n");
    assert_eq!(place.run(&["in.mpm"]).status.code(), Some(3));
    let output = place.run(&["missing.mpm"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("missing.mpm"));
}

#[test]
fn a_directory_that_vanishes_during_a_run_stops_it_with_its_name() {
    let place = Place::new("dump(d, all, particle, 1, out/d.*.txt, x)\nrun(1000000)\n");
    let directory = place.0.path().join("out");
    std::fs::create_dir(&directory).unwrap();
    let mut command = place.command();
    command.args(["in.mpm", "--quiet"]).stderr(std::process::Stdio::piped());
    let child = command.spawn().unwrap();
    while !directory.join("d.3.txt").exists() {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    std::fs::rename(&directory, place.0.path().join("gone")).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("cannot write `out/d."), "{}", stderr(&output));
}

#[test]
fn an_interrupted_run_keeps_what_it_has_and_ends_with_130() {
    let place = Place::new("set_output(1)\nrun(100000000)\n");
    let mut child = place.command().args(["in.mpm", "--quiet"]).spawn().unwrap();
    let log = place.0.path().join("log.mpm");
    while std::fs::read_to_string(&log).map_or(0, |text| text.lines().count()) < 20 {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(place.read("log.mpm").contains("Loop time of"));
}

#[test]
fn without_arguments_usage_is_shown_and_the_status_is_2() {
    let place = Place::new("");
    let output = place.run(&[]);
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(stderr(&output).lines().count(), 3);
}

#[test]
fn several_processes_are_refused() {
    let place = Place::new("run(1)\n");
    let output = place.command().arg("in.mpm").env("OMPI_COMM_WORLD_SIZE", "4").output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("started as 4 processes"));
}

#[test]
fn variables_of_the_command_line_win() {
    let place = Place::new("n = 3\nrun(n)\n");
    let output = place.run(&["-in", "in.mpm", "-var", "n", "7", "-log", "none"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("for 7 steps"), "{}", stdout(&output));
    assert_eq!(place.files(), ["in.mpm"]);
}

#[test]
fn check_describes_the_run_and_writes_nothing() {
    let place = Place::new("dump(d, all, particle, 1, d.*.txt, x)\nrun(10)\n");
    let output = place.run(&["check", "in.mpm"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for part in ["particles", "bytes per particle", "temperature", "off:", "acoustic limit"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert_eq!(place.files(), ["in.mpm"]);
}

#[test]
fn styles_and_codes_are_explained() {
    let place = Place::new("");
    let output = place.run(&["styles", "material", "neo-hookean"]);
    assert!(stdout(&output).contains("material(ID, neo-hookean, rho, E, nu"));
    assert!(stdout(&place.run(&["explain", "E0203"])).contains("E0203"));
    assert_eq!(place.run(&["explain", "E9999"]).status.code(), Some(2));
    assert_eq!(place.run(&["styles", "matreial"]).status.code(), Some(2));
}

#[test]
fn a_reader_that_goes_away_is_no_panic() {
    let place = Place::new("run(2000)\n");
    let line = format!("'{}' in.mpm | head -n 1", cargo_bin!("karamelo-rs").display());
    let output =
        Command::new("sh").args(["-c", &line]).current_dir(place.0.path()).output().unwrap();
    assert!(!stderr(&output).contains("panicked"), "{}", stderr(&output));
}

#[test]
fn removed_particles_are_counted_in_the_log_and_told_by_check() {
    let rest = "boundary(delete)\nfix(up, initial_velocity_particles, all, 0, 6)\n\
        region(half, block, INF, 0.5, INF, INF)\ngroup(g, particles, region, half)\n\
        fix(down, initial_velocity_particles, g, 0, 0)\nset_dt(0.002)\nrun(60)\nrun(1)\n";
    let place = Place::new(rest);
    let check = place.run(&["check", "in.mpm"]);
    assert!(stdout(&check).contains("delete: particles that leave the box are removed"));
    let output = place.run(&["in.mpm"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let log = place.read("log.mpm");
    let counted = log.lines().find(|line| line.contains("left the box and were removed"));
    let removed: usize = counted.unwrap().split_whitespace().nth(1).unwrap().parse().unwrap();
    let left: Vec<usize> = log
        .lines()
        .filter(|line| line.starts_with("Loop time"))
        .map(|line| line.split_whitespace().rev().nth(1).unwrap().parse().unwrap())
        .collect();
    // A disk of radius 2 h holds 52 particles, four to a cell.
    assert!(removed > 10 && left == [52 - removed; 2], "{removed} {left:?}");
    assert_eq!(log.matches("were removed").count(), 1, "the second run has lost none");
}

#[test]
fn initial_stress_warns_where_it_does_nothing() {
    let rest = "material(gum, neo-hookean, 1000, 1e4, 0.3)\nregion(other, sphere, 0.2, 0.2, 0.1)\n\
        solid(gummy, region, other, 2, gum, h)\ngroup(right, particles, region, other)\n\
        fix(s, initial_stress, GROUP, 1, 0, 0, 0, 0, 0)\nrun(1)\n";
    for (group, count) in [("all", 1), ("right", 1), ("left", 0)] {
        let place = Place::new(&rest.replace("GROUP", group));
        let found = stderr(&place.run(&["in.mpm"]));
        assert_eq!(found.matches("warning[W0206]").count(), count, "{group}: {found}");
        assert_eq!(found.matches("in solid `gummy`").count(), count, "{group}: {found}");
    }
}

#[test]
fn files_are_found_in_the_working_directory_or_beside_the_script() {
    let place = Place::new("solid(more, file, dots.txt, rubber, h)\nrun(1)\n");
    let missing = place.run(&["in.mpm"]);
    assert_eq!(missing.status.code(), Some(3));
    assert!(stderr(&missing).contains("error[E0401]: cannot read `dots.txt`"));
    std::fs::write(place.0.path().join("dot.txt"), "0.1 0.1 0.001\n").unwrap();
    assert!(stderr(&place.run(&["in.mpm"])).contains("did you mean `dot.txt`?"));
    std::fs::write(place.0.path().join("dots.txt"), "0.1 0.1 0.001\n").unwrap();
    assert_eq!(place.run(&["in.mpm"]).status.code(), Some(0));
    let elsewhere = tempfile::tempdir().unwrap();
    let script = place.0.path().join("in.mpm");
    let output =
        place.command().current_dir(elsewhere.path()).arg("check").arg(script).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("53 in 2 solids"), "{}", stdout(&output));
}
