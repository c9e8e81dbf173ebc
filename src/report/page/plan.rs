//! The report of a plan.

use maud::{Markup, html};

use super::facts::{degrees, facts, joint, millimetres, percent};
use super::head::{Head, Tone, figure};
use super::picture::picture;
use super::space::space;
use super::table::{Cell, Row, table};
use super::tour::tour;
use super::{page, plots};
use crate::figures::{grouped, short};
use crate::plan::document::{
    Explanation, NearestLinks, Plan, PlannedPose, PoseExplanation, Review, ReviewedPose, SceneJoint,
};
use crate::report::plots::plan_figures;
use crate::report::{PlanDocuments, outcome};

/// The report of a plan, a page that stands alone.
pub fn plan_page(documents: &PlanDocuments) -> String {
    let PlanDocuments { plan, review, explanation, .. } = documents;
    let head = head(documents);
    let tour = tour(documents);
    let body = html! {
        (head.markup())
        nav class="contents" aria-label="Contents" {
            @if tour.is_some() { a href="#tour" { "Tour" } " " }
            a href="#poses" { "Poses" } a href="#plots" { "Plots" } a href="#intrinsics" { "Intrinsics" } a href="#made" { "How it was made" }
        }
        main {
            div class="stage" {
                (space(review))
                @if let Some(tour) = &tour { (tour) }
                section id="picture" {
                    h2 { "What the camera sees" }
                    div class="panels" { @for pose in &review.poses { (panel(review, explanation, pose)) } }
                }
            }
            section id="poses" { h2 { "Poses" } (poses(plan, review, explanation)) }
            section id="plots" {
                h2 { "Plots" }
                (plots(&plan_figures(documents)))
            }
            section id="intrinsics" { h2 { "Intrinsics" } (intrinsics(documents)) }
            section id="made" { h2 { "How it was made" } (made(plan)) }
        }
        (head.foot(Some(&plan.problem)))
    };
    page(&format!("{}: {} calibration poses", plan.problem.name, plan.count), &body)
}

/// The verdict first, in words, with what to do next; then the figures that matter.
fn head<'a>(documents: &PlanDocuments<'a>) -> Head<'a> {
    let PlanDocuments { plan, review, verification, .. } = documents;
    let holds = verification.and_then(|verification| verification.holds);
    let (tone, verdict) = match holds {
        Some(false) => (Tone::Bad, "The plan does not do what it predicts: do not use it before you know why."),
        Some(true) => (Tone::Good, "The plan does what it predicts."),
        None => (Tone::Open, "The plan has not been tried in simulated calibrations."),
    };
    let mut poses = format!("of {} views", grouped(review.views.all));
    if plan.pictures > 1 {
        poses = format!("{poses}, with {} pictures each", plan.pictures);
    }
    let mut figures = vec![
        figure("Poses", plan.count.to_string(), &poses),
        html! {
            div {
                dt { "Map error" } dd { (short(plan.map_error_px)) " " small { "px RMS over the image" } }
                @if let Some(measured) = verification.and_then(|verification| verification.map_error_px.measured) {
                    dd { (short(measured)) " px in simulated calibrations" }
                }
                @if let Some(unweighted) = &plan.unweighted {
                    dd { (short(unweighted.map_error_px)) " px by plain least squares, as OpenCV's" }
                }
                @if let Some(trial) = plan.robust.as_ref().map(|robust| &robust.trial) && let Some(most) = trial.map_error_of_99_percent_px {
                    dd { (short(most)) " px or less in 99 % of " (grouped(trial.set_ups)) " other set-ups" }
                }
            }
        },
        figure("Certified efficiency", format!("{:.3}", plan.efficiency), ""),
    ];
    figures.extend(plan.tour.as_ref().map(|tour| {
        figure("Time", format!("{:.0} s", tour.total_s), &format!("of which {:.0} s on the way", tour.moving_s))
    }));
    figures.extend(review.others.iter().map(|other| {
        let name = format!("{} poses by {}", other.ids.len(), other.method);
        other
            .map_error_px
            .map_or_else(|| figure(&name, "undetermined", ""), |error| figure(&name, short(error), "px RMS"))
    }));
    Head {
        kind: "calibration plan",
        calipose: &plan.header.calipose,
        name: &plan.problem.name,
        tone,
        verdict: verdict.into(),
        details: outcome(plan).replace('`', ""),
        next: next(plan, holds),
        figures,
    }
}

