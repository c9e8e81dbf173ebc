//! The pictures of a tour, as calibrations take them.

use std::collections::HashSet;

use crate::calibration::{ObservationError, Observations, View};
use crate::plan::document::{TakenPicture, Visit};
use crate::problem::Problem;

/// Why no calibration takes the picture, if so.
pub(super) fn fault(problem: &Problem, picture: &TakenPicture) -> Option<ObservationError> {
    observations(problem, vec![picture.view()]).err()
}

/// Views of the problem's board by its camera, checked.
pub(super) fn observations(problem: &Problem, views: Vec<View>) -> Result<Observations, ObservationError> {
    let Problem { camera, target, .. } = problem;
    Observations::new(target.board.clone(), camera.width(), camera.height(), views)
}

/// All pictures of the visits, each with the place of its visit.
pub(super) fn pictures(visits: &[Visit]) -> impl Iterator<Item = (usize, &TakenPicture)> {
    visits.iter().enumerate().flat_map(|(place, visit)| visit.pictures.iter().map(move |picture| (place, picture)))
}

/// A name for each picture that no other has and that tables take: the image's, with the file's before it where that is another's too.
pub(super) fn names<'p>(pictures: impl Iterator<Item = &'p TakenPicture>) -> Vec<String> {
    let mut taken = HashSet::new();
    let unique = |picture: &TakenPicture| {
        let in_file = || format!("{}:{}", picture.file, picture.name);
        let numbered = (2..).map(|number| format!("{}#{number}", in_file()));
        let names = [picture.name.clone(), in_file()].into_iter().chain(numbered);
        let mut names = names.map(|name| name.split_whitespace().collect::<Vec<_>>().join("_"));
        names.find(|name| taken.insert(name.clone())).unwrap_or_default()
    };
    pictures.map(unique).collect()
}
