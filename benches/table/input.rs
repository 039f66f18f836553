//! Scripts of `inputs/` in another size.

use std::path::Path;

/// The text of a script of `inputs/` with `cells` along an edge, running `steps` steps.
pub fn text(file: &str, cells: u32, steps: u32) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("inputs").join(file);
    let text = std::fs::read_to_string(path).unwrap();
    let line = |line: &str| match line.split(" = ").next() {
        Some("cells") => format!("cells = {cells}\n"),
        Some("steps") => format!("steps = {steps}\n"),
        _ => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}
