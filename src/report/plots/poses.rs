//! What became of the configurations, and where the joints of the poses are.

use crate::figures::grouped;
use crate::plan::document::{Plan, Review};
use crate::report::figure::{Content, Figure, Hue, Mark, Series};

/// From candidates to views and poses, and why the others were rejected.
pub(super) fn rejections(plan: &Plan) -> Figure {
    let survey = &plan.survey;
    let candidate_count = survey.views + survey.rejected.values().sum::<usize>();
    let candidates = format!("{} candidates", grouped(candidate_count));
    let views = format!("{} views", grouped(survey.views));
    let mut links = vec![(candidates.clone(), views.clone(), survey.views as f64)];
    let rejected = survey.rejected.iter().filter(|(_, count)| **count > 0);
    links.extend(rejected.map(|(reason, &count)| {
        (candidates.clone(), format!("{} {}", grouped(count), reason.replace('_', " ")), count as f64)
    }));
    Figure {
        name: "rejections".into(),
        title: "From configurations to views".into(),
        caption: format!(
            "Of {} configurations swept, {} point the camera at the board's zone; what became of these.",
            grouped(survey.swept),
            grouped(candidate_count)
        ),
        x: String::new(),
        y: String::new(),
        content: Content::Flow(links),
    }
}

/// Joint values within their limits.
pub(super) fn joints(review: &Review) -> Figure {
    let joints = &review.scene.joints;
    let mut points = vec![];
    let mut titles = vec![];
    for pose in &review.poses {
        for (j, (joint, value)) in joints.iter().zip(&pose.joints_display).enumerate() {
            points.push((100.0 * (value - joint.min) / (joint.max - joint.min), (joints.len() - j) as f64));
            titles.push(format!("pose {}: {} {value:.1} {}", pose.id, joint.name, joint.unit));
        }
    }
    Figure {
        name: "joints".into(),
        title: "Where the joints are within their limits".into(),
        caption: "0 % is the lower limit, 100 % the upper. Poses at a limit leave a robot no room to correct.".into(),
        x: "share of the joint's range [%]".into(),
        y: String::new(),
        content: Content::Rows {
            names: joints.iter().map(|joint| joint.name.clone()).collect(),
            series: vec![Series { name: "poses".into(), hue: Hue::Plan, mark: Mark::Discs, points, titles }],
        },
    }
}
