//! Observed orders and extrapolation to h = 0.

/// Order p of e = C h^p through two errors; NaN where there is none.
pub fn order(coarse: (f64, f64), fine: (f64, f64)) -> f64 {
    let ((h1, e1), (h2, e2)) = (coarse, fine);
    if !(e1 > 0.0 && e2 > 0.0 && h1 > h2 && h2 > 0.0) {
        return f64::NAN;
    }
    (e1 / e2).ln() / (h1 / h2).ln()
}

/// Orders outside of this range are no convergence that could be extrapolated.
const ORDERS: [f64; 2] = [0.3, 6.0];

/// A value at h = 0 from three grids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extrapolated {
    /// The value at h = 0.
    pub value: f64,
    /// The order.
    pub order: f64,
    /// Distance of the finest value from it.
    pub distance: f64,
}

/// Richardson: f = f0 + C h^p through three values on finer and finer grids (Roache 1998); `None`
/// if they do not approach anything with an order between 0.3 and 6.
pub fn richardson(points: [(f64, f64); 3]) -> Option<Extrapolated> {
    let [(h1, f1), (h2, f2), (h3, f3)] = points;
    let ratio = (f1 - f2) / (f2 - f3);
    if !(h1 > h2 && h2 > h3 && h3 > 0.0 && ratio.is_finite() && ratio > 0.0) {
        return None;
    }
    // (h1^p - h2^p)/(h2^p - h3^p) rises with p: bisection.
    let steps = |p: f64| (h1.powf(p) - h2.powf(p)) / (h2.powf(p) - h3.powf(p));
    let [mut low, mut high] = ORDERS;
    if !(steps(low) <= ratio && ratio <= steps(high)) {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if steps(middle) < ratio { low = middle } else { high = middle }
    }
    let p = 0.5 * (low + high);
    let value = f3 - (f2 - f3) / (h2.powf(p) - h3.powf(p)) * h3.powf(p);
    Some(Extrapolated { value, order: p, distance: (f3 - value).abs() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_give_their_order() {
        for p in [0.5f64, 1.0, 2.0, 4.0] {
            let at = |h: f64| (h, 3.0 * h.powf(p));
            assert!((order(at(0.1), at(0.03)) - p).abs() < 1e-12);
            let shifted = |h: f64| (h, 7.0 - 3.0 * h.powf(p));
            for [h2, h3] in [[0.05, 0.025], [0.08, 0.05]] {
                let found = richardson([shifted(0.1), shifted(h2), shifted(h3)]).unwrap();
                assert!((found.order - p).abs() < 1e-9 && (found.value - 7.0).abs() < 1e-9, "{p}");
            }
        }
    }

    #[test]
    fn what_does_not_converge_has_no_value() {
        assert!(richardson([(0.4, 1.0), (0.2, 2.0), (0.1, 1.5)]).is_none());
        assert!(richardson([(0.4, 1.0), (0.2, 2.0), (0.1, 4.0)]).is_none());
        assert!(richardson([(0.4, 1.0), (0.2, 1.0), (0.1, 1.0)]).is_none());
        assert!(richardson([(0.4, f64::NAN), (0.2, 1.0), (0.1, 1.5)]).is_none());
        assert!(order((0.2, 0.0), (0.1, 1.0)).is_nan());
    }
}
