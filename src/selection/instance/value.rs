//! What an instance makes great: log Φ of a total, its derivatives and its polar function.

use std::borrow::Cow;
use std::ops::Range;

use super::{Block, Instance};
use crate::selection::function::{Curvature, Gradient, InformationFunction, LogSoftMinimum, shift_of_soft_least};
use crate::selection::lanes::{LANES, Lanes};
use crate::selection::packed::{dot, packed_len};

/// The second derivative of an instance's log Φ at a point.
#[derive(Debug, Clone)]
pub(crate) struct InstanceCurvature {
    /// That of each term's own.
    blocks: Vec<Curvature>,
    /// Of several scenarios their soft least, and for each the image of the point.
    mixed: Option<(LogSoftMinimum, Vec<Vec<f64>>)>,
}

impl Instance<'_> {
    /// log Φ of a total; −∞ if it is singular to working precision.
    pub(crate) fn log_value_at(&self, total: &[f64]) -> f64 {
        self.log_value_in_place(&mut total.to_vec())
    }

    /// As [`Instance::log_value_at`]; the total serves as work space.
    pub(crate) fn log_value_in_place(&self, total: &mut [f64]) -> f64 {
        self.combined(|scenario| self.log_value_of(scenario, total))
    }

    /// log Φ of a total with each of some candidates added to it, one at a time. A value that does not exceed `above` may be −∞
    /// instead.
    pub(crate) fn log_values_with(&self, total: &[f64], candidates: &[usize], above: f64) -> Vec<f64> {
        let above = if self.blocks.len() == 1 { above } else { f64::NEG_INFINITY };
        let mut values = Vec::with_capacity(candidates.len());
        let mut work: Vec<Lanes> = vec![[0.0; LANES]; total.len()];
        let mut of_blocks: Vec<Lanes> = Vec::with_capacity(self.blocks.len());
        for group in candidates.chunks(LANES) {
            of_blocks.clear();
            for block in &self.blocks {
                let (known, work) = (&total[block.place.clone()], &mut work[block.place.clone()]);
                // Of an incomplete group the last member takes the lanes that are left.
                for lane in 0..LANES {
                    let matrix = block.candidates.packed(group[lane.min(group.len() - 1)]);
                    for ((sum, known), entry) in work.iter_mut().zip(known).zip(matrix) {
                        sum[lane] = known + entry;
                    }
                }
                of_blocks.push(block.function.log_values(work, block.order(), above));
            }
            values.extend((0..group.len()).map(|lane| {
                let of_scenario = |scenario: &Range<usize>| {
                    let blocks = self.blocks[scenario.clone()].iter().zip(&of_blocks[scenario.clone()]);
                    blocks.map(|(block, values)| block.share * values[lane]).sum::<f64>()
                };
                self.combined(of_scenario)
            }));
        }
        values
    }

    /// log Φ from that of each scenario.
    fn combined(&self, mut of_scenario: impl FnMut(&Range<usize>) -> f64) -> f64 {
        if let [all] = self.scenarios.as_slice() {
            return of_scenario(all);
        }
        let log_values: Vec<f64> = self.scenarios.iter().map(of_scenario).collect();
        let least = log_values.iter().copied().fold(f64::INFINITY, f64::min);
        if self.softness > 0.0 && least > f64::NEG_INFINITY { self.soft_least(&log_values).log_value() } else { least }
    }

    /// log Φ of a scenario.
    fn log_value_of(&self, scenario: &Range<usize>, total: &mut [f64]) -> f64 {
        let log_value =
            |block: &Block| block.share * block.function.log_value(&mut total[block.place.clone()], block.order());
        self.blocks[scenario.clone()].iter().map(log_value).sum()
    }

    /// log Φ of each scenario.
    fn log_values_at(&self, total: &[f64]) -> Vec<f64> {
        let mut total = total.to_vec();
        self.scenarios.iter().map(|scenario| self.log_value_of(scenario, &mut total)).collect()
    }

    /// The soft least of the scenarios' values.
    fn soft_least(&self, log_values: &[f64]) -> LogSoftMinimum {
        LogSoftMinimum::new(log_values, self.softness)
    }

    /// What can be evaluated faster and is no greater than log Φ but for a constant, with the same value and gradient at a total,
    /// up to a factor: of the soft least eigenvalue alone the logarithm of `det(M − t·1)`, whose greatest over t it is. Others
    /// are themselves; `None` if the total is singular.
    pub(crate) fn minorant_at(&self, total: &[f64]) -> Option<Cow<'_, Self>> {
        let [Block { function: InformationFunction::MinEigenvalue { softness }, .. }] = self.blocks.as_slice() else {
            return Some(Cow::Borrowed(self));
        };
        if *softness == 0.0 {
            return Some(Cow::Borrowed(self));
        }
        let mut minorant = self.clone();
        let block = &mut minorant.blocks[0];
        let t = shift_of_soft_least(total, block.order(), *softness)?;
        block.function = InformationFunction::Determinant;
        for i in 0..block.order() {
            block.prior[packed_len(i) + i] -= t;
        }
        Some(Cow::Owned(minorant))
    }

    /// The gradient of log Φ at a total, term after term; `None` if it is singular. Of the least over the scenarios itself it
    /// is that of the first that has it.
    pub(crate) fn gradient_at(&self, total: &[f64]) -> Option<Gradient> {
        let weights = if self.scenarios.len() == 1 {
            vec![1.0]
        } else {
            let log_values = self.log_values_at(total);
            let least = log_values.iter().copied().fold(f64::INFINITY, f64::min);
            if least == f64::NEG_INFINITY {
                return None;
            } else if self.softness > 0.0 {
                self.soft_least(&log_values).slopes
            } else {
                let first = log_values.iter().position(|&log_value| log_value == least);
                (0..log_values.len()).map(|scenario| f64::from(u8::from(Some(scenario) == first))).collect()
            }
        };
        let mut gradient = Gradient { y: Vec::with_capacity(total.len()), mixture: vec![] };
        for (blocks, weight) in self.scenarios.iter().zip(weights) {
            for block in &self.blocks[blocks.clone()] {
                let Gradient { y, mixture } = block.function.gradient(&total[block.place.clone()], block.order())?;
                gradient.y.extend(y.iter().map(|y| weight * block.share * y));
                gradient.mixture.extend(mixture);
            }
        }
        Some(gradient)
    }

    /// `log Φ°(Y)` of the terms' matrices Y ⪰ 0; −∞ where it bounds nothing.
    pub(crate) fn log_polar(&self, gradient: &Gradient) -> f64 {
        let mut mixture = gradient.mixture.as_slice();
        let mut of_block = |block: &Block| {
            let (own, rest) = mixture.split_at(block.function.mixed().min(mixture.len()));
            mixture = rest;
            let log_polar = block.function.log_polar(&gradient.y[block.place.clone()], block.order(), own);
            block.share * (log_polar - block.share.ln())
        };
        let mut of_scenario =
            |blocks: &Range<usize>| self.blocks[blocks.clone()].iter().map(&mut of_block).sum::<f64>();
        match self.scenarios.as_slice() {
            [all] => of_scenario(all),
            scenarios => {
                let log_polars: Vec<f64> = scenarios.iter().map(of_scenario).collect();
                // A scenario that bounds nothing adds nothing.
                let greatest = log_polars.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                let relative = log_polars.iter().filter(|log_polar| **log_polar > f64::NEG_INFINITY);
                greatest + relative.map(|log_polar| (log_polar - greatest).exp()).sum::<f64>().ln()
            }
        }
    }

    /// The second derivative of log Φ at a total; `None` if it is singular or Φ is not smooth.
    pub(crate) fn curvature(&self, total: &[f64]) -> Option<InstanceCurvature> {
        let blocks =
            self.blocks.iter().map(|block| block.function.curvature(&total[block.place.clone()], block.order()));
        let blocks = blocks.collect::<Option<Vec<Curvature>>>()?;
        if self.scenarios.len() == 1 {
            return Some(InstanceCurvature { blocks, mixed: None });
        }
        if self.softness == 0.0 {
            return None;
        }
        let soft = self.soft_least(&self.log_values_at(total));
        let along = |scenario: &Range<usize>| {
            let images = scenario.clone().map(|b| {
                let block = &self.blocks[b];
                scaled(blocks[b].map(&total[block.place.clone()]), block.share.sqrt())
            });
            images.flatten().collect()
        };
        let along = self.scenarios.iter().map(along).collect();
        Some(InstanceCurvature { blocks, mixed: Some((soft, along)) })
    }

    /// The image of `M_i` under the root of the second derivative.
    ///
    /// For one scenario `−D² log Φ_s[Δ, Δ] = ‖R_s Δ‖²`. Being homogeneous, `Φ_s` has `D log Φ_s[Δ] = ⟨û_s, R_s Δ⟩` with the
    /// unit vector `û_s = R_s M`, and so `−D²Φ_s[Δ, Δ] / Φ_s` is the square of `R_s Δ` less its part along `û_s`. The soft
    /// least adds its own.
    pub(crate) fn curve(&self, curvature: &InstanceCurvature, i: usize) -> Vec<f64> {
        let image = |b: usize| {
            let block = &self.blocks[b];
            scaled(curvature.blocks[b].map(block.candidates.packed(i)), block.share.sqrt())
        };
        let Some((soft, along)) = &curvature.mixed else {
            return (0..self.blocks.len()).flat_map(image).collect();
        };
        let mut changes = Vec::with_capacity(along.len());
        let mut images = Vec::new();
        for ((scenario, along), weight) in self.scenarios.iter().zip(along).zip(&soft.slopes) {
            let image: Vec<f64> = scenario.clone().flat_map(image).collect();
            let change = dot(&image, along);
            changes.push(change);
            images.extend(image.iter().zip(along).map(|(x, u)| weight.sqrt() * (x - u * change)));
        }
        soft.second_derivative(&mut changes);
        images.extend(changes);
        images
    }
}

