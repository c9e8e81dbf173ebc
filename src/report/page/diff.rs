//! The report of two plans held against each other.

use maud::html;

use super::head::{Head, Tone, figure};
use super::table::{Cell, Row, table};
use super::{page, script};
use crate::figures::{fixed, short};
use crate::plan::document::{ComparedPlan, DiffDocument, LonePose, MovedPose, SigmaChange};

/// The report of two plans held against each other, a page that stands alone.
pub fn diff_page(diff: &DiffDocument) -> String {
    let DiffDocument { a, b, same, moved, only_a, only_b, .. } = diff;
    let head = Head {
        kind: "difference of two plans",
        calipose: &diff.header.calipose,
        name: &a.problem.name,
        tone: if diff.comparable { Tone::Good } else { Tone::Open },
        verdict: format!(
            "Map error {} px by A, {} px by B; {} poses are the same.",
            short(a.map_error_px),
            short(b.map_error_px),
            same.len()
        ),
        details: match (diff.same_problem, diff.comparable) {
            (_, true) => String::new(),
            (false, _) => "The plans answer different problems: their values may not compare.".into(),
            (true, _) => {
                "The plans are chosen by different criteria: their values do not compare, map errors do.".into()
            }
        },
        next: html! { "Next: take the plan of the smaller map error, or of the shorter tour where they are alike." },
        figures: vec![
            figure("Poses of A", a.count.to_string(), ""),
            figure("Poses of B", b.count.to_string(), ""),
            figure("Same", same.len().to_string(), "poses"),
            figure("Moved", moved.len().to_string(), "poses"),
            figure("Only in A", only_a.len().to_string(), "poses"),
            figure("Only in B", only_b.len().to_string(), "poses"),
        ],
    };
    let body = html! {
        (head.markup())
        main {
            section id="numbers" { h2 { "Numbers" } (numbers(a, b)) }
            section id="intrinsics" { h2 { "Standard deviations" } (sigma(&diff.sigma)) }
            @if !moved.is_empty() { section id="moved" { h2 { "Poses that moved" } (moved_poses(diff)) } }
            @if !only_a.is_empty() { section id="only-a" { h2 { "Only in A" } (lone("Only in A", &diff.joints, only_a)) } }
            @if !only_b.is_empty() { section id="only-b" { h2 { "Only in B" } (lone("Only in B", &diff.joints, only_b)) } }
            @if !same.is_empty() { section id="same" { h2 { "Poses of both" } (same_poses(same)) } }
        }
        (head.foot(Some(&a.problem)))
        (script())
    };
    page(&format!("{}: difference of two plans", a.problem.name), &body)
}

fn row(cells: Vec<Cell>) -> Row {
    Row { pose: None, cells }
}

fn numbers(a: &ComparedPlan, b: &ComparedPlan) -> maud::Markup {
    let text = |name: &str, of: &dyn Fn(&ComparedPlan) -> String| {
        row([name.to_owned(), of(a), of(b)].into_iter().map(Cell::Text).collect())
    };
    let number = |name: &str, of: &dyn Fn(&ComparedPlan) -> Option<f64>| {
        row(vec![Cell::Text(name.into()), Cell::short(of(a)), Cell::short(of(b))])
    };
    let rows = [
        text("File", &|plan| plan.file.clone()),
        text("Problem", &|plan| plan.problem.name.clone()),
        text("Problem file", &|plan| plan.problem.sha256.chars().take(12).collect()),
        text("Set", &|plan| plan.problem.set.join(", ")),
        text("Made by calipose", &|plan| plan.calipose.clone()),
        text("Criterion", &|plan| plan.criterion.clone()),
        text("Method", &|plan| plan.method.clone()),
        text("Poses", &|plan| plan.count.to_string()),
        text("Pictures at each", &|plan| plan.pictures.to_string()),
        number("Value", &|plan| Some(plan.value)),
        number("Bound", &|plan| Some(plan.bound)),
        text("Certified efficiency", &|plan| format!("{:.4}", plan.efficiency)),
        number("Map error [px]", &|plan| Some(plan.map_error_px)),
        number("Moves [s]", &|plan| plan.moving_s),
        number("Moves and pictures [s]", &|plan| plan.total_s),
    ];
    table("Numbers", &["", "A", "B"].map(String::from), &rows)
}

fn sigma(changes: &[SigmaChange]) -> maud::Markup {
    let rows = changes.iter().map(|SigmaChange { name, a, b }| {
        let ratio = a.zip(*b).map(|(a, b)| b / a);
        row(vec![Cell::Text(name.clone()), Cell::short(*a), Cell::short(*b), Cell::short(ratio)])
    });
    table("Standard deviations", &["Intrinsic", "A", "B", "B / A"].map(String::from), &rows.collect::<Vec<_>>())
}

fn moved_poses(diff: &DiffDocument) -> maud::Markup {
    let header = ["Pose of A", "Pose of B"].into_iter().map(String::from);
    let header = header.chain(diff.joints.clone()).chain(["Distance [rad]".into()]);
    let rows = diff.moved.iter().map(|MovedPose { id_a, id_b, joints_a_deg, joints_b_deg, distance_rad }| {
        let ids = [id_a, id_b].map(|id| Cell::Number(id.to_string(), *id as f64));
        let joints = joints_a_deg.iter().zip(joints_b_deg);
        let joints = joints.map(|(a, b)| Cell::Text(format!("{} → {}", fixed(*a, 1), fixed(*b, 1))));
        row(ids.into_iter().chain(joints).chain([Cell::short(Some(*distance_rad))]).collect())
    });
    table("Poses that moved", &header.collect::<Vec<_>>(), &rows.collect::<Vec<_>>())
}

fn lone(name: &str, joints: &[String], poses: &[LonePose]) -> maud::Markup {
    let header = std::iter::once("Pose".to_owned()).chain(joints.iter().cloned());
    let header = header.chain(["Nearest of the other".to_owned(), "Distance [rad]".into()]);
    let rows = poses.iter().map(|LonePose { id, joints_deg, nearest, distance_rad }| {
        let joints = joints_deg.iter().map(|&q| Cell::Number(fixed(q, 1), q));
        let nearest = Cell::Number(nearest.to_string(), *nearest as f64);
        let id = std::iter::once(Cell::Number(id.to_string(), *id as f64));
        row(id.chain(joints).chain([nearest, Cell::short(Some(*distance_rad))]).collect())
    });
    table(name, &header.collect::<Vec<_>>(), &rows.collect::<Vec<_>>())
}

fn same_poses(same: &[[usize; 2]]) -> maud::Markup {
    let rows = same.iter().map(|ids| row(ids.map(|id| Cell::Number(id.to_string(), id as f64)).into()));
    table("Poses of both", &["Pose of A", "Pose of B"].map(String::from), &rows.collect::<Vec<_>>())
}
