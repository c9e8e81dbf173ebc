//! Studies: every cell a problem with another setting of the factors, every row a choice of poses.

mod cell;
mod forecast;
mod read;
mod run;
mod statistics;
mod store;
mod summary;
mod table;

pub use forecast::Forecast;
pub use run::{RunError, run};
pub use store::{Store, StoreError};
pub use summary::Results;
pub use table::StudyTable;

use std::path::{Path, PathBuf};

use super::base::{Base, SettingFault};
use super::factor::{Factor, Level, Source, coordinate};
use super::file::Sequence;
use crate::information::Criterion;
use crate::problem::{Allowed, Method, Problem, ProblemError, StatedDisturbance};

/// A checked study.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// Its name.
    pub name: String,
    /// SHA-256 of the study file's bytes, in lower-case hexadecimal.
    pub sha256: String,
    /// What is varied.
    pub factors: Vec<Factor>,
    /// Columns of the table that are summarised.
    pub outcomes: Vec<String>,
    /// Folder for the results, relative to the working directory.
    pub output: PathBuf,
    bases: Vec<Base>,
    /// `KEY=VALUE` in all cells.
    set: Vec<String>,
    layout: Layout,
    choices: Choices,
    simulation: Simulation,
}

/// How the factors are combined.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Layout {
    Full,
    Paired,
    Sampled { draws: u32, sequence: Sequence, seed: u32 },
}

/// What is chosen in each cell; what is empty is as the cell's problem says.
#[derive(Debug, Clone, PartialEq)]
struct Choices {
    methods: Vec<Method>,
    criteria: Vec<Criterion>,
    counts: Vec<usize>,
    seeds: u64,
}

/// A cell: a problem with a setting of the factors.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Its number.
    pub index: usize,
    /// Number of its base problem.
    pub problem: usize,
    /// The levels, one for each factor.
    pub levels: Vec<Level>,
}

/// Calibrations to simulate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Simulation {
    /// How many.
    pub trials: usize,
    /// What the prediction leaves out.
    pub deviations: StatedDisturbance,
}

/// Some of the cells: those whose number leaves `part` when divided by `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    /// From 0.
    pub part: usize,
    /// At least 1.
    pub of: usize,
}

impl Shard {
    /// Every cell.
    pub const ALL: Self = Self { part: 0, of: 1 };

    /// Its cells among so many.
    pub fn cells(self, all: usize) -> impl Iterator<Item = usize> {
        (self.part..all).step_by(self.of)
    }
}

/// What the keys of the simulation begin with where they are factors.
const SIMULATE: &str = "simulate.";

impl Study {
    /// The study that the file at `path` states.
    ///
    /// # Errors
    /// When the file, or a base problem, cannot be read or says something impossible.
    pub fn read(path: &Path) -> Result<Self, ProblemError> {
        read::read(path)
    }

    /// The JSON Schema of study files, for editors.
    pub fn schema_json() -> serde_json::Value {
        read::schema_json()
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.bases.len() * self.settings()
    }

    /// Whether settings are drawn.
    pub(crate) fn is_sampled(&self) -> bool {
        matches!(self.layout, Layout::Sampled { .. })
    }

    /// Names of the base problems.
    pub fn problems(&self) -> Vec<&str> {
        self.bases.iter().map(|base| base.name.as_str()).collect()
    }

    /// Settings of the factors.
    fn settings(&self) -> usize {
        match self.layout {
            Layout::Full => self.factors.iter().filter_map(Factor::levels).map(<[Level]>::len).product(),
            Layout::Paired => self.factors.first().and_then(Factor::levels).map_or(1, <[Level]>::len),
            Layout::Sampled { draws, .. } => draws as usize,
        }
    }

