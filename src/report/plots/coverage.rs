//! Where the views are, and which of them were chosen.

use crate::figures::grouped;
use crate::plan::document::{Review, SurveyedViews};
use crate::report::figure::{Content, Figure, Hue, Mark, Series};

/// Tilt and azimuth of views and poses.
pub(super) fn directions(review: &Review) -> Figure {
    Figure {
        name: "coverage-directions".into(),
        title: "From which directions the board is seen".into(),
        caption: "Calibration lives on tilt: views from straight above say little of the focal length.".into(),
        x: "azimuth about the board's normal [°]".into(),
        y: "tilt [°]".into(),
        content: series(review, |views, i| (views.azimuth_deg[i], views.tilt_deg[i])),
    }
}

/// Distance of views and poses, and the picture's share that the board takes.
pub(super) fn pictures(review: &Review) -> Figure {
    Figure {
        name: "coverage-pictures".into(),
        title: "How large the board is in the picture".into(),
        caption: "Pictures that the board fills measure the lens up to the border.".into(),
        x: "distance [mm]".into(),
        y: "share of the picture [%]".into(),
        content: series(review, |views, i| (1e3 * views.distance_m[i], 100.0 * views.image_share[i])),
    }
}

fn series(review: &Review, point: impl Fn(&SurveyedViews, usize) -> (f64, f64)) -> Content {
    let views = &review.views;
    let of = |ids: &[usize]| -> Vec<(usize, (f64, f64))> {
        let place = |id: &usize| views.ids.binary_search(id).ok();
        ids.iter().filter_map(|id| Some((*id, point(views, place(id)?)))).collect()
    };
    let stride = views.ids.len().div_ceil(super::MOST_DOTS).max(1);
    let mut all = vec![Series {
        name: format!("{} views", grouped(views.all)),
        hue: Hue::Views,
        mark: Mark::Dots,
        points: (0..views.ids.len()).step_by(stride).map(|i| point(views, i)).collect(),
        titles: vec![],
    }];
    for other in &review.others {
        let points = of(&other.ids);
        all.push(Series {
            name: other.method.clone(),
            hue: Hue::Other,
            mark: Mark::Diamonds,
            titles: points.iter().map(|(id, _)| format!("view {id}, by {}", other.method)).collect(),
            points: points.into_iter().map(|(_, point)| point).collect(),
        });
    }
    let poses: Vec<usize> = review.poses.iter().map(|pose| pose.id).collect();
    let points = of(&poses);
    all.push(Series {
        name: "this plan".into(),
        hue: Hue::Plan,
        mark: Mark::Discs,
        titles: points.iter().map(|(id, _)| format!("pose {id}")).collect(),
        points: points.into_iter().map(|(_, point)| point).collect(),
    });
    Content::Series(all)
}
