//! Where the camera looks and which way is up in its picture, in words.

use crate::cli::output::fixed;
use crate::plan::document::CameraSights;

pub(super) fn sight_text(CameraSights { on_flange, in_base_at_mid_range: in_base }: &CameraSights) -> String {
    format!(
        "Camera: on the flange it looks along {}, up in the picture is {}; with every joint mid-range it looks along {} of the \
         base, up is {}.",
        direction(on_flange.looks_along),
        direction(on_flange.up),
        direction(in_base.looks_along),
        direction(in_base.up),
    )
}

/// A unit vector: the axis that it is, or its coordinates to hundredths.
fn direction(v: [f64; 3]) -> String {
    for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
        if v[axis].abs() > 1.0 - 1e-9 {
            return format!("{}{name}", if v[axis] < 0.0 { "-" } else { "+" });
        }
    }
    let [x, y, z] = v.map(|coordinate| fixed(coordinate, 2));
    format!("({x}, {y}, {z})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_axes_where_they_are_and_never_minus_zero() {
        assert_eq!(direction([0.0, -1.0, 1e-12]), "-y");
        assert_eq!(direction([0.6, -1e-5, 0.8]), "(0.60, 0.00, 0.80)");
    }
}