    /// Cell number `index`, below [`Study::cells`]. Of a full design the last factor varies first, the problem last.
    pub fn cell(&self, index: usize) -> Cell {
        let settings = self.settings();
        let (problem, setting) = (index / settings, index % settings);
        let mut rest = setting;
        let mut levels: Vec<Level> = Vec::with_capacity(self.factors.len());
        for (dimension, factor) in self.factors.iter().enumerate().rev() {
            levels.push(match (self.layout, &factor.source) {
                (Layout::Full, Source::Levels(list)) => {
                    let level = list[rest % list.len()].clone();
                    rest /= list.len();
                    level
                }
                (Layout::Paired, Source::Levels(list)) => list[setting].clone(),
                (Layout::Sampled { sequence, seed, .. }, _) => {
                    factor.level_at(coordinate(sequence, seed, setting as u32, dimension as u32))
                }
                // Refused when the file is read.
                (Layout::Full | Layout::Paired, Source::Drawn { .. }) => factor.level_at(0.5),
            });
        }
        levels.reverse();
        Cell { index, problem, levels }
    }

    /// The problem of a cell.
    ///
    /// # Errors
    /// When its base refuses the setting.
    pub fn problem(&self, cell: &Cell) -> Result<Problem, SettingFault> {
        let settings = cell.levels.iter().flat_map(|level| &level.set);
        self.with(&self.bases[cell.problem], settings)
    }

    /// A base problem with `settings`.
    fn with<'s>(&'s self, base: &Base, settings: impl Iterator<Item = &'s String>) -> Result<Problem, SettingFault> {
        base.problem(self.set.iter().chain(settings).filter(|text| !is_of_simulation(text)))
    }

    /// What is simulated in a cell.
    ///
    /// # Errors
    /// When a key of the simulation refuses its value.
    pub fn simulation(&self, cell: &Cell) -> Result<Simulation, SettingFault> {
        let mut simulation = self.simulation;
        for text in cell.levels.iter().flat_map(|level| &level.set).filter(|text| is_of_simulation(text)) {
            simulation.set(text).map_err(SettingFault::Simulation)?;
        }
        Ok(simulation)
    }
}

impl Simulation {
    /// Numbers of calibrations: one has no scatter.
    const TRIALS: Allowed = Allowed::between(0.0, 1e6);

    /// Sets a key as `simulate.KEY=NUMBER` says.
    ///
    /// # Errors
    /// What is wrong with it.
    fn set(&mut self, text: &str) -> Result<(), String> {
        let (key, value) = text.split_once('=').map_or((text, ""), |(key, value)| (key, value));
        let (key, value) = (key.trim(), value.trim());
        let number: f64 = value.parse().map_err(|_| format!("`{key}` is {value}, which is no number"))?;
        let name = key.trim_start_matches(SIMULATE);
        if name == "trials" {
            if !Self::TRIALS.contains(number) || number.fract() != 0.0 || number == 1.0 {
                return Err(format!("`{key}` is {value}; it must be 0 or a whole number from 2 to 1000000"));
            }
            self.trials = number as usize;
            return Ok(());
        }
        let mut numbers = self.deviations.numbers().into_iter();
        let (_, place, most) =
            numbers.find(|(known, ..)| *known == name).ok_or_else(|| format!("there is no key `{key}`"))?;
        if !(0.0..=most).contains(&number) {
            return Err(format!("`{key}` is {value}; it must be from 0 to {most}"));
        }
        *place = number;
        Ok(())
    }
}

/// Whether `KEY=VALUE` is of a key of the simulation.
fn is_of_simulation(text: &str) -> bool {
    text.trim_start().starts_with(SIMULATE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refused_cell_tells_all_that_is_wrong_and_no_path() {
        let text = include_str!("../../../problems/servosila-engineer.toml");
        let text = text.replace("width_px = 1280", "width_px = 0").replace("fx_px = 1000", "fx_px = -1");
        let error = Problem::parse(&text, Path::new("/somewhere/arm.toml")).unwrap_err();
        let reason = SettingFault::from(error).reason();
        assert!(reason.contains("width_px") && reason.contains("fx_px") && !reason.contains("arm"), "{reason}");
    }
}
