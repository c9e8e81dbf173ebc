//! How well the camera will be known.

use crate::figures::short;
use crate::plan::document::{BoundPoint, ErrorGrid, Plan, Review, Verification};
use crate::report::figure::{Content, Figure, Hue, Interval, Line, Mark, Series};

/// The map error against the number of poses, with what no choice of the views can be below.
pub(super) fn by_count(review: &Review) -> Figure {
    let line = |name: &str, hue, mark, points: Vec<(f64, f64)>| Series {
        name: name.into(),
        hue,
        mark,
        points,
        titles: vec![],
    };
    let points = |number: fn(&BoundPoint) -> Option<f64>| -> Vec<(f64, f64)> {
        let determined = review.curve.iter().filter(|point: &&BoundPoint| point.map_error_px.is_some());
        determined.filter_map(|point| Some((point.count as f64, number(point)?))).collect()
    };
    let count = review.poses.len();
    let here = points(|point| point.map_error_px).into_iter().filter(|point| point.0 == count as f64).collect();
    let mut series = vec![line("good choices", Hue::Plan, Mark::Line(Line::Solid), points(|point| point.map_error_px))];
    let bound = points(|point| point.bound_px);
    let proven = !bound.is_empty();
    if proven {
        series.push(line("no choice of these views can be below", Hue::Bound, Mark::Line(Line::Dashed), bound));
    }
    series.push(line("this plan", Hue::Plan, Mark::Discs, here));
    Figure {
        name: "error-by-poses".into(),
        title: "What more poses bring".into(),
        caption: if proven {
            "The dashed line is proven: no choice of so many of the views that the poses were chosen from has a smaller map error.".into()
        } else {
            String::from(
                "Good choices of fewer and more poses; the plan optimises something else, so nothing is proven of this error.",
            )
        },
        x: "poses".into(),
        y: "map error [px]".into(),
        content: Content::LogSeries(series),
    }
}

/// The map error over the image: before the plan, if anything is known then, by the plan, and by another choice; on one scale.
pub(super) fn over_image(review: &Review) -> Vec<Figure> {
    let Some(plan) = &review.error_map else { return vec![] };
    let camera = &review.scene.camera;
    let size = [f64::from(camera.width_px), f64::from(camera.height_px)];
    // The plan's own scale for all: another choice may be ten times worse, and is of the last colour then.
    let most = plan.greatest();
    let title = |of: &str| format!("Map error over the image: {of}");
    let before = review.error_map_before.iter();
    let mut figures: Vec<Figure> =
        before.map(|map| error_map("error-over-image-before", title("before this plan"), map, size, most)).collect();
    figures.push(error_map("error-over-image", title("this plan"), plan, size, most));
    if let Some((other, map)) = review.others.first().and_then(|other| Some((other, other.error_map.as_ref()?))) {
        let title = title(&format!("{} poses by {} instead", other.ids.len(), other.method));
        figures.push(error_map("error-over-image-other", title, map, size, most));
    }
    figures
}

/// A map of errors, coloured from 0 to `most`.
pub(super) fn error_map(name: &'static str, title: String, map: &ErrorGrid, size: [f64; 2], most: f64) -> Figure {
    let caption = format!(
        "How far the calibration's error moves what is seen there, RMS: {} px at most; the last colour is {} px or more.",
        short(map.greatest()),
        short(most)
    );
    let content = Content::Map { rows: map.error_px.clone(), size, most, unit: "px" };
    Figure { name: name.into(), title, caption, x: "u [px]".into(), y: "v [px]".into(), content }
}

/// Standard deviations sampled in simulated calibrations as a share of those predicted.
pub(super) fn sampled(verification: &Verification) -> Figure {
    let rows = verification.parameters.iter().filter_map(|parameter| {
        let [least, greatest] = parameter.ratio_interval;
        Some(Interval { name: parameter.name.clone(), value: parameter.ratio?, range: (least?, greatest?) })
    });
    Figure {
        name: "sampled-sigma".into(),
        title: "Is the prediction kept?".into(),
        caption: format!(
            "Standard deviation of each intrinsic in {} simulated calibrations, as a share of the predicted: it should lie within its bar, \
             where 99 % would.",
            verification.trials
        ),
        x: "sampled / predicted".into(),
        y: String::new(),
        content: Content::Intervals { rows: rows.collect(), expected: 1.0 },
    }
}

/// Correlations of the intrinsics.
pub(super) fn correlations(plan: &Plan, review: &Review) -> Option<Figure> {
    (!review.correlation.is_empty()).then(|| Figure {
        name: "correlation".into(),
        title: "Which intrinsics are hard to tell apart".into(),
        caption: "Correlation of the errors: near 1 or −1 the two err together, and only their combination is known."
            .into(),
        x: String::new(),
        y: String::new(),
        content: Content::Matrix { names: plan.intrinsics.names.clone(), rows: review.correlation.clone() },
    })
}
