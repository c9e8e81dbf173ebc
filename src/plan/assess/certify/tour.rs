//! The times of a plan's moves, reckoned once more.

use super::compare::{alike, near, number, numbers, other, same};
use super::error::CertifyError;
use super::unchecked::{ORDERED, UNORDERED, Unchecked};
use crate::motion::JointLimits;
use crate::plan::document::{PlannedPose, TourDocument};
use crate::problem::{MotionSettings, Problem};

/// Times agree to this share.
const SAME_TIME: f64 = 1e-9;

/// Checks the order of the poses and the times of the moves. That no order takes less than stated is not checked.
pub(crate) fn takes_that_time(
    stated: Option<&TourDocument>,
    problem: &Problem,
    poses: &[PlannedPose],
    unchecked: &mut Vec<Unchecked>,
) -> Result<(), CertifyError> {
    let Some(stated) = stated else {
        unchecked.extend(Unchecked::all(&["tour"], UNORDERED));
        return Ok(());
    };
    let TourDocument {
        order,
        home_rad,
        returns,
        moves_s,
        moving_s,
        least_moving_s,
        moving_by_id_s,
        dwell_s,
        total_s,
        assumed_speeds,
    } = stated;
    let MotionSettings { greatest, share, assumed, home, dwell } = &problem.motion;
    alike("the home of the tour", home_rad, &home.as_ref().map(|home| home.q.clone()))?;
    let does_return = home.as_ref().is_some_and(|home| home.returns);
    same("whether the tour ends at home", returns, &does_return)?;
    same("the time for pictures at a pose", dwell_s, dwell)?;
    let names: Vec<String> = assumed.iter().map(|&j| problem.robot.chain.joints[j].name.clone()).collect();
    alike("the list of joints whose speed is assumed", assumed_speeds, &names)?;

    let by_id: Vec<&[f64]> = poses.iter().map(|pose| pose.joints_rad.as_slice()).collect();
    let mut places = Vec::with_capacity(order.len());
    for id in order {
        let place = poses.iter().position(|pose| pose.id == *id).filter(|place| !places.contains(place));
        places.push(place.ok_or_else(|| other("a pose of the tour", id, "one of the plan that was not there before"))?);
    }
    same("the number of poses of the tour", &order.len(), &poses.len())?;
    let home = home.as_ref().map(|home| home.q.as_slice());
    let times = |order: &[&[f64]]| {
        let way: Vec<&[f64]> =
            home.into_iter().chain(order.iter().copied()).chain(home.filter(|_| does_return)).collect();
        way.windows(2).map(|pair| least_time(pair[0], pair[1], greatest, *share)).collect::<Vec<f64>>()
    };
    let found = times(&places.iter().map(|&place| by_id[place]).collect::<Vec<_>>());
    let close = |what: &str, stated, found| number(what, stated, found, SAME_TIME);
    numbers("time of a move", moves_s, &found, close)?;
    let moving: f64 = found.iter().sum();
    close("the time of all moves", *moving_s, moving)?;
    close("the time of all moves by ascending id", *moving_by_id_s, times(&by_id).iter().sum())?;
    close("the time of all moves and pictures", *total_s, moving + dwell * poses.len() as f64)?;
    if !(0.0..=moving * (1.0 + SAME_TIME)).contains(least_moving_s) {
        near("what the moves of no order take less than", *least_moving_s, moving, 0.0)?;
    }
    unchecked.extend(Unchecked::all(&["tour.least_moving_s"], ORDERED));
    Ok(())
}

/// Time of a straight move from rest to rest: the joints together accelerate as the most sluggish of them allows, up to the speed of the
/// slowest.
fn least_time(from: &[f64], to: &[f64], greatest: &[JointLimits], share: f64) -> f64 {
    let slowest = |limit: fn(&JointLimits) -> f64| {
        let shares =
            from.iter().zip(to).zip(greatest).map(|((from, to), limits)| (to - from).abs() / (share * limit(limits)));
        shares.fold(0.0, f64::max)
    };
    let (by_speed, by_acceleration) = (slowest(|limits| limits.speed), slowest(|limits| limits.acceleration));
    if by_speed * by_speed > by_acceleration {
        by_speed + by_acceleration / by_speed
    } else {
        2.0 * by_acceleration.sqrt()
    }
}
