//! Layers: a module imports only from modules further to the left.

use std::path::{Path, PathBuf};

/// From the bottom to the top; modules in one row may know each other.
const LAYERS: [&[&str]; 14] = [
    &["math", "fault", "memory", "interrupt", "timing", "geometry"],
    &["script", "parallel"],
    &["style"],
    &["model", "region", "shape", "transfer", "method"],
    &["material", "eos", "strength", "damage", "temperature"],
    &["world"],
    &["plan", "step"],
    &["kernel", "time_step", "watch"],
    &["fix", "compute"],
    &["measure"],
    &["scheme"],
    &["output"],
    &["simulation"],
    &["command", "compare", "error", "study", "verify", "cli"],
];

fn files(folder: &Path, list: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, list);
        } else if path.extension().is_some_and(|suffix| suffix == "rs") {
            list.push(path);
        }
    }
}

fn layer(module: &str) -> Option<usize> {
    LAYERS.iter().position(|row| row.contains(&module))
}

#[test]
fn no_arrow_runs_back() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut list = Vec::new();
    files(&source, &mut list);
    let mut wrong = Vec::new();
    let mut arrows = 0;
    for path in list {
        let inside = path.strip_prefix(&source).unwrap();
        let first = inside.components().next().unwrap().as_os_str().to_string_lossy().into_owned();
        let module = first.trim_end_matches(".rs").to_string();
        if ["lib", "main"].contains(&module.as_str()) {
            continue;
        }
        let own = layer(&module).unwrap_or_else(|| panic!("{module} is in no layer"));
        let text = std::fs::read_to_string(&path).unwrap();
        let code = text.split("#[cfg(test)]").next().unwrap_or("");
        for part in code.split("crate::").skip(1) {
            let name: String =
                part.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let Some(other) = layer(&name) else { continue };
            arrows += 1;
            if other > own {
                wrong.push(format!("{}: {module} knows {name}", inside.display()));
            }
        }
    }
    assert!(arrows > 200, "the test reads the sources: {arrows}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
