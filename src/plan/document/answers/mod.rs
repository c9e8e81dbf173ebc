//! What is answered about a plan, its methods and the calibrations it leads to.

mod calibration;
mod certified;
mod comparison;
mod diff;
mod explanation;
mod exported;
mod figures;
mod listing;
mod next;
mod noise;
mod pictures;
mod score;
mod verification;

pub use calibration::{
    BoardWarp, CalibratedView, CalibrationDocument, CornerResidual, EstimatedIntrinsics, MapErrorOverImage,
    OutlierDocument, PictureSize, RequestedAccuracy, ResidualLengths,
};
pub use certified::{Certified, NotChecked};
pub use comparison::{ComparisonDocument, ComparisonEquivalent, ComparisonRow, MeasuredRow};
pub use diff::{ComparedPlan, DiffDocument, LonePose, MovedPose, SigmaChange};
pub use explanation::{
    CombinationTerm, CurvePoint, Explanation, LeastKnown, PoseExplanation, RobustnessPrice, SparePose, Suffering,
};
pub use exported::{ExportDocument, ExportedFile};
pub use figures::{FigureFile, FiguresDocument};
pub use listing::lists_poses;
pub use next::{NextDocument, SimulatedMapError};
pub use noise::{MeasuredNoise, NoiseDocument};
pub use pictures::{PictureFile, PicturesDocument};
pub use score::{BestOfAsMany, ScoreDocument, ScoredPose, ScoredSet, ScoredSwap};
pub use verification::{FailedTrial, MapErrorCheck, ParameterCheck, Verification};