/// What to do next.
fn next(plan: &Plan, holds: Option<bool>) -> Markup {
    let blocked = plan.tour.as_ref().map_or(0, |tour| tour.blocked().count());
    let untested = plan.collision.as_ref().is_none_or(|collision| !collision.tested);
    html! {
        @if holds == Some(false) {
            "Next: look at the intrinsics that scatter more than predicted below, and add poses or relax the lens model."
        } @else {
            "Next: inspect the poses below, take a picture at each (plan.csv has the joint values), and run " code { "calipose calibrate" } "."
        }
        @if blocked > 0 {
            " " strong { (blocked) " of the moves between the poses are not proven safe" } ": the table says which."
        }
        @if untested {
            " " strong { "Collision was not tested" } ": the problem file gives the robot no bodies, so poses may drive the arm into itself, "
            "the board or its surroundings."
        }
    }
}

/// What one pose shows, why it is there and what could take its place.
fn panel(review: &Review, explanation: &Explanation, pose: &ReviewedPose) -> Markup {
    let joints = &review.scene.joints;
    let mut known: Vec<(&str, String)> = vec![("configuration", pose.id.to_string())];
    known.extend(joints.iter().zip(&pose.joints_display).map(|(j, &value)| (j.name.as_str(), joint(value, &j.unit))));
    known.extend([
        ("tilt", degrees(pose.tilt_deg)),
        ("distance", millimetres(pose.distance_m)),
        ("board in the picture", percent(pose.picture.image_share)),
        ("corners to the border", format!("{:.0} px", pose.picture.margin_px)),
        ("share of the information", percent(pose.share)),
    ]);
    if !pose.picture.hidden.is_empty() {
        known.push(("corners hidden", pose.picture.hidden.len().to_string()));
    }
    if let Some(NearestLinks { links: [a, b], distance_m }) = &pose.nearest {
        known.push(("least clearance", format!("{}, {a} – {b}", millimetres(*distance_m))));
    }
    let explained = explanation.poses.iter().find(|explained| explained.id == pose.id);
    let name = format!("What the camera sees at pose {}", pose.label);
    html! {
        article class="panel" data-pose-panel=(pose.id) {
            h3 { "Pose " (pose.label) }
            (picture(&review.scene, &pose.picture, &name))
            (facts(&known))
            @if let Some(explained) = explained { (worth(explained)) }
        }
    }
}

/// What a pose is worth to the plan.
fn worth(explained: &PoseExplanation) -> Markup {
    html! {
        p {
            "Without it, " (percent(explained.loss)) " of the information is lost"
            @if let Some(error) = explained.map_error_px { ", and the map error is " (short(error)) " px" }
            @if let Some(most) = &explained.suffers_most {
                "; it pins down " (most.name) ", whose standard deviation would be " (short(most.sigma_without)) " in place of " (short(most.sigma))
            }
            "."
        }
        @if !explained.spares.is_empty() {
            p {
                "In its place: "
                @for (i, spare) in explained.spares.iter().enumerate() {
                    @if i > 0 { ", " }
                    "configuration " (spare.id) " (" (percent(spare.loss)) " lost)"
                }
                "."
            }
        }
    }
}

