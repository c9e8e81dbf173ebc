//! Stages that cells share: what does not depend on a factor is computed once.

use std::collections::VecDeque;
use std::fmt::{Debug, Write};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use sha2::{Digest, Sha256};

use crate::plan::survey::{Feasible, Survey, SurveyError, candidates, feasible, weighed};
use crate::problem::Problem;
use crate::sweep::Sweep;

/// A digest of all that something follows from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Fingerprint([u8; 32]);

impl Fingerprint {
    /// Of everything that `Debug` shows of the parts: floating-point numbers are shown to the last bit.
    pub(super) fn of(parts: &dyn Debug) -> Self {
        struct Hasher(Sha256);
        impl Write for Hasher {
            fn write_str(&mut self, text: &str) -> std::fmt::Result {
                self.0.update(text);
                Ok(())
            }
        }
        let mut hasher = Hasher(Sha256::new());
        // Writing to a digest never fails.
        let _ = write!(hasher, "{parts:?}");
        Self(hasher.0.finalize().into())
    }

    /// In lower-case hexadecimal.
    pub(super) fn hex(&self) -> String {
        self.0.iter().fold(String::new(), |hex, byte| hex + &format!("{byte:02x}"))
    }
}

/// What the stages of a problem's survey follow from, the first first. Cells in the order of these share what they can.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct StageKeys {
    sweep: Fingerprint,
    feasible: Fingerprint,
    survey: Fingerprint,
}

impl StageKeys {
    pub(super) fn of(problem: &Problem) -> Self {
        let Problem { robot, camera, target, space, axis, visibility, clearance, stability, robust, .. } = problem;
        let sweep = Fingerprint::of(&(robot, target, space, axis));
        let robust = robust.as_ref().map(|robust| (robust, problem.selection.seed));
        let feasible = Fingerprint::of(&(sweep, camera, visibility, clearance, stability, robust));
        let survey = Fingerprint::of(&(feasible, problem.noise, &problem.estimated, problem.selection.pictures));
        Self { sweep, feasible, survey }
    }
}

/// The stages computed last.
pub(super) struct Stages {
    sweeps: Shelf<Result<Sweep, SurveyError>>,
    feasible: Shelf<Result<Feasible, SurveyError>>,
    surveys: Shelf<Result<Survey, SurveyError>>,
}

impl Stages {
    /// For so many workers at a time. Each must be on threads of its own: one that waits for another's stage must not be lent to it.
    pub(super) fn new(workers: usize) -> Self {
        Self { sweeps: Shelf::new(workers), feasible: Shelf::new(workers), surveys: Shelf::new(workers) }
    }

    /// The survey of `problem`, which has these keys.
    pub(super) fn survey(&self, problem: &Problem, keys: &StageKeys) -> Arc<Result<Survey, SurveyError>> {
        self.surveys.get(&keys.survey, || {
            let sweep = self.sweeps.get(&keys.sweep, || candidates(problem, &|_| {}));
            let sweep = (*sweep).as_ref().map_err(Clone::clone)?;
            let found = self.feasible.get(&keys.feasible, || feasible(problem, sweep));
            let found = (*found).as_ref().map_err(Clone::clone)?;
            weighed(problem, sweep.clone(), found.clone())
        })
    }
}

/// Values by what they follow from, those asked for last; each is made once, and others wait for it.
struct Shelf<T> {
    room: usize,
    places: Mutex<VecDeque<(Fingerprint, Place<T>)>>,
}

/// A value, or where it will be.
type Place<T> = Arc<OnceLock<Arc<T>>>;

impl<T> Shelf<T> {
    fn new(workers: usize) -> Self {
        Self { room: workers + 1, places: Mutex::new(VecDeque::new()) }
    }

    fn get(&self, key: &Fingerprint, make: impl FnOnce() -> T) -> Arc<T> {
        Arc::clone(self.place(key).get_or_init(|| Arc::new(make())))
    }

    fn place(&self, key: &Fingerprint) -> Place<T> {
        // A worker that panicked has left the list whole.
        let mut places = self.places.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, place)) = places.iter().find(|(known, _)| known == key) {
            return Arc::clone(place);
        }
        if places.len() == self.room {
            places.pop_front();
        }
        let place = Arc::new(OnceLock::new());
        places.push_back((*key, Arc::clone(&place)));
        place
    }
}
