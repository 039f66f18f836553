//! What every shape function must do, anywhere on axes of any length.

use super::{Bernstein, Cubic, EDGE, Linear, Quadratic, SHAPES, Shape, Weights, gimp};
use crate::math::v4::{Plain, Wide};

/// One axis: value, slope and moment weights with the places of their nodes.
struct Axis {
    nodes: Vec<f64>,
    value: Vec<f64>,
    slope: Vec<f64>,
    moment: Vec<f64>,
}

fn axis<const W: usize, S: Shape<W>>(r: f64, last: usize) -> Axis {
    axis_of(S::weights(Plain::splat(r), Plain::splat(last as f64)), r, last)
}

/// Boxes of half size `TENTHS`/10 on a lattice with one more node at either end.
fn boxed<const TENTHS: usize>(r: f64, last: usize) -> Axis {
    let [place, half, end] = [r + 1.0, TENTHS as f64 / 10.0, (last + 2) as f64].map(Plain::splat);
    let mut axis = axis_of(gimp::weights(place, half, end), r, last + 2);
    axis.nodes.iter_mut().for_each(|node| *node -= 1.0);
    axis
}

fn axis_of<const W: usize>(weights: Weights<W>, r: f64, last: usize) -> Axis {
    let moments = weights.moments::<Plain>();
    assert!(weights.first[0] >= 0.0 && weights.first[0] as usize + W - 1 <= last, "{r} of {last}");
    Axis {
        nodes: (0..W).map(|k| weights.first[0] + k as f64).collect(),
        value: weights.value.iter().map(|v| v[0]).collect(),
        slope: weights.slope.iter().map(|v| v[0]).collect(),
        moment: moments.slope.iter().map(|v| v[0]).collect(),
    }
}

type OneAxis = fn(f64, usize) -> Axis;

/// Every shape that can be built: its axis, the lengths to try, is it smooth, has it moments.
fn shapes() -> [(&'static str, OneAxis, [usize; 3], bool, bool); 6] {
    [
        ("linear", axis::<2, Linear>, [1, 2, 7], false, false),
        ("quadratic-spline", axis::<3, Quadratic>, [3, 4, 7], true, true),
        ("cubic-spline", axis::<4, Cubic>, [3, 4, 7], true, true),
        ("Bernstein-quadratic", axis::<3, Bernstein>, [2, 4, 8], false, false),
        ("gimp", boxed::<5>, [1, 2, 7], true, false),
        ("cpgimp", boxed::<3>, [1, 2, 7], true, false),
    ]
}

fn places(last: usize) -> impl Iterator<Item = f64> {
    (0..=1000 * last).map(|step| step as f64 / 1000.0)
}

fn sum(weights: &[f64], of: impl Fn(usize) -> f64) -> f64 {
    weights.iter().enumerate().map(|(k, weight)| weight * of(k)).sum()
}

#[test]
fn every_row_that_can_be_built_is_tested_here() {
    let built: Vec<&str> = SHAPES.iter().filter(|s| s.build.is_some()).map(|s| s.name).collect();
    assert_eq!(built, shapes().map(|shape| shape.0));
}

#[test]
fn weights_sum_to_one_and_slopes_to_zero_up_to_the_walls() {
    for (name, axis, lengths, ..) in shapes() {
        for last in lengths {
            for r in places(last) {
                let axis = axis(r, last);
                assert!((sum(&axis.value, |_| 1.0) - 1.0).abs() < 1e-14, "{name} {r} of {last}");
                assert!(sum(&axis.slope, |_| 1.0).abs() < 1e-14, "{name} {r} of {last}");
                assert!(axis.value.iter().all(|v| *v >= 0.0), "{name} {r} of {last}");
            }
        }
    }
}

#[test]
fn places_and_linear_fields_are_reproduced_up_to_the_walls() {
    for (name, axis, lengths, ..) in shapes() {
        for last in lengths {
            for r in places(last) {
                let axis = axis(r, last);
                let place = sum(&axis.value, |k| axis.nodes[k]);
                assert!((place - r).abs() < 4.0 * EDGE, "{name}: {place} at {r} of {last}");
                let slope = sum(&axis.slope, |k| axis.nodes[k]);
                assert!((slope - 1.0).abs() < 4.0 * EDGE, "{name}: {slope} at {r} of {last}");
            }
        }
    }
}

#[test]
fn moments_reproduce_linear_fields_as_slopes_do() {
    for (name, axis, lengths, _, moments) in shapes() {
        for last in lengths.into_iter().filter(|_| moments) {
            for r in places(last) {
                let axis = axis(r, last);
                // Near a wall D is as small as EDGE, yet sums and products stay exact to round-off.
                assert!(sum(&axis.moment, |_| 1.0).abs() < 1e-13, "{name} {r} of {last}");
                let slope = sum(&axis.moment, |k| axis.nodes[k]);
                assert!((slope - 1.0).abs() < 1e-11, "{name}: {slope} at {r} of {last}");
            }
        }
    }
}

#[test]
fn slopes_are_the_derivatives_of_the_weights() {
    let h = 1e-5;
    for (name, axis, lengths, smooth, _) in shapes() {
        for last in lengths {
            for step in 0..200 * last {
                let r = (step as f64 + 0.37) / 200.0;
                let (before, here, after) = (axis(r - h, last), axis(r, last), axis(r + h, last));
                let value = |of: &Axis, node: f64| {
                    of.nodes.iter().position(|n| *n == node).map_or(0.0, |k| of.value[k])
                };
                for (k, node) in here.nodes.iter().enumerate() {
                    let slope = (value(&after, *node) - value(&before, *node)) / (2.0 * h);
                    // Third derivative times h^2/6, and round-off over 2 h.
                    assert!((slope - here.slope[k]).abs() < 1e-9, "{name} {r} of {last}");
                }
                if smooth {
                    let jump = |k: usize, node: f64| {
                        let other = after.nodes.iter().position(|n| *n == node);
                        (here.slope[k] - other.map_or(0.0, |k| after.slope[k])).abs()
                    };
                    assert!(here.nodes.iter().enumerate().all(|(k, n)| jump(k, *n) < 4.0 * h));
                }
            }
        }
    }
}
