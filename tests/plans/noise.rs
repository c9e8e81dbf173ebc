//! Plans under noise that depends on the view: what is predicted, with and without weights, is what simulated calibrations come to.

use std::path::Path;

use calipose::plan::assess::verify;
use calipose::plan::choose::Chooser;
use calipose::plan::survey::survey;
use calipose::problem::{Overrides, Problem};
use calipose::verification::{Disturbance, Weighing};

fn problem(set: &[&str]) -> Problem {
    let set = ["sweep.step_deg=12", "selection.off_grid=false", "noise.model=edges"].iter().chain(set);
    let overrides = set.fold(Overrides::new(), |overrides, set| overrides.set(set).unwrap());
    Problem::read_with(Path::new("problems/servosila-engineer.toml"), &overrides).unwrap()
}

/// The joint values of the best ten poses, and their predicted map error.
fn best(problem: &Problem) -> (Vec<Vec<f64>>, f64) {
    let survey = survey(problem, &|_| {}).unwrap();
    let (choice, _) = Chooser::new(problem, &survey).unwrap().best(10, 0).unwrap();
    (choice.selected.iter().map(|&i| survey.views[i].q.clone()).collect(), choice.map_error)
}

#[test]
fn calibrations_with_and_without_weights_scatter_as_predicted() {
    let problem = problem(&[]);
    let (configurations, map_error) = best(&problem);
    let (mut predicted, mut measured) = (Vec::new(), Vec::new());
    for weighing in [Weighing::Weighted, Weighing::Unweighted] {
        let found = verify(&problem, &configurations, &Disturbance::default(), weighing, 300, 1, &|_| {}).unwrap();
        assert!(found.failures.is_empty(), "{:?}", found.failures);
        for parameter in &found.parameters {
            // 99 % intervals, widened a little: nine of them are asked at once.
            let (low, high) = parameter.interval;
            assert!(low < 1.05 && high > 0.95, "{weighing:?}: {parameter:?}");
        }
        predicted.push(found.map_error.predicted);
        measured.push(found.map_error.measured);
    }
    assert!((predicted[0] / map_error - 1.0).abs() < 1e-9);
    // No estimate without bias scatters less than the weighted one, and here it makes a difference.
    assert!(predicted[1] > 1.02 * predicted[0], "{predicted:?}");
    assert!(measured[1] > 1.02 * measured[0], "of the same pictures: {measured:?}");
}

#[test]
fn under_constant_noise_weights_change_nothing() {
    let problem = problem(&["noise.model=constant"]);
    let (configurations, _) = best(&problem);
    let [a, b] = [Weighing::Weighted, Weighing::Unweighted]
        .map(|weighing| verify(&problem, &configurations, &Disturbance::default(), weighing, 3, 1, &|_| {}).unwrap());
    assert!((a.map_error.predicted / b.map_error.predicted - 1.0).abs() < 1e-9);
    assert_eq!(a.map_error.measured, b.map_error.measured);
}

/// Nearer than one and a half windows another edge comes into the window, and the detector goes astray.
#[test]
fn squares_are_as_high_as_the_detectors_window_needs() {
    let spacing = |set: &[&str]| of_the_rover(set).visibility.min_corner_spacing;
    assert_eq!(spacing(&["noise.model=constant"]), 5.0);
    assert_eq!(spacing(&[]), 8.0);
    assert_eq!(spacing(&["noise.window_px=11"]), 17.0);
    assert_eq!(spacing(&["noise.window_px=11", "visibility.min_corner_spacing_px=6"]), 6.0);
    // Markers are 2 px beyond the window: those of a ChArUco board 4.5 mm aside and above the corners of squares of 35 mm; in
    // tags of 0.3 times their side between them the bits begin behind a fifth.
    let charuco = "target={ kind='charuco', columns=9, rows=7, square_mm=35, marker_mm=26, dictionary='DICT_5X5_50', pose={ position_mm=[500, 0, 0] } }";
    assert!((spacing(&[charuco]) - 7.0 * 35.0 / (4.5 * 2f64.sqrt())).abs() < 1e-9);
    assert_eq!(spacing(&[charuco, "noise.model=constant"]), 5.0);
    let tags =
        "target={ kind='aprilgrid', columns=6, rows=6, tag_mm=40, tag_spacing=0.3, pose={ position_mm=[500, 0, 0] } }";
    assert_eq!(spacing(&[tags]), 8.0);
    assert!((spacing(&[tags, "noise.window_px=3"]) - 5.0 * 0.3 / (0.2 * 2f64.sqrt())).abs() < 1e-9);
}

#[test]
fn the_margin_leaves_room_for_the_detectors_window() {
    let margin = |set: &[&str]| of_the_rover(set).visibility.margin;
    assert_eq!(margin(&["noise.model=constant"]), 5.0);
    assert_eq!(margin(&[]), 8.0);
    assert_eq!(margin(&["noise.window_px=11"]), 14.0);
    assert_eq!(margin(&["noise.window_px=11", "visibility.margin_px=6"]), 6.0);
}

fn of_the_rover(set: &[&str]) -> Problem {
    let set = ["selection.off_grid=false"].iter().chain(set);
    let overrides = set.fold(Overrides::new(), |overrides, set| overrides.set(set).unwrap());
    Problem::read_with(Path::new("problems/six-axis-rover.toml"), &overrides).unwrap()
}

/// An open aperture draws the poses to the distance in focus.
#[test]
fn a_plan_prefers_distances_in_focus() {
    let mean_distance = |focus: &str| {
        let problem = problem(&[focus, "noise.aperture_mm=8"]);
        let survey = survey(&problem, &|_| {}).unwrap();
        let (choice, _) = Chooser::new(&problem, &survey).unwrap().best(10, 0).unwrap();
        let distances = choice.selected.iter().map(|&i| survey.views[i].X_CT.translation.vector.norm());
        distances.sum::<f64>() / 10.0
    };
    let [near, far] = ["noise.focus_mm=500", "noise.focus_mm=800"].map(mean_distance);
    assert!(far > near + 0.1, "{near} {far} m");
}