fn scaled(mut numbers: Vec<f64>, factor: f64) -> Vec<f64> {
    for number in &mut numbers {
        *number *= factor;
    }
    numbers
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use crate::selection::packed::dot;
    use crate::selection::{Constraints, InformationFunction, InformationSet, Instance, Term};

    /// With smooth functions, with ones that are soft themselves, and where one scenario is far from the least.
    #[test]
    fn derivatives_over_scenarios_equal_finite_differences() {
        let matrix = |seed: f64| {
            let A = DMatrix::from_fn(3, 3, |i, j| (seed + 2.3 * i as f64 + 1.7 * j as f64).sin());
            &A * A.transpose() + DMatrix::identity(3, 3) * 0.1
        };
        let set = |seed: f64, size: f64| {
            let matrices: Vec<_> = (0..4).map(|i| matrix(seed + f64::from(i)) * size).collect();
            InformationSet::from_matrices(3, &matrices).unwrap()
        };
        let weight = matrix(0.5);
        let smooth = [InformationFunction::Determinant, InformationFunction::variance(&weight)];
        let kinked =
            [InformationFunction::min_eigenvalue(), InformationFunction::worst_variance(&[weight, matrix(9.0)])];
        for functions in [smooth, kinked] {
            for size in [1.0, 1e4] {
                let (a, b) = (set(1.0, 1.0), set(7.0, size));
                let term = |candidates, function, share| Term { candidates, prior: None, function, share };
                let scenarios = [
                    vec![term(&a, &functions[0], 0.4), term(&b, &functions[1], 0.6)],
                    vec![term(&b, &functions[1], 1.0)],
                    vec![term(&a, &functions[0], 1.0)],
                ];
                let instance = Instance::of_scenarios(&scenarios, 2, Constraints::default()).unwrap();
                for softness in [0.7, 0.2, 0.05] {
                    let soft = instance.softened(softness);
                    let total = soft.total(&[0, 1, 2]);
                    let moved = |h: f64| {
                        let mut total = total.clone();
                        soft.add_to(&mut total, 3, h);
                        soft.log_value_at(&total)
                    };
                    let h = 1e-4;
                    let slope = soft.scores_of(&soft.gradient_at(&total).unwrap().y, &[3])[0];
                    let differences = (moved(h) - moved(-h)) / (2.0 * h);
                    assert!((slope - differences).abs() < 1e-5 * (1.0 + slope), "{softness}: {slope} {differences}");
                    let image = soft.curve(&soft.curvature(&total).unwrap(), 3);
                    let bend = dot(&image, &image);
                    let differences = -(moved(h) - 2.0 * moved(0.0) + moved(-h)) / (h * h);
                    assert!((bend - differences).abs() < 1e-2 * (0.1 + bend), "{softness}: {bend} {differences}");
                }
            }
        }
    }
}
