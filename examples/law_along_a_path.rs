//! Drives one particle of a law along a path of deformation, without grid or script.
//!
//! `cargo run --release --example law_along_a_path` prints the shear stress of a hypoelastic
//! material in simple shear for two objective rates. With the Jaumann rate it is G sin(gamma), and
//! so turns back; with the logarithmic rate it keeps rising.

use karamelo::material::linear::Linear;
use karamelo::material::point::Point;
use karamelo::material::{Description, Elastic, Law, StressRate};
use karamelo::math::tensor::Tensor;

/// Shear stress s12 \[P\] of `law` after simple shear up to `gamma` in `steps` steps.
fn simple_shear(law: &dyn Law, rate: StressRate, gamma: f64, steps: u32) -> f64 {
    let mut point = Point::new(law, 3, Description::Updated(rate));
    let mut shear = Tensor::zeros();
    shear[(0, 1)] = gamma; // L12, constant over one unit of time
    for _ in 0..steps {
        point.step(&shear, 1.0 / f64::from(steps));
    }
    point.stress()[(0, 1)]
}

fn main() {
    let law = Linear(Elastic::new(1000.0, 2.6, 0.3));
    println!("{:>6} {:>12} {:>12} {:>12}", "gamma", "jaumann", "logarithmic", "G sin gamma");
    for gamma in [0.5, 1.0, 2.0, 3.0, 4.0] {
        let [jaumann, logarithmic] = [StressRate::Jaumann, StressRate::Logarithmic]
            .map(|rate| simple_shear(&law, rate, gamma, 10_000));
        let exact = law.0.shear * f64::sin(gamma);
        println!("{gamma:>6} {jaumann:>12.6} {logarithmic:>12.6} {exact:>12.6}");
        assert!((jaumann - exact).abs() < gamma * gamma * 1e-4); // half a step of the path
    }
}
