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
    BestOfAsMany, BoardWarp, CalibratedView, CalibrationDocument, Certified, CombinationTerm, ComparedPlan,
    ComparisonDocument, ComparisonEquivalent, ComparisonRow, CornerResidual, CurvePoint, DiffDocument,
    EstimatedIntrinsics, Explanation, ExportDocument, ExportedFile, FailedTrial, FigureFile, FiguresDocument,
    LeastKnown, LonePose, MapErrorCheck, MapErrorOverImage, MeasuredNoise, MeasuredRow, MovedPose, NextDocument,
    NoiseDocument, NotChecked, OutlierDocument, ParameterCheck, PictureFile, PictureSize, PicturesDocument,
    PoseExplanation, RequestedAccuracy, ResidualLengths, RobustnessPrice, ScoreDocument, ScoredPose, ScoredSet,
    ScoredSwap, SigmaChange, SimulatedMapError, SparePose, Suffering, Verification, lists_poses,
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
    AccuracyDocument, BallPrice, CertificateDocument, CertificateTerm, Certificates, CollisionDocument,
    ContinuumDocument, FewestDocument, GaveWayDocument, GridPlan, Intrinsics, MoveDocument, PROVEN, PicturePrice, Plan,
    PlanReadError, PlannedPose, PlannedPoses, PolishedPlan, Pose, Price, RobustnessDocument, Run, RunProblem,
    RunSeconds, ScenarioDocument, SearchDocument, SeenView, SurveyCounts, TourDocument, TradeDocument, TrialDocument,
    UnweightedAccuracy, WorstLoss, joints_deg,
};
pub use problem::{
    BoardDescription, BoardDocument, CameraSights, CheckDocument, ClosePair, DiagnosisDocument, InitDocument,
    LensDocument, NoteDocument, ObstacleDocument, PageDocument, PatternDocument, PrintedFile, PublishedCounts,
    ReachDocument, ReachedConfiguration, SelfCollision, Sight, Suspicion, SweepCounts, SweepDocument, TestedPair,
    TilesDocument,
};
pub use refusal::{ErrorDocument, FaultDocument, FaultInFile};
pub use review::{
    BoundPoint, MarginCurve, NearestLinks, OtherChoice, Picture, PictureTime, Review, ReviewedPose, Scene, SceneBoard,
    SceneCamera, SceneJoint, SceneLink, SceneMotion, SceneShape, SceneSolid, Silhouette, SurveyedViews, TimedLeg,
    TimedMove, Timeline,
};
pub(crate) use review::{Space, image_share};
pub use study::{
    AxisMeans, CellDocument, CellOutcome, CellRow, CellSeconds, CellsDocument, ComparedLevels, Difference, JobDocument,
    Mean, OutcomeSummary, ReasonCount, SimulatedOutcome, StudyAxis, StudyCheckDocument, StudyDocument,
};
pub use views::views_csv;
#[cfg(feature = "parquet")]
pub use views::views_parquet;
