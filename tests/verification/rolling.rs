//! `inputs/rolling-disk`: a disk rolls or slides down an incline, against the closed forms.

use super::script::{Played, Script};

fn script() -> Script {
    Script::input("rolling-disk/rolling-disk.mpm")
}

/// Relative deviations of way, speed and speed of the rim at the end.
fn deviations(played: &Played) -> [f64; 3] {
    played.end.as_ref().expect("the run is stable");
    ["way", "speed", "rim"].map(|name| {
        let last = |name: &str| *played.column(name).last().unwrap();
        last(name) / last(&format!("exact_{name}")) - 1.0
    })
}

/// What may hold the disk back: the face meets the plane up to half a cell ahead of where it does in
/// truth, so that N acts on an arm b of up to h/2; g sin(theta) loses g cos(theta) b/R.
fn resistance(theta: f64, cells: f64) -> f64 {
    0.5 / cells / theta.to_radians().tan()
}

#[test]
fn a_disk_rolls_down_a_gentle_slope() {
    let mut ways = Vec::new();
    for cells in [8.0, 16.0] {
        let found = deviations(&script().play(&[("cells", cells)]));
        let bound = resistance(30.0, cells);
        println!("{cells} cells along the radius: {found:.4?}, bound {bound:.4}");
        assert!(found.iter().all(|part| part.abs() < bound), "{found:?}");
        ways.push(found[0].abs());
    }
    // Contact is of first order.
    assert!(ways[0] / ways[1] > 1.6, "{ways:?}");
    // Without friction it does not turn, and is half as fast again: the gate sees it.
    let smooth = script().replace("frictional, disk, plane, mu", "slip, disk, plane");
    let found = deviations(&smooth.play(&[("cells", 8.0)]));
    assert!(found[1] > 0.4 && found[2] < -0.9, "{found:?}");
}

#[test]
fn a_disk_slides_down_a_steep_slope() {
    let found = deviations(&script().play(&[("theta", 60.0)]));
    println!("60 degrees: {found:.4?}");
    // mu N is the same wherever N acts; the torque mu N R loses N b.
    assert!(found[0].abs() < 0.01 && found[1].abs() < 0.01, "{found:?}");
    assert!(found[2].abs() < 0.5 / 16.0 / 0.3, "{found:?}");
    // A disk that sticks rolls: the gate sees it.
    let sticky = script().replace("frictional, disk, plane, mu", "stick, disk, plane");
    let found = deviations(&sticky.play(&[("theta", 60.0), ("cells", 8.0)]));
    assert!(found[1].abs() > 0.1, "{found:?}");
}

#[test]
#[ignore = "half a minute: a fine grid"]
fn the_rolling_resistance_of_the_grid_is_of_first_order() {
    let ways =
        [8.0, 16.0, 32.0].map(|cells| deviations(&script().play(&[("cells", cells)]))[0].abs());
    println!("ways off by {ways:.4?}");
    for pair in ways.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 1.0).abs() < 0.25, "{ways:?}");
    }
}
