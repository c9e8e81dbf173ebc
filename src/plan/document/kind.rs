//! All kinds of documents, each with its JSON Schema.

use schemars::Schema;
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use serde_json::Value;

use super::answers::{
    CalibrationDocument, Certified, ComparisonDocument, DiffDocument, Explanation, ExportDocument, FiguresDocument,
    NextDocument, NoiseDocument, PicturesDocument, ScoreDocument, Verification,
};
use super::design::{DesignCheckDocument, DesignDocument};
use super::follow::{FollowEvent, FollowState};
use super::header::Document;
use super::plan::{Plan, PolishedPlan, Run};
use super::problem::{BoardDocument, CheckDocument, InitDocument, ReachDocument, SweepDocument};
use super::refusal::ErrorDocument;
use super::review::Review;
use super::study::{CellDocument, CellsDocument, JobDocument, StudyCheckDocument, StudyDocument};

/// A kind of document.
#[derive(Debug, Clone, Copy)]
pub struct Kind {
    /// Value of the key `format`.
    pub format: &'static str,
    /// Value of the key `version`.
    pub version: u32,
    describe: fn() -> Schema,
}

impl Kind {
    /// Every kind, those first that are written beside a plan.
    pub const ALL: [Self; 31] = [
        Self::of::<Plan>(),
        Self::of::<Run>(),
        Self::of::<Verification>(),
        Self::of::<PolishedPlan>(),
        Self::of::<NextDocument>(),
        Self::of::<FollowState>(),
        Self::of::<FollowEvent>(),
        Self::of::<Explanation>(),
        Self::of::<Review>(),
        Self::of::<FiguresDocument>(),
        Self::of::<PicturesDocument>(),
        Self::of::<ExportDocument>(),
        Self::of::<Certified>(),
        Self::of::<ComparisonDocument>(),
        Self::of::<ScoreDocument>(),
        Self::of::<DiffDocument>(),
        Self::of::<CalibrationDocument>(),
        Self::of::<NoiseDocument>(),
        Self::of::<SweepDocument>(),
        Self::of::<ReachDocument>(),
        Self::of::<CheckDocument>(),
        Self::of::<BoardDocument>(),
        Self::of::<InitDocument>(),
        Self::of::<StudyDocument>(),
        Self::of::<CellDocument>(),
        Self::of::<CellsDocument>(),
        Self::of::<StudyCheckDocument>(),
        Self::of::<DesignDocument>(),
        Self::of::<DesignCheckDocument>(),
        Self::of::<JobDocument>(),
        Self::of::<ErrorDocument>(),
    ];

    const fn of<D: Document>() -> Self {
        Self { format: D::FORMAT, version: D::VERSION, describe: described::<D> }
    }

    /// Its name: the format's, without the program's.
    pub fn name(self) -> &'static str {
        self.format.trim_start_matches("calipose.")
    }

    /// The kind of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Its JSON Schema, draft 2020-12. It allows keys that it does not know: a document may get new ones without a new version.
    pub fn schema(self) -> Value {
        let mut schema = (self.describe)().to_value();
        schema["properties"]["format"]["const"] = self.format.into();
        schema["properties"]["version"]["const"] = self.version.into();
        schema
    }
}

/// The schema of what is written, not of what could be read: keys that are always there are required.
fn described<D: Document>() -> Schema {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    settings.with_transform(RecursiveTransform(join_lines)).into_generator().into_root_schema_for::<D>()
}

/// Descriptions lose their source's line breaks.
fn join_lines(schema: &mut Schema) {
    if let Some(Value::String(description)) = schema.get_mut("description") {
        *description = description.replace('\n', " ");
    }
}
