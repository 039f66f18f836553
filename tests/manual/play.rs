//! Runs the snippets of a page, in order, in one folder.
//!
//! | block | what is done |
//! | --- | --- |
//! | `console` | each line after `$ ` is run by a shell and must print what follows it; `exit=N`: it ends with N |
//! | `... file=NAME` | the text becomes a file of the folder |
//! | `diff file=NAME` | lines of that file are replaced |
//! | `mpm after=NAME` | the text, below that file, is run for one step |
//! | `mpm exit=2` | the same alone or below a file, and must fail |
//! | `console mpi` | only with feature `mpi` and an `mpirun`; `serial`: only without |
//! | `console needs=MODULE` | only where Python has the module |

use super::compare::compare;
use super::page::{Block, Page};
use super::{pages, root};
use assert_cmd::cargo::cargo_bin;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use tempfile::TempDir;

/// The folder in which the snippets of one page are run.
struct Place {
    folder: TempDir,
    path: std::ffi::OsString,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        copy(&root().join("inputs"), &folder.path().join("inputs"));
        let program = cargo_bin!("karamelo-rs");
        let mut path =
            vec![program.parent().unwrap().to_path_buf(), root().join("target/readers/bin")];
        path.extend(std::env::split_paths(&std::env::var_os("PATH").unwrap_or_default()));
        Self { folder, path: std::env::join_paths(path).unwrap() }
    }

    fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs a line of a shell; what it prints and what it complains about are one text.
    fn shell(&self, line: &str) -> (String, Option<i32>) {
        let mut command = Command::new("sh");
        command.args(["-c", &format!("exec 2>&1\n{line}")]);
        command.current_dir(self.folder.path()).env("PATH", &self.path);
        // As root, and with more processes than cores, Open MPI wants to be told.
        for (name, value) in [
            ("OMPI_ALLOW_RUN_AS_ROOT", "1"),
            ("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1"),
            ("OMPI_MCA_rmaps_base_oversubscribe", "1"),
        ] {
            command.env(name, value);
        }
        let Output { stdout, status, .. } = command.output().unwrap();
        (String::from_utf8_lossy(&stdout).into_owned(), status.code())
    }

    fn can(&self, line: &str) -> bool {
        self.shell(line).1 == Some(0)
    }

    /// Runs the lines of a block that begin with `$ ` and compares what they print.
    fn console(&self, block: &Block) -> Result<(), String> {
        let status: i32 = block.value("exit").map_or(0, |word| word.parse().unwrap());
        for call in block.text.split("$ ").skip(1) {
            // A line ends where no backslash stands at its end.
            let mut line = String::new();
            let mut rest = call;
            loop {
                let (first, others) = rest.split_once('\n').unwrap_or((rest, ""));
                line.push_str(first);
                rest = others;
                if !first.ends_with('\\') {
                    break;
                }
                line.push('\n');
            }
            let (found, code) = self.shell(&line);
            if code != Some(status) {
                return Err(format!("$ {line}\nended with {code:?}, not {status}\n{found}"));
            }
            compare(rest, &found).map_err(|why| format!("$ {line}\n{why}"))?;
        }
        Ok(())
    }

    /// Runs a script of the page below another one.
    fn script(&self, block: &Block) -> Result<(), String> {
        let mut text = String::new();
        if let Some(name) = block.value("after") {
            text =
                std::fs::read_to_string(self.file(name)).map_err(|why| format!("{name}: {why}"))?;
        }
        let status: i32 = block.value("exit").map_or(0, |word| word.parse().unwrap());
        let _ = write!(text, "{}\nrun(1)\n", block.text);
        std::fs::write(self.file("snippet.mpm"), &text).unwrap();
        let (found, code) = self.shell("karamelo-rs snippet.mpm");
        if code != Some(status) {
            return Err(format!("ended with {code:?}, not {status}\n{found}"));
        }
        Ok(())
    }

    /// Replaces lines of a file: those with `-` by those with `+`, among those with a blank.
    fn patch(&self, name: &str, change: &str) -> Result<(), String> {
        let text =
            std::fs::read_to_string(self.file(name)).map_err(|why| format!("{name}: {why}"))?;
        let side = |mark: char| -> String {
            let lines =
                change.lines().filter(|line| line.starts_with([mark, ' ']) || line.is_empty());
            lines.map(|line| format!("{}\n", line.get(1..).unwrap_or_default())).collect()
        };
        let (old, new) = (side('-'), side('+'));
        match text.matches(&old).count() {
            1 => {
                std::fs::write(self.file(name), text.replace(&old, &new)).unwrap();
                Ok(())
            }
            count => Err(format!("{count} places of {name} read\n{old}")),
        }
    }

    /// Does what a block asks for; tells if it was left out.
    fn play(&self, block: &Block) -> Result<bool, String> {
        if let Some(module) = block.value("needs")
            && !self.can(&format!("python3 -c 'import {module}'"))
        {
            return Ok(false);
        }
        if block.has("serial") && cfg!(feature = "mpi") {
            return Ok(false);
        }
        match (block.language.as_str(), block.value("file")) {
            ("diff", Some(name)) => self.patch(name, &block.text)?,
            (_, Some(name)) => std::fs::write(self.file(name), &block.text).unwrap(),
            ("console", _) if block.has("mpi") => {
                if !(cfg!(feature = "mpi") && self.can("mpirun --version")) {
                    return Ok(false);
                }
                self.console(block)?;
            }
            ("console", _) => self.console(block)?,
            ("mpm", _) if block.value("after").is_some() || block.value("exit").is_some() => {
                self.script(block)?;
            }
            ("mpm" | "diff", _) => return Err("what is to be done with this block?".into()),
            _ => {}
        }
        Ok(true)
    }
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let (path, name) = (entry.as_ref().unwrap().path(), entry.unwrap().file_name());
        match path.is_dir() {
            true => copy(&path, &to.join(name)),
            false => drop(std::fs::copy(&path, to.join(name)).unwrap()),
        }
    }
}

