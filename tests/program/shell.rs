//! `new`, `diff`, completions, man page, explanations.

use super::place::{Place, SCENE, stderr, stdout};
use std::path::Path;
use std::process::Command;

fn is_installed(program: &str) -> bool {
    Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success())
}

#[test]
fn new_scripts_are_silent_in_check_and_run_to_their_end() {
    // A tenth of the time, or less.
    let shorter = [
        ("drop", "T_end", "0.05"),
        ("impact", "T_end", "0.004"),
        ("tension", "strain_end", "0.001"),
    ];
    for (template, name, value) in shorter {
        let place = Place::of("other.mpm", "");
        let wrote = place.run(&["new", "first-try", "--template", template]);
        assert_eq!(wrote.status.code(), Some(0), "{}", stderr(&wrote));
        assert!(stdout(&wrote).starts_with("wrote first-try.mpm"));
        assert!(!place.read("first-try.mpm").contains("NAME."));
        let check = place.run(&["check", "first-try.mpm"]);
        assert_eq!((check.status.code(), stderr(&check).as_str()), (Some(0), ""), "{template}");
        assert!(!stdout(&check).contains("units?"), "{}", stdout(&check));
        let run = place.run(&["first-try.mpm", "-var", name, value]);
        assert_eq!(run.status.code(), Some(0), "{template}: {}", stderr(&run));
        let files = place.files();
        for part in ["first-try.svg", "log.mpm", ".png"] {
            assert!(files.iter().any(|file| file.ends_with(part)), "{template}: {files:?}");
        }
    }
}

#[test]
fn new_never_writes_over_a_file() {
    let place = Place::of("a.mpm", "mine");
    let output = place.run(&["new", "a"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("cannot write `a.mpm`"), "{}", stderr(&output));
    assert_eq!(place.read("a.mpm"), "mine");
    assert_eq!(place.run(&["new", "a b"]).status.code(), Some(2));
    assert_eq!(place.run(&["new", "b", "--template", "nothing"]).status.code(), Some(2));
    assert_eq!(place.files(), ["a.mpm"]);
}

const OUTPUTS: &str = "fix(v, initial_velocity_particles, all, 0.1, 0.2)
dump(a, all, particle, 10, p.*.dump, x, y, vx)
dump(b, all, particle/gz, 10, p.*.dump.gz, x, y, vx)
dump(c, all, particle/bin, 10, all.bin, x, y, vx)
log_modify(custom, dt, time, Ek, dt_limit)
set_output(5)
PUSH
run(30)
";

/// Two runs of a script in the folders `a` and `b`; the second one pushes a particle in step 20.
fn two_runs(push: &str) -> Place {
    let place = Place::of("in.mpm", "");
    for (folder, push) in [("a", ""), ("b", push)] {
        std::fs::create_dir(place.0.path().join(folder)).unwrap();
        place.write(
            &format!("{folder}/in.mpm"),
            &format!("{SCENE}{}", OUTPUTS.replace("PUSH", push)),
        );
        let mut command = place.command();
        command.current_dir(place.0.path().join(folder));
        assert!(command.args(["in.mpm", "--quiet"]).status().unwrap().success());
    }
    place
}

#[test]
fn equal_runs_are_alike() {
    let place = two_runs("");
    let output = place.run(&["diff", "a", "b"]);
    assert_eq!(output.status.code(), Some(0), "{}", stdout(&output));
    assert_eq!(stdout(&output), "alike: 10 logs and dumps\n");
}

#[test]
fn runs_that_part_are_told_apart_by_step_column_and_particle() {
    // 1e-6 of the velocity, from the step after 20 on.
    let place = two_runs("run(20)\nfix(w, body_force, left, 1e-3, 0)");
    let output = place.run(&["diff", "a", "b"]);
    let told = stdout(&output);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.contains("p.30.dump: step 30, id 1, column x: "), "{told}");
    assert!(told.contains("all.bin: step 30, id 1, column x: "), "{told}");
    assert!(told.contains("log.mpm: step"), "{told}");
    assert!(told.contains("numbers differ then"), "{told}");
    assert!(!told.contains("p.20.dump"), "{told}");
    let loose = place.run(&["diff", "a/p.30.dump", "b/p.30.dump", "--tolerance", "0.5"]);
    assert_eq!(loose.status.code(), Some(0), "{}", stdout(&loose));
}

