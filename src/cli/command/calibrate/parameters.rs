//! Which intrinsics to estimate, which to hold and which to tie, as the command line says.

use clap::Args;

use super::Failure;
use crate::calibration::Ties;
use crate::camera::Camera;

#[derive(Debug, Args)]
pub(super) struct ParameterArguments {
    /// Intrinsics to estimate, as in fx,fy,cx,cy,k1 [default: the problem file's, else all]
    #[arg(long, value_delimiter = ',', value_name = "NAMES")]
    estimate: Vec<String>,
    /// Intrinsics to hold fixed, as in k3=0; without a value, at the problem file's, else at the image's centre or 0
    #[arg(long, value_delimiter = ',', value_name = "NAME[=VALUE]")]
    fix: Vec<String>,
    /// Two intrinsics to give the same value, as in fx=fy
    #[arg(long, value_delimiter = ',', value_name = "NAME=NAME")]
    tie: Vec<String>,
    /// Hold p1 and p2 at 0
    #[arg(long)]
    zero_tangential: bool,
}

/// What is to be found of a camera.
#[derive(Debug)]
pub(super) struct Model {
    /// Of which what is not estimated is kept, and nothing else read.
    pub(super) nominal: Camera,
    pub(super) estimated: Vec<usize>,
    pub(super) ties: Ties,
}

impl ParameterArguments {
    /// What is to be found of `nominal`, where nothing else is said its intrinsics `estimated`. Values of those that are not
    /// known are none: the image's centre, no distortion.
    pub(super) fn model(&self, nominal: &Camera, estimated: &[usize], is_known: bool) -> Result<Model, Failure> {
        let names = nominal.lens().parameter_names();
        let index = |name: &str| {
            names.iter().position(|&known| known == name.trim()).ok_or_else(|| {
                let (lens, names) = (nominal.lens().name(), names.join(" "));
                Failure::Usage(format!("the lens {lens} has no intrinsic `{}`; it has {names}", name.trim()))
            })
        };
        let mut θ = nominal.intrinsics().to_vec();
        let mut estimated = estimated.to_vec();
        if !self.estimate.is_empty() {
            estimated = self.estimate.iter().map(|name| index(name)).collect::<Result<_, _>>()?;
            estimated.sort_unstable();
            estimated.dedup();
        }
        let mut held: Vec<(usize, Option<f64>)> = Vec::new();
        for text in &self.fix {
            let (name, value) = match text.split_once('=') {
                Some((name, value)) => (name, Some(finite(text, value)?)),
                None => (text.as_str(), None),
            };
            held.push((index(name)?, value));
        }
        if self.zero_tangential {
            held.extend([(index("p1")?, Some(0.0)), (index("p2")?, Some(0.0))]);
        }
        for &(j, value) in &held {
            if !self.estimate.is_empty() && estimated.contains(&j) {
                return Err(Failure::Usage(format!("{} is both to be estimated and to be held fixed", names[j])));
            }
            estimated.retain(|&other| other != j);
            if let Some(value) = value {
                θ[j] = value;
            }
        }
        if estimated.is_empty() {
            return Err(Failure::Usage("no intrinsic is left to estimate".into()));
        }
        if !is_known {
            for j in (0..θ.len()).filter(|j| !estimated.contains(j)) {
                let has_value = held.iter().any(|&(other, value)| other == j && value.is_some());
                θ[j] = match j {
                    _ if has_value => θ[j],
                    0 | 1 => {
                        let name = names[j];
                        let what =
                            format!("no value is given at which to hold {name}: give one, as in --fix {name}=900");
                        return Err(Failure::Usage(what));
                    }
                    2 => (f64::from(nominal.width()) - 1.0) / 2.0,
                    3 => (f64::from(nominal.height()) - 1.0) / 2.0,
                    _ => 0.0,
                };
            }
        }
        let mut ties = Ties::default();
        for text in &self.tie {
            let Some((a, b)) = text.split_once('=') else {
                return Err(Failure::Usage(format!("--tie {text}: give two intrinsics, as in --tie fx=fy")));
            };
            let (a, b) = (index(a)?, index(b)?);
            if let Some(fixed) = [a, b].into_iter().find(|j| !estimated.contains(j)) {
                let name = names[fixed];
                return Err(Failure::Usage(format!(
                    "--tie {text}: {name} is not estimated, so nothing can be tied to it"
                )));
            }
            ties = ties.and(a, b);
        }
        let nominal = nominal.with_intrinsics(&θ).map_err(|error| Failure::Usage(error.to_string()))?;
        Ok(Model { nominal, estimated, ties })
    }
}

fn finite(text: &str, value: &str) -> Result<f64, Failure> {
    let parsed = value.trim().parse().ok().filter(|x: &f64| x.is_finite());
    parsed.ok_or_else(|| Failure::Usage(format!("--fix {text}: `{value}` is not a number")))
}
