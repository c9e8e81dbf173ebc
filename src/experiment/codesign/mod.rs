//! The design of the set-up itself: where the board lies, how large it is, how the camera is turned.
//!
//! Every set-up is judged by the best plan that it allows, all checks of the problem on. Set-ups all over the ranges are screened on a
//! coarser sweep; the best of them, and then neighbours of the best, are examined on the problem's own. There a set-up is discarded
//! without a plan as soon as a bound on all its plans is worse than the best plan known, so that what is said of the set-ups examined
//! is proven.

mod evaluate;
mod problem_file;
mod read;
mod search;
mod sensitivity;

pub use search::{CodesignError, Designed};

use std::path::{Path, PathBuf};
use std::time::Instant;

use super::base::Base;
use super::factor::{Factor, Level, coordinate};
use super::file::{Search, Sequence};
use crate::plan::document::{DesignCheckDocument, Document, ProblemReference};
use crate::problem::{Problem, ProblemError};

/// A checked design.
#[derive(Debug, Clone, PartialEq)]
pub struct Codesign {
    /// Its name.
    pub name: String,
    /// SHA-256 of the design file's bytes, in lower-case hexadecimal.
    pub sha256: String,
    /// What is free.
    pub free: Vec<Factor>,
    /// The problem with what the design sets in all set-ups.
    pub problem: Problem,
    /// Folder for the results, relative to the working directory.
    pub output: PathBuf,
    base: Base,
    /// `KEY=VALUE` in all set-ups.
    set: Vec<String>,
    /// Ranges in m of the coordinates of all that is printed, in the frame that the board's pose is in.
    surface: [Option<[f64; 2]>; 3],
    search: Search,
}

/// Rounding, in m, is no reason to refuse a board that fits exactly.
const SLACK: f64 = 1e-9;

/// A set-up, by its place in the ranges of what is free: from 0 to 1, exclusive.
#[derive(Debug, Clone, PartialEq)]
struct Place {
    shares: Vec<f64>,
    levels: Vec<Level>,
}

impl Codesign {
    /// The design that the file at `path` states.
    ///
    /// # Errors
    /// When the file, or the problem, cannot be read or says something impossible.
    pub fn read(path: &Path) -> Result<Self, ProblemError> {
        read::read(path)
    }

    /// The JSON Schema of design files, for editors.
    pub fn schema_json() -> serde_json::Value {
        read::schema_json()
    }

    /// Set-ups that are evaluated at most, on the coarser sweep and on the problem's own.
    pub fn evaluations(&self) -> (usize, usize) {
        let Search { screened, finalists, rounds, map, .. } = self.search;
        let neighbours = rounds as usize * search::CENTRES * 3 * self.free.len();
        let sensitivity = self.free.len() * sensitivity::STEPS.len();
        (screened as usize, finalists as usize + neighbours + sensitivity + (map * map) as usize)
    }

    /// What a search would take, from the time of one set-up.
    pub fn forecast(&self) -> DesignCheckDocument {
        let (screened, examined_at_most) = self.evaluations();
        let start = Instant::now();
        drop(evaluate::judge(&Place { shares: Vec::new(), levels: Vec::new() }, &self.problem, None));
        let one = start.elapsed().as_secs_f64();
        // A coarser sweep takes as much less as it has fewer configurations; most set-ups examined are discarded early.
        let coarse = evaluate::coarse(&self.problem.space).len() as f64 / self.problem.space.len() as f64;
        DesignCheckDocument {
            header: DesignCheckDocument::header(),
            name: self.name.clone(),
            sha256: self.sha256.clone(),
            problem: ProblemReference::new(&self.problem),
            free: self.free.iter().map(|factor| factor.name.clone()).collect(),
            screened,
            examined_at_most,
            seconds: one * (screened as f64 * coarse + examined_at_most as f64),
            output: self.output.clone(),
        }
    }

    fn place(&self, shares: Vec<f64>) -> Place {
        let levels = self.free.iter().zip(&shares).map(|(factor, &share)| factor.level_at(share)).collect();
        Place { shares, levels }
    }

    /// Point number `index` of an even sequence over the ranges.
    fn point(&self, stream: u32, index: u32) -> Vec<f64> {
        let seed = self.search.seed.wrapping_add(stream.wrapping_mul(0x0100_0193));
        let dimensions = 0..self.free.len() as u32;
        dimensions.map(|dimension| coordinate(Sequence::Sobol, seed, index, dimension)).collect()
    }

    /// The problem of a set-up; none if the problem refuses it, or not all of the board lies on the surface.
    fn problem_at(&self, place: &Place) -> Option<Problem> {
        let settings = self.set.iter().chain(place.levels.iter().flat_map(|level| &level.set));
        let problem = self.base.problem(settings).ok()?;
        self.on_surface(&problem).then_some(problem)
    }

    fn on_surface(&self, problem: &Problem) -> bool {
        let (width, height) = problem.target.board.printed_size();
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        corners.into_iter().all(|(i, j)| {
            let corner = problem.target.X_BT * nalgebra::Point3::new(i * width / 2.0, j * height / 2.0, 0.0);
            let within = |(range, x): (&Option<[f64; 2]>, f64)| {
                range.is_none_or(|[least, most]| (least - SLACK..=most + SLACK).contains(&x))
            };
            self.surface.iter().zip(corner.coords.iter().copied()).all(within)
        })
    }
}