fn poses(plan: &Plan, review: &Review, explanation: &Explanation) -> Markup {
    let joints = &review.scene.joints;
    let sign = |unit: &str| if unit == "deg" { "°".to_owned() } else { unit.to_owned() };
    let stable = plan.poses.iter().any(|pose| pose.stability_margin_m.is_some());
    let mut header = vec!["Pose".to_owned(), "Configuration".into()];
    header.extend(joints.iter().map(|joint| format!("{}, {}", joint.name, sign(&joint.unit))));
    header.extend(
        ["Tilt, °", "Distance, mm", "To a limit, %", "To the border, px", "Share, %", "Lost without it, %"]
            .map(String::from),
    );
    if stable {
        header.push("To tipping over, mm".into());
    }
    let tested = review.poses.iter().any(|pose| pose.nearest.is_some());
    if tested {
        header.push("Least clearance, mm".into());
    }
    if plan.tour.is_some() {
        header.push("Move there, s".into());
    }
    let number = |value: f64, decimals: usize| Cell::Number(format!("{value:.decimals$}"), value);
    let row = |(place, (pose, planned)): (usize, (&ReviewedPose, &PlannedPose))| {
        let show = html! {
            button type="button" class="choose" aria-label={ "Show pose " (pose.label) } { "show" } (pose.label)
        };
        let mut cells = vec![Cell::Markup(show), Cell::Text(pose.id.to_string())];
        cells.extend(pose.joints_display.iter().map(|&value| number(value, 1)));
        let ranges = joints.iter().zip(&pose.joints_display).filter(|(joint, _)| joint.max > joint.min);
        let to_limit =
            |joint: &SceneJoint, value: f64| (value - joint.min).min(joint.max - value) / (joint.max - joint.min);
        let nearest = ranges.map(|(joint, &value)| to_limit(joint, value)).fold(f64::INFINITY, f64::min);
        let loss =
            explanation.poses.iter().find(|explained| explained.id == pose.id).map_or(f64::NAN, |pose| pose.loss);
        cells.extend([
            number(pose.tilt_deg, 1),
            number(1e3 * pose.distance_m, 0),
            number(100.0 * nearest, 1),
            number(pose.picture.margin_px, 0),
            number(100.0 * pose.share, 1),
            number(100.0 * loss, 1),
        ]);
        if stable {
            cells.push(number(1e3 * planned.stability_margin_m.unwrap_or(f64::NAN), 0));
        }
        if tested {
            cells.push(number(1e3 * pose.nearest.as_ref().map_or(f64::NAN, |nearest| nearest.distance_m), 0));
        }
        cells.extend(plan.tour.as_ref().map(|tour| match tour.move_to(place) {
            Some(found) if found.safe == Some(false) => Cell::Text(format!("{:.1}, NOT SAFE", found.seconds)),
            Some(found) => number(found.seconds, 1),
            None => Cell::Text("–".into()),
        }));
        Row { pose: Some(pose.id), cells }
    };
    let rows: Vec<Row> = review.poses.iter().zip(plan.in_order()).enumerate().map(row).collect();
    table("Poses", &header, &rows)
}

fn intrinsics(documents: &PlanDocuments) -> Markup {
    let PlanDocuments { plan, explanation, verification, .. } = documents;
    let mut header = vec!["Intrinsic".to_owned(), "Nominal".into(), "Predicted sigma".into()];
    if verification.is_some() {
        header.extend(["Sampled sigma".into(), "Sampled / predicted".into(), "Bias".into()]);
    }
    let known = &plan.intrinsics;
    let row = |(i, name): (usize, &String)| {
        let mut cells =
            vec![Cell::Text(name.clone()), Cell::short(Some(known.nominal[i])), Cell::short(Some(known.sigma[i]))];
        if let Some(verification) = verification {
            let found = verification.parameters.iter().find(|parameter| parameter.name == *name);
            cells.push(Cell::short(found.and_then(|parameter| parameter.sampled_sigma)));
            cells.push(Cell::short(found.and_then(|parameter| parameter.ratio)));
            cells.push(Cell::short(found.and_then(|parameter| parameter.bias)));
        }
        Row { pose: None, cells }
    };
    let rows: Vec<Row> = known.names.iter().enumerate().map(row).collect();
    let least = &explanation.least_known;
    let terms = least.combination.iter().filter(|term| term.coefficient.abs() >= 0.1);
    let terms: Vec<String> = terms.map(|term| format!("{:+.2} {}", term.coefficient, term.name)).collect();
    html! {
        (table("Intrinsics", &header, &rows))
        p {
            "Known least: the combination " (terms.join(" ")) ", each in the change that moves the image by 1 px"
            @if let Some(moves) = least.moves_image_px { "; one standard deviation of it moves the image by " (short(moves)) " px RMS" }
            "."
        }
    }
}

fn made(plan: &Plan) -> Markup {
    let survey = &plan.survey;
    facts(&[
        ("criterion", plan.criterion.clone()),
        ("method", plan.method.clone()),
        ("value", short(plan.value)),
        ("bound", short(plan.bound)),
        ("seed", plan.seed.to_string()),
        ("configurations swept", grouped(survey.swept)),
        ("axes in the zone", grouped(survey.axis_inside)),
        ("axes on its edge", grouped(survey.axis_edge)),
        ("views", grouped(survey.views)),
        ("views off the grid", grouped(survey.off_grid)),
    ])
}
