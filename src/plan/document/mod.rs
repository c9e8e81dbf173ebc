//! The documents that leave the program, typed and versioned: one header, and a JSON Schema for each.

mod answers;
mod design;
mod error_grid;
mod follow;
mod header;
mod kind;
mod plan;
mod problem;
mod refusal;
mod review;
mod study;
mod views;

pub use answers::{
    BoardWarp, CalibratedView, CalibrationDocument, Certified, CombinationTerm, ComparisonDocument,
    ComparisonEquivalent, ComparisonRow, CornerResidual, CurvePoint, EstimatedIntrinsics, Explanation, ExportDocument,
    ExportedFile, FailedTrial, FigureFile, FiguresDocument, LeastKnown, MapErrorCheck, MapErrorOverImage,
    MeasuredNoise, MeasuredRow, NextDocument, NoiseDocument, NotChecked, OutlierDocument, ParameterCheck, PictureFile,
    PictureSize, PicturesDocument, PoseExplanation, RequestedAccuracy, ResidualLengths, RobustnessPrice,
    SimulatedMapError, SparePose, Suffering, Verification,
};
pub use design::{
    DesignCheckDocument, DesignDocument, DesignMap, DesignProof, FreeValue, Sensitivity, SensitivityPoint, SetUp,
};
pub use error_grid::ErrorGrid;
pub use follow::{
    AddedPose, AnnouncedPose, CountedPicture, EventKind, FollowEnd, FollowEvent, FollowReadError, FollowState,
    KnownSoFar, Outcome, SeenCorner, TakenPicture, Visit, WhyEnded,
};
pub(crate) use header::finite;
pub use header::{Document, Header, ProblemReference};
pub use kind::Kind;
pub(crate) use plan::poses_csv;
pub use plan::{
    AccuracyDocument, CertificateDocument, CertificateTerm, Certificates, CollisionDocument, ContinuumDocument,
    FewestDocument, GridPlan, Intrinsics, MoveDocument, PROVEN, Plan, PlanReadError, PlannedPose, PlannedPoses,
    PolishedPlan, Pose, Price, RobustnessDocument, Run, RunProblem, RunSeconds, ScenarioDocument, SearchDocument,
    SeenView, SurveyCounts, TourDocument, TrialDocument, UnweightedAccuracy, WorstLoss, joints_deg,
};
pub use problem::{
    BoardDescription, BoardDocument, CameraSights, CheckDocument, ClosePair, DiagnosisDocument, InitDocument,
    LensDocument, NoteDocument, ObstacleDocument, PageDocument, PatternDocument, PrintedFile, PublishedCounts,
    ReachDocument, ReachedConfiguration, SelfCollision, Sight, Suspicion, SweepCounts, SweepDocument, TestedPair,
    TilesDocument,
};
pub use refusal::{ErrorDocument, FaultDocument, FaultInFile};
pub use review::{
    BoundPoint, NearestLinks, OtherChoice, Picture, Review, ReviewedPose, Scene, SceneBoard, SceneCamera, SceneJoint,
    SceneLink, SceneMotion, SceneShape, SceneSolid, Silhouette, SurveyedViews,
};
pub(crate) use review::{Space, image_share};
pub use study::{
    AxisMeans, CellDocument, CellOutcome, CellRow, CellSeconds, CellsDocument, ComparedLevels, Difference, JobDocument,
    Mean, OutcomeSummary, ReasonCount, SimulatedOutcome, StudyAxis, StudyCheckDocument, StudyDocument,
};
pub use views::views_csv;
#[cfg(feature = "parquet")]
pub use views::views_parquet;
