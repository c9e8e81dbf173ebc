//! What a calibration left over, and how well its camera is known.

use super::accuracy::error_map;
use crate::figures::short;
use crate::plan::document::CalibrationDocument;
use crate::report::figure::{Content, Figure, Hue, Mark, Series};

/// Arrows drawn at most; of more, evenly spaced ones.
const MOST_ARROWS: usize = 2000;

/// Share of the picture's width that the arrow of the 95th percentile takes.
const ARROW: f64 = 0.04;

/// The residuals as arrows; none where the document does not list them.
pub(super) fn residuals(calibration: &CalibrationDocument) -> Option<Figure> {
    let all: Vec<_> = calibration.views.iter().flat_map(|view| &view.residuals).collect();
    let typical = calibration.residuals_px.percentile_95.filter(|&length| length > 0.0)?;
    let size = [f64::from(calibration.image.width_px), f64::from(calibration.image.height_px)];
    let scale = ARROW * size[0] / typical;
    let stride = all.len().div_ceil(MOST_ARROWS).max(1);
    let arrows: Vec<_> = all.iter().step_by(stride).map(|corner| (corner.corner_px, corner.residual_px)).collect();
    (!arrows.is_empty()).then(|| Figure {
        name: "residuals".into(),
        title: "Residuals over the image".into(),
        caption: format!(
            "From each corner to its projection, drawn {scale:.0} times as long as they are; 95 % are shorter than {} px. Arrows of one \
             place that point one way show what the lens model does not follow.",
            short(typical)
        ),
        x: "u [px]".into(),
        y: "v [px]".into(),
        content: Content::Arrows { arrows, size, scale },
    })
}

/// The RMS residual of every picture.
pub(super) fn by_view(calibration: &CalibrationDocument) -> Figure {
    let points = calibration.views.iter().zip(1u32..).map(|(view, number)| (f64::from(number), view.rms_px)).collect();
    let titles = calibration.views.iter().map(|view| format!("{}: {} px", view.name, short(view.rms_px))).collect();
    Figure {
        name: "residuals-by-picture".into(),
        title: "Residuals picture by picture".into(),
        caption: "A picture that stands out was blurred, moved, or its corners were mistaken.".into(),
        x: "picture, in the order of the table".into(),
        y: "RMS residual [px]".into(),
        content: Content::Series(vec![Series {
            name: "pictures".into(),
            hue: Hue::Plan,
            mark: Mark::Discs,
            points,
            titles,
        }]),
    }
}

/// How well the calibrated camera is known over the image.
pub(super) fn uncertainty(calibration: &CalibrationDocument) -> Option<Figure> {
    let map = calibration.error_map.as_ref().filter(|map| map.is_regular())?;
    let size = [f64::from(calibration.image.width_px), f64::from(calibration.image.height_px)];
    Some(error_map("error-over-image", "Map error over the image".into(), map, size, map.greatest()))
}
