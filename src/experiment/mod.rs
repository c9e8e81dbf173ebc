//! Experiments: studies of how a plan depends on its problem, stated in files, and the design of the set-up itself.
//!
//! A [`Study`] is a list of cells, each a problem with another setting of the factors. [`run`] computes those that a [`Store`]
//! does not have, in an order that lets cells share the stages that their factors leave alone, and [`Results`] reads them back
//! as a table and its summary. Each cell stands alone, named by all that it follows from; so a run that was ended goes on where it
//! was, several machines can work on one study, by an [`Engine`] that they have, and what was made from other files or by another
//! version is never taken for it.

mod base;
mod codesign;
mod engine;
mod factor;
mod file;
mod reading;
mod stages;
mod study;

pub use base::SettingFault;
pub use codesign::{Codesign, CodesignError, Designed};
pub use engine::{Engine, Job, Work, shell_line};
pub use factor::{Factor, Level};
pub use study::{Cell, Forecast, Results, RunError, Shard, Simulation, Store, StoreError, Study, StudyTable, run};
