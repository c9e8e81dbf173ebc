//! What is announced, in sentences for people and as documents for programs.

use crate::calibration::{AccuracyReached, Request};
use crate::figures::{short, trimmed};
use crate::plan::document::{
    AnnouncedPose, CountedPicture, Document, EstimatedIntrinsics, EventKind, FollowEnd, FollowEvent, KnownSoFar,
    MoveDocument, Outcome, RequestedAccuracy, TakenPicture, WhyEnded, finite,
};

use super::announcement::{Announcement, End, Standing, Stop};
use super::doubt::Doubt;
use super::knowledge::Known;
use super::tour::Follow;

impl FollowEvent {
    /// An event of which there is no more to tell than its message.
    pub fn new(event: EventKind, message: String) -> Self {
        Self { header: Self::header(), event, message, pose: None, picture: None, known: None, end: None }
    }
}

impl Announcement {
    /// The document of an announcement of `follow`; none of [`Announcement::More`], which only its caller has to know. `output` is the folder
    /// to which the calibration was written.
    pub fn document(&self, follow: &Follow, output: Option<&str>) -> Option<FollowEvent> {
        let event = |kind| FollowEvent::new(kind, self.sentence(follow));
        let picture = |picture: &TakenPicture, doubts: &[Doubt]| {
            Some(CountedPicture {
                file: picture.file.clone(),
                name: picture.name.clone(),
                corners: picture.corners.len(),
                doubts: doubts.iter().map(Doubt::to_string).collect(),
            })
        };
        Some(match self {
            Self::More(_) => return None,
            Self::Go(stop) => FollowEvent { pose: Some(announced(stop, follow)), ..event(EventKind::Pose) },
            Self::Taken(taken) => FollowEvent { picture: picture(taken, &[]), ..event(EventKind::Picture) },
            Self::InDoubt(taken, doubts) => FollowEvent { picture: picture(taken, doubts), ..event(EventKind::Doubt) },
            Self::Known => FollowEvent { known: follow.known().map(known), ..event(EventKind::Known) },
            Self::Unknown(_) => event(EventKind::Unknown),
            Self::Refused(_) => event(EventKind::Refused),
            Self::Added(_) => event(EventKind::More),
            Self::End(ended) => FollowEvent { end: Some(end(ended, follow, output)), ..event(EventKind::End) },
        })
    }

    /// The announcement in a sentence or two.
    pub fn sentence(&self, follow: &Follow) -> String {
        let number = follow.state().place + 1;
        match self {
            Self::Go(stop) => of_stop(stop, follow),
            Self::Taken(TakenPicture { name, corners, .. }) => {
                format!("Picture {name}: {} corners.", corners.len())
            }
            Self::InDoubt(TakenPicture { name, .. }, doubts) => {
                let reasons: Vec<String> = doubts.iter().map(Doubt::to_string).collect();
                let offer = if doubts.iter().any(Doubt::is_fatal) {
                    "Take another, or leave the pose out with `skip`."
                } else {
                    "Take another, or `again`; `done` (Enter) lets it count, `skip` leaves the pose out."
                };
                format!("Picture {name} of pose {number} is in doubt: {}. {offer}", reasons.join("; "))
            }
            Self::Known => follow.known().map(|known| of_known(known, follow)).unwrap_or_default(),
            Self::Unknown(error) => format!("The pictures so far do not give a camera yet: {error}."),
            Self::Refused(refusal) => {
                let text = refusal.to_string();
                let mut letters = text.chars();
                letters.next().map(|first| format!("{}{}.", first.to_uppercase(), letters.as_str())).unwrap_or_default()
            }
            Self::More(most) => format!("All poses are done, and the accuracy is not reached: up to {most} are added."),
            Self::Added(1) => "One pose is added.".into(),
            Self::Added(count) => format!("{count} poses are added."),
            Self::End(end) => of_end(end, follow),
        }
    }
}

fn announced(stop: &Stop, follow: &Follow) -> AnnouncedPose {
    let Stop { place, pose, from, way } = stop;
    let state = follow.state();
    AnnouncedPose {
        visit: place + 1,
        visits: state.visits.len(),
        from: match from {
            Standing::Anywhere => None,
            Standing::Home => Some(0),
            Standing::Pose(other) => Some(other + 1),
            Standing::Here => Some(place + 1),
        },
        turns_rad: turns(way.as_ref()),
        way: way.as_ref().map(without_turns),
        joints: follow.plan().joints.clone(),
        pictures: follow.plan().pictures,
        taken: state.visits[*place].pictures.len(),
        watches: follow.watches(),
        pose: pose.clone(),
    }
}

fn turns(way: Option<&MoveDocument>) -> Vec<Vec<f64>> {
    way.map(|way| way.via_rad.clone()).unwrap_or_default()
}

/// The turns stand before it, also where there are none.
fn without_turns(way: &MoveDocument) -> MoveDocument {
    MoveDocument { via_rad: vec![], ..way.clone() }
}

