//! Files that can be read, and files that must be refused.

use super::*;

/// A unit square of a quadrangle and two triangles, with its border, in both formats.
const TWO: &str = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"a $b\"\n\
    $EndPhysicalNames\n$Nodes\n6\n1 0 0 0\n2 .5 0 0\n9 1 0 0\n4 1 1 0\n5 .5 1 0\n6 0 1 0\n\
    $EndNodes\n$Elements\n4\n1 1 2 0 1 1 2\n2 3 2 0 1 1 2 5 6\n3 2 2 0 1 2 9 4\n\
    4 2 0 2 4 5\n$EndElements\n";

const FOUR: &str = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Entities\n0 0 1 0\n1 0 0 0 1 1 0 0 0\n\
    $EndEntities\n$Nodes\n2 6 1 9\n1 1 1 2\n1\n2\n0 0 0 0\n.5 0 0 .5\n2 1 0 4\n9\n4\n5\n6\n1 0 0\n\
    1 1 0\n.5 1 0\n0 1 0\n$EndNodes\n$Elements\n3 4 1 4\n1 1 1 1\n1 1 2\n2 1 3 1\n2 1 2 5 6\n\
    2 1 2 2\n3 2 9 4\n4 2 4 5\n$EndElements\n";

#[test]
fn both_formats_give_the_same_particles() {
    let two = read(TWO.as_bytes(), 2).expect("2.2").points().expect("good");
    let four = read(FOUR.replace('\n', "\r\n").as_bytes(), 2).expect("4.1").points().expect("good");
    assert_eq!(two, four);
    assert_eq!(two.list.len(), 3);
    assert_eq!(two.list[0], Point { place: [0.25, 0.5, 0.0], volume: 0.5 });
    assert_eq!(two.list.iter().map(|point| point.volume).sum::<f64>(), 1.0);
    assert_eq!((two.lower, two.upper), ([0.0; 3], [1.0, 1.0, 0.0]));
    assert!(two.remarks.is_empty());
}

#[test]
fn lower_dimensions_are_skipped_and_higher_ones_refused() {
    let lines = read(TWO.as_bytes(), 1).expect_err("triangles in one dimension");
    assert_eq!((lines.line, &lines.what[..27]), (Some(20), "an element of dimension 2 i"));
    let solids = read(TWO.as_bytes(), 3).expect_err("nothing to fill");
    assert!(solids.what.starts_with("there is no element of dimension 3"));
}

fn mistake(text: &str, old: &str, new: &str) -> (Option<usize>, String) {
    assert!(text.contains(old), "{old}");
    let bytes = text.replacen(old, new, 1);
    let found = read(bytes.as_bytes(), 2).and_then(|mesh| mesh.points());
    let found = found.expect_err(new);
    (found.line, found.what)
}

#[test]
fn mistakes_name_their_line() {
    for (old, new, line, words) in [
        ("2.2 0", "2.2 1", Some(2), "a binary mesh; `gmsh FILE"),
        ("2.2 0", "4 0", Some(2), "version `4`; 2.2 and 4.1 can be read"),
        ("$MeshFormat", "solid", Some(1), "no mesh of Gmsh"),
        ("6\n1 0 0 0", "18446744073709551615\n1 0 0 0", Some(16), "expected the number of a node"),
        ("4\n1 1 2", "99999999999\n1 1 2", Some(23), "expected the number of an element"),
        ("4\n1 1 2", "3\n1 1 2", Some(22), "expected `$EndElements`, found `4`"),
        (".5 1 0", ".5 nan 0", Some(14), "y is NaN"),
        (".5 1 0", ".5 \u{e9} 0", Some(14), "expected y, found `??`"),
        ("5 .5 1 0", "4 .5 1 0", Some(14), "the node 4 stands there twice"),
        ("2 9 4\n", "2 9 7\n", Some(21), "there is no node 7"),
        ("3 2 2 0 1 2 9 4", "3 2 2 0 1 2 9 2", Some(21), "the element at (0.5, 0, 0) has no"),
        ("2 3 2 0 1 1 2 5 6", "2 98 2 0 1 1 2 5 6", Some(20), "unknown type of element 98"),
        ("$EndNodes", "$EndNode", Some(16), "expected `$EndNodes`, found `$EndNode`"),
        ("$Elements", "$Element", Some(17), "the section `$Element` has no end"),
        ("$EndPhysicalNames", "", Some(4), "the section `$PhysicalNames` has no end"),
    ] {
        let (found, what) = mistake(TWO, old, new);
        assert_eq!(found, line, "{old} -> {new}: {what}");
        assert!(what.starts_with(words), "{old} -> {new}: {what}");
    }
    let (line, what) = mistake(FOUR, "2 1 0 4\n", "2 1 0 4000000000\n");
    assert_eq!(line, Some(22), "{what}");
    for end in 0..TWO.len() - 14 {
        assert!(read(&TWO.as_bytes()[..end], 2).is_err(), "cut after {end} bytes");
    }
}

#[test]
fn odd_elements_are_remarked() {
    let remarks = |old: &str, new: &str| {
        let mesh = read(TWO.replacen(old, new, 1).as_bytes(), 2).expect(new);
        mesh.points().expect(new).remarks
    };
    let all_turned = TWO.replace("1 2 5 6", "6 5 2 1").replace("2 9 4", "4 9 2");
    let all_turned = all_turned.replace("2 4 5\n", "5 4 2\n");
    let points = read(all_turned.as_bytes(), 2).expect("good").points().expect("good");
    assert!(points.remarks.is_empty() && points.list.iter().all(|point| point.volume > 0.0));
    for (old, new, words) in [
        ("1 2 9 4", "1 4 9 2", "elements turned over against the others count with |V| (1, the"),
        ("4 2 0 2 4 5", "4 2 0 9 4 2", "elements that stand there twice count once (1, the first"),
        (".5 1 0", ".5 1 .1", "coordinates beyond the dimension"),
    ] {
        let found = remarks(old, new);
        assert!(found.iter().any(|remark| remark.starts_with(words)), "{new}: {found:?}");
    }
    let folded = TWO.replace("6 0 1 0", "6 0 .5 0").replace("1 1 2 5 6", "1 1 5 2 6");
    let points = read(folded.as_bytes(), 2).expect("good").points().expect("good");
    assert!(points.remarks[0].starts_with("elements turned"), "{:?}", points.remarks);
    assert!(points.remarks[1].starts_with("folded elements"), "{:?}", points.remarks);
}

#[test]
fn curved_edges_are_remarked_and_taken_straight() {
    let text = |x: f64| {
        format!(
            "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 .5 0 0\n\
             5 {x} {x} 0\n6 0 .5 0\n$EndNodes\n$Elements\n1\n1 9 0 1 2 3 4 5 6\n$EndElements\n"
        )
    };
    for (x, remarks) in [(0.5, 0), (0.7, 1)] {
        let points = read(text(x).as_bytes(), 2).expect("good").points().expect("good");
        assert_eq!((points.list[0].volume, points.remarks.len()), (0.5, remarks));
    }
}
