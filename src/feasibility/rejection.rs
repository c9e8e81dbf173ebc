//! Why a candidate is not a view.

/// Why a candidate is not a view; the checks run in this order and the first that fails is the reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Rejection {
    /// A joint is too near to one of its limits.
    JointLimit,
    /// The camera is on the unprinted side of the board, or in its plane.
    BackSide,
    /// The board is nearer or farther than allowed.
    Distance,
    /// The board is seen at too flat an angle.
    Incidence,
    /// The board is tilted too far against the optical axis.
    Tilt,
    /// A corner is behind the camera or where the lens model is not one-to-one.
    BeyondLens,
    /// A corner is outside the image or in its margin.
    OutsideImage,
    /// Neighbouring corners are too close together in the image, or its markers too small.
    CornerSpacing,
    /// The centre of mass is not over the support polygon, or too near its edge.
    Unstable,
    /// Two of the robot's links, or one and the board, are too close to each other.
    SelfCollision,
    /// A link is too close to an obstacle.
    SceneCollision,
    /// A link or an obstacle hides a corner, or so many that too few are left.
    Occluded,
    /// It is a view in the set-up as stated, but in too few of those that may be.
    Uncertain,
}

impl Rejection {
    /// Every reason, in the order of the checks.
    pub const ALL: [Rejection; 13] = [
        Rejection::JointLimit,
        Rejection::BackSide,
        Rejection::Distance,
        Rejection::Incidence,
        Rejection::Tilt,
        Rejection::BeyondLens,
        Rejection::OutsideImage,
        Rejection::CornerSpacing,
        Rejection::Unstable,
        Rejection::SelfCollision,
        Rejection::SceneCollision,
        Rejection::Occluded,
        Rejection::Uncertain,
    ];

    /// Name as written in plans.
    pub fn name(self) -> &'static str {
        match self {
            Rejection::JointLimit => "joint_limit",
            Rejection::BackSide => "back_side",
            Rejection::Distance => "distance",
            Rejection::Incidence => "incidence",
            Rejection::Tilt => "tilt",
            Rejection::BeyondLens => "beyond_lens",
            Rejection::OutsideImage => "outside_image",
            Rejection::CornerSpacing => "corner_spacing",
            Rejection::Unstable => "unstable",
            Rejection::SelfCollision => "self_collision",
            Rejection::SceneCollision => "scene_collision",
            Rejection::Occluded => "occluded",
            Rejection::Uncertain => "uncertain",
        }
    }
}
