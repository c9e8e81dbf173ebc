//! The problem file as written: one struct per section, one field per key, units in the names.
//!
//! The doc comments are the descriptions of the JSON Schema and the hints of error messages.

mod bodies;
mod camera;
mod file;
mod json;
mod motion;
mod robot;
mod robust;
mod selection;
mod sweep;
mod target;
mod value;
mod view;

pub(crate) use bodies::{Body, Collision, Mass, Scene, Stability};
pub(crate) use camera::{Camera, Distortion};
pub(crate) use file::File;
pub use json::schema_json;
pub(crate) use json::{Vocabulary, toml_schema};
pub(crate) use motion::Motion;
pub(crate) use robot::{Joint, Robot};
pub(crate) use robust::Robust;
pub(crate) use selection::{Constraints, Group, Region, Selection, TimeLimit};
pub(crate) use sweep::{Published, Sweep};
pub(crate) use target::{Target, TargetKind};
pub(crate) use value::{Choice, MountName, Named, NumberOrList, Numbers, Pose, Range, RangeOrSets, TextOrTable};
pub(crate) use view::{Estimate, Noise, Visibility};