#[test]
fn diff_names_what_is_missing_or_unreadable() {
    let place = two_runs("");
    std::fs::remove_file(place.0.path().join("b/p.10.dump")).unwrap();
    let output = place.run(&["diff", "a", "b"]);
    assert_eq!(output.status.code(), Some(1));
    assert!(stdout(&output).contains("p.10.dump: is not in `b`"), "{}", stdout(&output));
    assert_eq!(place.run(&["diff", "a", "nowhere"]).status.code(), Some(3));
    assert_eq!(place.run(&["diff", "a"]).status.code(), Some(2));
    assert_eq!(place.run(&["diff", "a", "b", "--tolerance", "-1"]).status.code(), Some(2));
    let scripts = place.run(&["diff", "a/in.mpm", "b/in.mpm"]);
    assert_eq!(scripts.status.code(), Some(1), "{}", stdout(&scripts));
}

#[test]
fn completions_and_man_page_name_every_command() {
    let place = Place::of("in.mpm", "");
    let commands = ["check", "new", "diff", "study", "verify", "styles", "explain"];
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let text = stdout(&place.run(&["completions", shell]));
        assert!(commands.iter().all(|command| text.contains(command)), "{shell}");
        place.write(&format!("complete.{shell}"), &text);
    }
    for shell in ["bash", "zsh", "fish"] {
        if is_installed(shell) {
            let file = place.0.path().join(format!("complete.{shell}"));
            let checked = Command::new(shell).arg("-n").arg(file).output().unwrap();
            assert!(checked.status.success(), "{shell}: {}", stderr(&checked));
        } else {
            println!("not tested: {shell} is not installed");
        }
    }
    let man = stdout(&place.run(&["man"]));
    assert!(man.contains(".TH karamelo\\-rs 1") || man.contains(".TH karamelo-rs 1"), "{man}");
    assert!(commands.iter().all(|command| man.contains(command)), "{man}");
}

#[test]
fn every_code_that_is_known_is_explained() {
    let place = Place::of("in.mpm", "");
    for code in karamelo::script::diagnostic::Code::ALL {
        let output = place.run(&["explain", code.number()]);
        assert_eq!(output.status.code(), Some(0), "{}", code.number());
        assert!(stdout(&output).starts_with(code.number()) && stdout(&output).lines().count() > 2);
    }
}

/// Every script of `inputs`.
fn inputs() -> Vec<std::path::PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs");
    let below = |folder: &Path| -> Vec<std::path::PathBuf> {
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect()
    };
    let mut scripts = below(&folder);
    for path in scripts.clone().iter().filter(|path| path.is_dir()) {
        scripts.extend(below(path));
    }
    scripts.retain(|path| path.extension().is_some_and(|suffix| suffix == "mpm"));
    scripts
}

#[test]
fn units_that_do_not_fit_are_told_and_those_of_the_inputs_do() {
    let steel = |stiffness: &str, gravity: &str| {
        let scene = SCENE.replace("1000, 1e4", &format!("7.85e-9, {stiffness}"));
        let place = Place::of(
            "in.mpm",
            &format!("{scene}fix(g, body_force, all, 0, -{gravity})\nrun(1)\n"),
        );
        let told = stdout(&place.run(&["check", "in.mpm"]));
        told.lines().find(|line| line.starts_with("units?")).unwrap_or("").to_string()
    };
    assert_eq!(steel("210e3", "9810"), "");
    assert!(steel("210e3", "9.81").contains("mm, t, s (MPa), where gravity is 9806.65, not 9.81"));
    assert!(steel("210e9", "9810").contains("its stiffness"));
    let scripts = inputs();
    assert!(scripts.len() >= 25);
    let place = Place::of("in.mpm", "");
    for script in scripts {
        let output = place.command().arg("check").arg(&script).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}: {}", script.display(), stderr(&output));
        assert!(!stdout(&output).contains("units?"), "{}: {}", script.display(), stdout(&output));
    }
}
