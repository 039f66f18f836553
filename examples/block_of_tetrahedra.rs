//! A block cut into tetrahedra, as a mesh of Gmsh: `block_of_tetrahedra FILE LOWER UPPER DIVISIONS`, each
//! three numbers with commas between, e.g. `block_of_tetrahedra beam.msh 0.5,0.5,3.5 4.5,1.5,4.5 14,4,4`.
//!
//! Every box of the divisions becomes six tetrahedra around a diagonal.

use std::fmt::Write;
use std::process::ExitCode;

/// The orders in which a way along the edges of a box can take the axes, and whether their tetrahedron
/// is turned the right way.
const ORDERS: [([usize; 3], bool); 6] = [
    ([0, 1, 2], true),
    ([1, 2, 0], true),
    ([2, 0, 1], true),
    ([0, 2, 1], false),
    ([2, 1, 0], false),
    ([1, 0, 2], false),
];

/// The mesh in Gmsh's format 2.2.
fn mesh(lower: [f64; 3], upper: [f64; 3], divisions: [usize; 3]) -> String {
    let [nx, ny, nz] = divisions;
    let number = |[i, j, k]: [usize; 3]| 1 + (i * (ny + 1) + j) * (nz + 1) + k;
    let mut text = String::from("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n");
    let _ = writeln!(text, "{}", (nx + 1) * (ny + 1) * (nz + 1));
    let boxes = |more: usize| {
        let lines = (0..nx + more).flat_map(move |i| (0..ny + more).map(move |j| (i, j)));
        lines.flat_map(move |(i, j)| (0..nz + more).map(move |k| [i, j, k]))
    };
    for node in boxes(1) {
        let place = |axis: usize| {
            let part = node[axis] as f64 / divisions[axis] as f64;
            lower[axis] + part * (upper[axis] - lower[axis])
        };
        let _ = writeln!(text, "{} {} {} {}", number(node), place(0), place(1), place(2));
    }
    let _ = writeln!(text, "$EndNodes\n$Elements\n{}", 6 * nx * ny * nz);
    let tetrahedra = boxes(0).flat_map(|corner| ORDERS.map(|order| (corner, order)));
    for (index, (corner, (order, right))) in tetrahedra.enumerate() {
        let mut at = corner;
        let mut corners = [number(at); 4];
        for (axis, number_of) in order.into_iter().zip(1..) {
            at[axis] += 1;
            corners[number_of] = number(at);
        }
        if !right {
            corners.swap(2, 3);
        }
        let [a, b, c, d] = corners;
        let _ = writeln!(text, "{} 4 2 0 1 {a} {b} {c} {d}", index + 1);
    }
    text + "$EndElements\n"
}

/// Three numbers with commas between.
fn three<T: std::str::FromStr>(word: &str) -> Option<[T; 3]> {
    let numbers: Option<Vec<T>> = word.split(',').map(|number| number.parse().ok()).collect();
    numbers?.try_into().ok()
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let read = match &arguments[..] {
        [_, lower, upper, divisions] => {
            three(lower).zip(three(upper)).zip(three::<usize>(divisions))
        }
        _ => None,
    };
    let Some(((lower, upper), divisions)) = read.filter(|(_, divisions)| !divisions.contains(&0))
    else {
        eprintln!("usage: block_of_tetrahedra FILE X,Y,Z X,Y,Z NX,NY,NZ");
        return ExitCode::from(2);
    };
    match std::fs::write(&arguments[0], mesh(lower, upper, divisions)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(reason) => {
            eprintln!("{}: {reason}", arguments[0]);
            ExitCode::FAILURE
        }
    }
}
