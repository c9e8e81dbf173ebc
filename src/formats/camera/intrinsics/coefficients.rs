//! Distortion coefficients as files list them: in OpenCV's order, some left out, or filled up with zeros.

use super::matrix::Matrix;
use crate::camera::Lens;
use crate::formats::camera::unsupported::THIN_PRISM;
use crate::formats::error::{ReadError, ReadFault};
use crate::formats::tree::Located;

/// Fewest coefficients of a lens with distortion.
const FEWEST: usize = 4;

/// The first of OpenCV's coefficients for thin prisms, s1 to s4, after which come those for a tilted sensor.
const FIRST_OF_THIN_PRISM: usize = 8;

/// The coefficients of `lens`, which the file calls `model`: those left out are zero, and zeros beyond its own are dropped.
pub(in crate::formats::camera) fn coefficients_of(
    lens: Lens,
    model: &str,
    list: &Matrix,
) -> Result<Vec<Located>, ReadError> {
    let Matrix { key, line, entries } = list;
    let count = lens.parameter_names().len() - 4;
    if let Some(i) = (count..entries.len()).find(|&i| entries[i].value != 0.0) {
        let Located { line, value } = entries[i];
        let (key, model) = (format!("{key}[{i}]"), model.to_owned());
        return Err(ReadFault::Coefficient { key, value, model, instead: instead(lens, i) }.at(line));
    }
    let fewest = FEWEST.min(count);
    if entries.len() < fewest {
        let expected = match count - fewest {
            0 => fewest.to_string(),
            1 => format!("{fewest} or {count}"),
            _ => format!("{fewest} to {count}"),
        };
        return Err(ReadFault::Length { key: key.clone(), found: entries.len(), expected }.at(*line));
    }
    let mut coefficients: Vec<Located> = entries.iter().copied().take(count).collect();
    coefficients.resize(count, Located { line: *line, value: 0.0 });
    Ok(coefficients)
}

/// What to do about coefficient `i`, which is beyond those of `lens`.
fn instead(lens: Lens, i: usize) -> &'static str {
    match lens {
        Lens::Pinhole => "name the lens model that they belong to",
        // Only models that begin as OpenCV's do can go on as those.
        _ if lens.radial_polynomial().is_none() => "",
        _ if i >= FIRST_OF_THIN_PRISM => THIN_PRISM,
        _ => "if they belong to OpenCV's rational model, name that (ROS: rational_polynomial)",
    }
}
