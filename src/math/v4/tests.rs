//! Every back end computes the same.

use super::*;

struct Everything;

impl Sweep for Everything {
    type Output = Vec<[f64; 4]>;
    fn run<V: Wide>(self) -> Self::Output {
        let a = V::load(&[1.0, -2.0, 3.0, -4.0]);
        let b = V::load(&[4.0, 3.0, -2.0, 0.5]);
        let lower = V::splat(-2.0);
        let inside = f64::from(a.inside(lower, V::splat(3.0)));
        let outside = f64::from(V::splat(f64::NAN).inside(lower, V::splat(3.0)));
        [a + b, a - b, a * b, a.mul_add(b, V::splat(1.0)), a.larger(b)]
            .into_iter()
            .chain([
                a / b,
                b.absolute().sqrt(),
                a.smaller(b),
                V::load(&[1.5, -1.5, 2.0, -0.5]).floor(),
            ])
            .chain([a.absolute(), a.with_last(b), V::splat(inside), V::splat(outside)])
            .chain([
                V::splat(f64::from(b.absolute().all_positive())),
                V::splat(f64::from(b.all_positive())),
            ])
            .chain([a.below(b, V::splat(7.0), a * a)])
            .chain([
                V::splat(f64::from(a.any_below(V::splat(-3.5)))),
                V::splat(f64::from(a.any_below(V::splat(-4.0)))),
            ])
            .chain(V::load(&[0.15625, 1.0, 1.9999, 4e300]).split())
            .chain([V::load(&[-1022.0, 0.0, 3.0, 1023.0]).power_of_two()])
            .chain(V::transpose([a, b, lower, a + a]))
            .map(V::array)
            .collect()
    }
}

#[test]
fn every_back_end_computes_the_same() {
    let expected = vec![
        [5.0, 1.0, 1.0, -3.5],
        [-3.0, -5.0, 5.0, -4.5],
        [4.0, -6.0, -6.0, -2.0],
        [5.0, -5.0, -5.0, -1.0],
        [4.0, 3.0, 3.0, 0.5],
        [0.25, -2.0 / 3.0, -1.5, -8.0],
        [2.0, 3f64.sqrt(), 2f64.sqrt(), 0.5f64.sqrt()],
        [1.0, -2.0, -2.0, -4.0],
        [1.0, -2.0, 2.0, -1.0],
        [1.0, 2.0, 3.0, 4.0],
        [1.0, -2.0, 3.0, 0.5],
        [1.0; 4],
        [0.0; 4],
        [1.0; 4],
        [0.0; 4],
        [7.0, 7.0, 9.0, 7.0],
        [1.0; 4],
        [0.0; 4],
        [1.25, 1.0, 1.9999, 4e300 / 2f64.powi(998)],
        [-3.0, 0.0, 0.0, 998.0],
        [f64::MIN_POSITIVE, 1.0, 8.0, 2f64.powi(1023)],
        [1.0, 4.0, -2.0, 2.0],
        [-2.0, 3.0, -2.0, -4.0],
        [3.0, -2.0, -2.0, 6.0],
        [-4.0, 0.5, -2.0, -8.0],
    ];
    assert_eq!(Everything.run::<Plain>(), expected);
    assert_eq!(dispatch(Everything), expected);
}
