//! Chooses eight of a thousand measurements of a straight line's two parameters, from their information matrices alone:
//! `cargo run --release --example choose_from_matrices`.
#![allow(clippy::print_stdout, reason = "an example talks")]

use calipose::selection::{InformationFunction, InformationSet, Instance, RelaxationSettings, best};
use nalgebra::{DMatrix, dvector};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // y = a + b x, measured at x with a noise that grows towards the ends: row [1 x], M = rowᵀ row / σ².
    let information = |i: u32| -> DMatrix<f64> {
        let x = f64::from(i) / 500.0 - 1.0;
        let row = dvector![1.0, x];
        let sigma = 0.1 + 0.2 * x * x;
        &row * row.transpose() / (sigma * sigma)
    };
    let matrices: Vec<DMatrix<f64>> = (0..1000).map(information).collect();
    let candidates = InformationSet::from_matrices(2, &matrices)?;
    // The least volume of the confidence ellipse.
    let instance = Instance::new(&candidates, None, &InformationFunction::Determinant, 8)?;
    let best = best(&instance, &RelaxationSettings::default(), 0)?;
    let efficiency = best.relaxation.certificate.efficiency(best.log_value);
    println!("{:?}: at least {:.2} % of the best possible", best.selected, 100.0 * efficiency);
    Ok(())
}