/// Plays all blocks of a page; what went wrong, and how many blocks were played and left out.
fn play(page: &Page) -> (Vec<String>, [usize; 2]) {
    let place = Place::new();
    let (mut wrong, mut counts) = (Vec::new(), [0; 2]);
    for block in &page.blocks {
        match place.play(block) {
            Ok(played) => counts[usize::from(!played)] += 1,
            Err(why) => wrong.push(format!("{}:{}: {why}", page.path.display(), block.line)),
        }
    }
    (wrong, counts)
}

#[test]
fn snippets_do_what_the_manual_says() {
    let pages = pages();
    let asks = |block: &Block| ["console", "mpm", "diff"].contains(&block.language.as_str());
    let pages: Vec<&Page> = pages.iter().filter(|page| page.blocks.iter().any(asks)).collect();
    let mut wrong = Vec::new();
    for page in pages {
        let start = std::time::Instant::now();
        let (found, [played, left_out]) = play(page);
        let seconds = start.elapsed().as_secs_f64();
        println!("{}: {played} blocks, {left_out} left out, {seconds:.1} s", page.path.display());
        wrong.extend(found);
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n\n"));
}

#[test]
fn a_page_that_lies_is_found_out() {
    let truth = "```text file=a.txt\none 1.5\n```\n```diff file=a.txt\n-one 1.5\n+one 2.5\n```\n\
        ```console\n$ cat a.txt\none 2.5\n```\n```console exit=3\n$ exit 3\n```\n";
    let lies = [
        ("$ cat a.txt\none 2.5", "$ cat a.txt\none 2.6"),
        ("-one 1.5", "-one 1.6"),
        ("$ exit 3", "$ exit 2"),
        ("```diff file=a.txt", "```diff"),
        ("```console\n", "```mpm exit=0\n"),
    ];
    let play = |text: &str| play(&Page::parse(Path::new("page.md"), text)).0;
    assert_eq!(play(truth), Vec::<String>::new());
    for (right, wrong) in lies {
        assert!(truth.contains(right));
        assert!(!play(&truth.replacen(right, wrong, 1)).is_empty(), "{wrong}");
    }
}

/// Commands of blocks that are not played, because they take long: `karamelo-rs SCRIPT ...`, up to the two
/// blanks before what a README says of them.
fn commands_not_played(page: &Page) -> Vec<String> {
    let blocks = page.blocks.iter().filter(|block| block.language.is_empty());
    let lines = blocks.flat_map(|block| block.text.lines());
    let calls = lines.filter_map(|line| line.strip_prefix("karamelo-rs "));
    let calls = calls.map(|call| call.split("  ").next().unwrap_or_default());
    calls.filter(|call| call.starts_with("inputs/")).map(str::to_string).collect()
}

#[test]
fn commands_that_take_long_would_run() {
    let place = Place::new();
    let mut calls: Vec<String> = pages().iter().flat_map(commands_not_played).collect();
    calls.sort();
    calls.dedup();
    assert!(calls.len() > 30, "the test reads the pages: {}", calls.len());
    let mut wrong = Vec::new();
    for call in calls {
        let (found, code) = place.shell(&format!("karamelo-rs check {call}"));
        if code != Some(0) {
            wrong.push(format!("karamelo-rs {call}\n{found}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