fn of_stop(stop: &Stop, follow: &Follow) -> String {
    let Stop { place, pose, from, way } = stop;
    let visit = &follow.state().visits[*place];
    let start = match from {
        Standing::Anywhere => None,
        Standing::Home => Some("home".to_owned()),
        Standing::Pose(other) => Some(format!("pose {}", other + 1)),
        Standing::Here => Some("here".into()),
    };
    let mut text = format!("Pose {} of {} (id {})", place + 1, follow.state().visits.len(), pose.id);
    text += &match (start, way) {
        (Some(start), Some(way)) => {
            format!(", {} s from {start}{}.{}", trimmed(way.seconds, 1), of_turns(way), of_safety(way))
        }
        (Some(_), None) if *from == Standing::Here => " again: the arm is there.".into(),
        _ => ". The way to it is not planned: go there with care.".to_owned(),
    };
    let pictures = follow.plan().pictures;
    match (visit.outcome, visit.pictures.len()) {
        (Outcome::Taken, _) => text += " It is taken already: `done` (Enter) leaves it so.",
        (Outcome::Skipped, _) => text += " It was left out before.",
        (Outcome::Open, 0) if pictures > 1 => text += &format!(" Take {pictures} pictures there."),
        (Outcome::Open, 0) => {}
        (Outcome::Open, taken) => text += &format!(" {taken} of its {pictures} pictures are taken."),
    }
    text
}

fn of_turns(way: &MoveDocument) -> String {
    match way.via_rad.len() {
        0 => String::new(),
        1 => " by one turn".into(),
        turns => format!(" by {turns} turns"),
    }
}

fn of_safety(way: &MoveDocument) -> String {
    let endangered = way.endangered.as_deref().unwrap_or_default();
    let mm = |margin: f64| trimmed(1e3 * margin, 1);
    match way.safe {
        None => " The way was NOT tested for collision.".into(),
        Some(false) if endangered.is_empty() => {
            " The way is NOT PROVEN SAFE: the robot may tip over on it; plan another.".into()
        }
        Some(false) => {
            format!(" The way is NOT PROVEN SAFE: on it, {} may collide; plan another.", endangered.join(" and "))
        }
        Some(true) => {
            let mut text = String::new();
            if let Some(clearance) = way.clearance_m {
                text += &format!(" On the way links keep {} mm apart or more.", mm(clearance));
            }
            if let Some(margin) = way.tip_over_margin_m {
                text += &format!(" The tip-over margin stays above {} mm.", mm(margin));
            }
            text
        }
    }
}

fn known(known: &Known) -> KnownSoFar {
    let Known { observations, calibration, assessment, expected, .. } = known;
    KnownSoFar {
        views: observations.views().len(),
        intrinsics: EstimatedIntrinsics::new(calibration),
        rms_px: calibration.rms,
        sigma_px: calibration.sigma,
        map_error_px: finite(assessment.map_errors.rms),
        expected_map_error_px: *expected,
        requested: assessment.requested.iter().map(RequestedAccuracy::new).collect(),
        reached: known.reaches(),
        judgement: assessment.judgement.name().into(),
    }
}

fn of_known(known: &Known, follow: &Follow) -> String {
    let Known { observations, calibration, assessment, expected, .. } = known;
    let views = observations.views().len();
    let mut text = format!(
        "{views} view{}: map error {} px if the tour ended now",
        if views == 1 { "" } else { "s" },
        short(assessment.map_errors.rms)
    );
    if let Some(expected) = expected {
        text += &format!(", {} px with all poses that are left", short(*expected));
    }
    let promised = if follow.until().is_promise { "promised by the plan" } else { "requested" };
    for (request, AccuracyReached { what, limit, reached }) in follow.until().requests.iter().zip(&assessment.requested)
    {
        let limit = short(*limit);
        text += &match request {
            Request::MapError(_) => format!("; {limit} px is {promised}"),
            Request::Sigma { .. } => format!("; {what} is {}, {limit} is {promised}", short(*reached)),
        };
    }
    text += &format!(". Residuals: RMS {} px.", short(calibration.rms));
    if let Some(objection) = known.objection() {
        text += &format!(" {objection}");
    }
    text
}

fn end(ended: &End, follow: &Follow, output: Option<&str>) -> FollowEnd {
    let End { why, good, way } = ended;
    let home = follow.problem().motion.home.as_ref().filter(|_| way.is_some());
    FollowEnd {
        why: *why,
        good: *good,
        taken: follow.count(Outcome::Taken),
        skipped: follow.count(Outcome::Skipped),
        left: follow.count(Outcome::Open),
        seconds: follow.state().seconds,
        planned_s: follow.plan().tour.as_ref().map(|tour| tour.total_s),
        home_rad: home.map(|home| home.q.clone()),
        turns_rad: turns(way.as_ref()),
        way: way.as_ref().map(without_turns),
        output: output.map(Into::into),
    }
}

fn of_end(end: &End, follow: &Follow) -> String {
    let [taken, skipped, left] = [Outcome::Taken, Outcome::Skipped, Outcome::Open].map(|outcome| follow.count(outcome));
    let mut text = match (end.why, end.good) {
        (WhyEnded::Accuracy, _) if left == 0 => "The accuracy is reached.".into(),
        (WhyEnded::Accuracy, _) => {
            let seconds = short(follow.seconds_left());
            format!("The accuracy is reached: {left} poses are saved, and {seconds} s of moves and pictures.")
        }
        (WhyEnded::Poses, true) => "All poses are done.".into(),
        (WhyEnded::Poses, false) => "All poses are done, and the accuracy is not reached.".into(),
        (WhyEnded::Quit, _) => "The tour is left here; the same command goes on from here.".into(),
        (WhyEnded::Closed, _) => "No more answers can come; the same command goes on from here.".to_owned(),
    };
    let other = if skipped > 0 { format!(", {skipped} left out") } else { String::new() };
    text += &format!(" {taken} of {} poses taken{other}.", follow.state().visits.len());
    if let Some(way) = &end.way {
        text += &format!(" Home is {} s away{}.{}", trimmed(way.seconds, 1), of_turns(way), of_safety(way));
    }
    text
}
