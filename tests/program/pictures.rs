//! Pictures of fields, in the plane and in space.

use super::place::{Place, stderr};

const BALL: &str = "
h = 0.1
method(ulmpm, FLIP, linear, 1)
dimension(3, 0, 1, 0, 1, 0, 1, h)
region(low, sphere, 0.5, 0.5, 0.3, 0.2)
region(high, sphere, 0.5, 0.5, 0.75, 0.15)
material(rubber, linear, 1000, 1e4, 0.3)
solid(low, region, low, 2, rubber, h)
solid(high, region, high, 2, rubber, h)
";

/// The pixels of a picture.
fn pixels(place: &Place, name: &str) -> tiny_skia::Pixmap {
    let bytes = std::fs::read(place.0.path().join(name)).unwrap();
    tiny_skia::Pixmap::decode_png(&bytes).unwrap()
}

fn colour(map: &tiny_skia::Pixmap, x: u32, y: u32) -> [u8; 3] {
    let pixel = map.pixel(x, y).unwrap();
    [pixel.red(), pixel.green(), pixel.blue()]
}

#[test]
fn colours_show_the_field_between_the_numbers_of_the_range() {
    let place = Place::new(
        "dump(a, all, picture, 1, x.*.png, x, range, 0.3, 0.7, size, 600, 500)
dump(b, all, picture, 1, low.png, x, range, 10, 20, size, 600, 500)
run(0)
",
    );
    let output = place.run(&["in.mpm", "--quiet"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let map = pixels(&place, "x.0.png");
    assert_eq!((map.width(), map.height()), (600, 500));
    // The box of 1 x 1 is 390 pixels wide, in the middle of 490 x 500; particles at 0.325, 0.375, ...
    let at = |x: f64| colour(&map, (50.0 + 390.0 * x) as u32, 250);
    let viridis = |part: f64| {
        // Between the stops 20 and 30 % of the map.
        let stops = [[68.0, 1.0, 84.0], [72.0, 40.0, 120.0], [62.0, 74.0, 137.0]];
        let place = part * 9.0;
        let (low, rest) = (place as usize, place.fract());
        [0, 1, 2].map(|c| (stops[low][c] + rest * (stops[low + 1][c] - stops[low][c]) + 0.5) as u8)
    };
    assert_eq!(at(0.325), viridis(0.025 / 0.4));
    assert_eq!(at(0.375), viridis(0.075 / 0.4));
    assert_eq!(at(0.1), [255; 3]);
    let below = pixels(&place, "low.png");
    assert_eq!(colour(&below, 245, 250), [68, 1, 84], "what is below has the lowest colour");
}

#[test]
fn balls_hide_what_is_behind_them() {
    // From above the high ball covers the middle of the low one; from below it is hidden.
    for (elevation, middle) in [(90, [213, 94, 0]), (-90, [0, 114, 178])] {
        let script = format!(
            "{BALL}dump(a, all, picture, 1, p.png, solid, view, -90, {elevation}, size, 500, 400)\nrun(0)\n"
        );
        let place = Place::of("in.mpm", &script);
        let output = place.run(&["in.mpm", "--quiet"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let [r, g, b] = colour(&pixels(&place, "p.png"), 195, 225).map(f64::from);
        // Light changes the brightness, not the hue.
        let bright = (r + g + b) / middle.iter().map(|c| f64::from(*c)).sum::<f64>();
        for (found, full) in [r, g, b].into_iter().zip(middle) {
            assert!((found - bright * f64::from(full)).abs() < 8.0, "{elevation}: {r} {g} {b}");
        }
    }
}

#[test]
fn numbered_pictures_make_a_film_and_go_on_after_a_restart() {
    let scene = format!(
        "{BALL}fix(v, initial_velocity_particles, all, 0.1, 0, 0)\n\
        dump(a, all, picture, 2, f.*.png, vx, size, 200, 150, numbered)\n"
    );
    let place = Place::of("in.mpm", &format!("{scene}restart(4, s.*.rst)\nrun(8)\n"));
    assert_eq!(place.run(&["in.mpm", "--quiet"]).status.code(), Some(0));
    let names: Vec<String> =
        place.files().into_iter().filter(|name| name.ends_with(".png")).collect();
    assert_eq!(names, ["f.00000.png", "f.00001.png", "f.00002.png", "f.00003.png", "f.00004.png"]);
    let last = std::fs::read(place.0.path().join("f.00004.png")).unwrap();
    std::fs::remove_file(place.0.path().join("f.00004.png")).unwrap();
    assert_eq!(place.run(&["s.4.rst", "--quiet"]).status.code(), Some(0));
    assert_eq!(std::fs::read(place.0.path().join("f.00004.png")).unwrap(), last);
    assert!(!place.files().contains(&"f.00005.png".to_string()));
}

#[test]
fn every_format_and_dimension_gives_a_picture() {
    for dimension in ["1, 0, 1", "2, 0, 1, 0, 1", "3, 0, 1, 0, 1, 0, 1"] {
        let script = format!(
            "h = 0.25\nmethod(ulmpm, FLIP, linear, 1)\ndimension({dimension}, h)\n\
             region(r, block, 0.25, 0.75, INF, INF, INF, INF)\nmaterial(m, linear, 1000, 1e4, 0)\n\
             solid(s, region, r, 2, m, h)\nx1 = 0.2\n\
             dump(a, all, picture, 1, p.svg, seq)\ndump(b, all, picture, 1, p.pdf, T, up, y)\n\
             dump(c, all, picture, 1, p.png, solid)\nrun(1)\n"
        );
        let place = Place::of("in.mpm", &script);
        let output = place.run(&["in.mpm", "--quiet"]);
        assert_eq!(output.status.code(), Some(0), "{dimension}: {}", stderr(&output));
        assert!(place.read("p.svg").contains("data:image/png;base64"));
        let pdf = std::fs::read(place.0.path().join("p.pdf")).unwrap();
        assert!(pdf.windows(6).any(|part| part == b"/Image"));
        assert_eq!(pixels(&place, "p.png").width(), 1000);
    }
}
