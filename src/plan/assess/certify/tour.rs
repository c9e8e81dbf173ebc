//! The times of a plan's moves, reckoned once more.

use rayon::prelude::*;

use super::SAME;
use super::compare::{alike, different, near, number, numbers, other, same};
use super::error::CertifyError;
use super::evidence::Evidence;
use super::unchecked::{LED, ORDERED, TIED, TRADED, Unchecked};
use crate::feasibility::Collision;
use crate::motion::journey::Arm;
use crate::motion::{JointLimits, Safety};
use crate::plan::document::{MoveDocument, PlannedPose, TourDocument, TradeDocument};
use crate::plan::survey::Survey;
use crate::problem::{Goal, Least, MotionSettings, Problem};

/// Times agree to this share; those of moves, which are stated to a nanosecond, to as many seconds too.
const SAME_TIME: f64 = 1e-9;

/// Margins agree to this, m.
const SAME_MARGIN: f64 = 1e-9;

/// Checks the order of the poses, the times of the moves and the margins on them; the time of straight moves in that order. That no
/// order takes less than stated is not checked.
pub(crate) fn takes_that_time(
    stated: Option<&TourDocument>,
    problem: &Problem,
    poses: &[PlannedPose],
    unchecked: &mut Vec<Unchecked>,
) -> Result<f64, CertifyError> {
    let Some(stated) = stated else { return Err(other("the tour", "left out", "through all poses")) };
    let TourDocument {
        order,
        home_rad,
        returns,
        moves,
        moving_s,
        least_moving_s,
        moving_by_id_s,
        dwell_s,
        total_s,
        trade: _,    // by `traded`
        gave_way: _, // by `traded`
        assumed_speeds,
    } = stated;
    let MotionSettings { greatest, share, assumed, home, dwell } = &problem.motion;
    alike("the home of the tour", home_rad, &home.as_ref().map(|home| home.q.clone()))?;
    let does_return = home.as_ref().is_some_and(|home| home.returns);
    same("whether the tour ends at home", returns, &does_return)?;
    same("the time for pictures at a pose", dwell_s, dwell)?;
    let names: Vec<String> = assumed.iter().map(|&j| problem.robot.chain.joints[j].name.clone()).collect();
    alike("the list of joints whose speed is assumed", assumed_speeds, &names)?;

    let mut places = Vec::with_capacity(order.len());
    for id in order {
        let place = poses.iter().position(|pose| pose.id == *id).filter(|place| !places.contains(place));
        places.push(place.ok_or_else(|| other("a pose of the tour", id, "one of the plan that was not there before"))?);
    }
    same("the number of poses of the tour", &order.len(), &poses.len())?;
    // Home comes after the poses.
    let stops: Vec<&[f64]> =
        poses.iter().map(|pose| &pose.joints_rad).chain(home.iter().map(|home| &home.q)).map(Vec::as_slice).collect();
    let at_home = || home.iter().map(|_| poses.len());
    let way = |order: &[usize]| -> Vec<[usize; 2]> {
        let back = at_home().filter(|_| does_return);
        let way: Vec<usize> = at_home().chain(order.iter().copied()).chain(back).collect();
        way.windows(2).map(|pair| [pair[0], pair[1]]).collect()
    };
    let least = |from: &[f64], to: &[f64]| least_time(from, to, greatest, *share);
    let legs = way(&places);
    same("the number of moves", &moves.len(), &legs.len())?;
    let collision = Collision::new(&problem.robot, problem.clearance);
    let safety = Safety::new(&problem.robot, &collision, problem.stability.as_ref());
    let arm = Arm::new(&problem.robot, problem.motion.limits(), safety);
    let mut moving = 0.0;
    for (stated, [i, j]) in moves.iter().zip(legs) {
        moving += goes_that_way(stated, problem, &arm, [i, j], &stops, &least)?;
    }
    let by_id: Vec<usize> = (0..poses.len()).collect();
    let close = |what: &str, stated, found| number(what, stated, found, SAME_TIME);
    close("the time of all moves", *moving_s, moving)?;
    let straight =
        |order: &[usize]| -> Vec<f64> { way(order).into_iter().map(|[i, j]| least(stops[i], stops[j])).collect() };
    close("the time of all moves by ascending id", *moving_by_id_s, straight(&by_id).iter().sum())?;
    let own = straight(&places);
    let is_tied = (1..places.len()).any(|place| {
        let mut other = places.clone();
        other.swap(place - 1, place);
        straight(&other).iter().zip(&own).all(|(other, own)| (other - own).abs() <= SAME_TIME * (1.0 + own))
    });
    if is_tied {
        unchecked.extend(Unchecked::all(&["tour.order"], TIED));
    }
    close("the time of all moves and pictures", *total_s, moving + dwell * poses.len() as f64)?;
    if !(0.0..=moving * (1.0 + SAME_TIME)).contains(least_moving_s) {
        return Err(different("what the moves of no order take less than", *least_moving_s, moving));
    }
    unchecked.extend(Unchecked::all(&["tour.least_moving_s"], ORDERED));
    Ok(own.iter().sum())
}

impl Evidence<'_> {
    /// Checks what the poses are said to have been chosen for beside their information; straight moves through them take `moving`. Gives
    /// the number of poses that the certificate is for.
    pub(super) fn traded(
        &self,
        stated: &TourDocument,
        survey: &Survey,
        moving: f64,
        unchecked: &mut Vec<Unchecked>,
    ) -> Result<usize, CertifyError> {
        let TourDocument { trade, gave_way, order, dwell_s, total_s, .. } = stated;
        let (goal, tour_tolerance) = (&self.problem.selection.goal, self.problem.selection.tour_tolerance);
        let by_time = matches!(goal, Goal::Fewest { least: Least::Time, .. });
        let seconds = if let Goal::Within { seconds, .. } = goal { Some(*seconds) } else { None };
        let counts = by_time || seconds.is_some() || tour_tolerance > 0.0;
        same("whether the tour counted in the choice", &trade.is_some(), &counts)?;
        if !gave_way.is_empty() {
            if let Some(gone) =
                gave_way.iter().find(|gone| survey.index_of(gone.id).is_none() || order.contains(&gone.id))
            {
                return Err(other("a view that gave way", &gone.id, "a view that is no pose of the plan"));
            }
            unchecked.extend(Unchecked::all(&["tour.gave_way"], LED));
        }
        let Some(TradeDocument { kept, best_total_s, least_total_s, most_poses }) = trade else {
            return Ok(order.len());
        };
        same("whether the best set is left out with its time", &kept.is_some(), &best_total_s.is_some())?;
        same("whether the best set is compared with spares", &(kept.is_some() && !gave_way.is_empty()), &false)?;
        same(
            "whether a bound on the time is stated",
            &least_total_s.is_some(),
            &(seconds.is_none() && gave_way.is_empty()),
        )?;
        same("whether the most poses are stated", &most_poses.is_some(), &seconds.is_some())?;
        let total = moving + dwell_s * order.len() as f64;
        if let (Some(kept), false) = (kept, by_time)
            && *kept < 1.0 - tour_tolerance - SAME
        {
            return Err(different("the share of the best set's information", *kept, 1.0 - tour_tolerance));
        }
        if let Some(best_total) = best_total_s
            && *best_total < total * (1.0 - SAME_TIME)
        {
            return Err(different("the time of the best set's tour", *best_total, total));
        }
        if let Some(least) = least_total_s
            && !(0.0..=total * (1.0 + SAME_TIME)).contains(least)
        {
            return Err(different("what no tour of as good a set takes less than", *least, total));
        }
        let fields = [("kept", kept.is_some()), ("best_total_s", best_total_s.is_some())];
        for (field, _) in fields.into_iter().chain([("least_total_s", least_total_s.is_some())]).filter(|field| field.1)
        {
            unchecked.extend(Unchecked::all(&[&format!("tour.trade.{field}")], TRADED));
        }
        let (Some(seconds), Some(most)) = (seconds, most_poses) else { return Ok(order.len()) };
        if *total_s > seconds * (1.0 + SAME_TIME) {
            return Err(different("the time of the tour, which is to be kept,", *total_s, seconds));
        }
        let more = self.least_total(survey, most + 1);
        if *most < order.len() || *most < survey.views.len() && more <= seconds {
            return Err(other("the most poses whose tour may keep the time", most, &(most + 1)));
        }
        Ok(*most)
    }

    /// Time that no tour of so many poses takes less than: they are apart by the least move between two views that may be taken together,
    /// where the views are not too many to look at all pairs.
    fn least_total(&self, survey: &Survey, poses: usize) -> f64 {
        let MotionSettings { greatest, share, home, dwell, assumed: _ } = &self.problem.motion;
        let time = |from: &[f64], to: &[f64]| least_time(from, to, greatest, *share);
        let q: Vec<&[f64]> = survey.views.iter().map(|view| view.q.as_slice()).collect();
        let open = self.rules.open();
        let nearest = |place: usize| {
            let others = open[place + 1..].iter().filter(|&&j| !self.rules.are_too_close(open[place], j));
            others.map(|&j| time(q[open[place]], q[j])).fold(f64::INFINITY, f64::min)
        };
        let apart = if open.len() > Self::MOST_PAIRED {
            0.0
        } else {
            (0..open.len()).into_par_iter().map(nearest).reduce(|| f64::INFINITY, f64::min)
        };
        let to_home = home.as_ref().map_or(0.0, |home| {
            let least = open.iter().map(|&i| time(&home.q, q[i])).fold(f64::INFINITY, f64::min);
            if home.returns { 2.0 * least } else { least }
        });
        let apart = if apart.is_finite() { apart } else { 0.0 };
        to_home + apart * poses.saturating_sub(1) as f64 + dwell * poses as f64
    }

    /// Most views of which all pairs are looked at.
    const MOST_PAIRED: usize = 6000;
}

/// Checks a move between two stops; its time. A move is looked at from the stop of the lower number, as it was found.
fn goes_that_way(
    stated: &MoveDocument,
    problem: &Problem,
    arm: &Arm,
    [i, j]: [usize; 2],
    stops: &[&[f64]],
    least: &dyn Fn(&[f64], &[f64]) -> f64,
) -> Result<f64, CertifyError> {
    let MoveDocument { seconds, via_rad, safe, clearance_m, tip_over_margin_m, endangered } = stated;
    let mut corners: Vec<&[f64]> = vec![stops[i]];
    corners.extend(via_rad.iter().map(Vec::as_slice));
    corners.push(stops[j]);
    if let Some(turn) = corners.iter().find(|q| !arm.reaches(q)) {
        return Err(other("a turn of a move", &format!("{turn:?}"), "joint values within the limits"));
    }
    let time: f64 = corners.windows(2).map(|pair| least(pair[0], pair[1])).sum();
    near("the time of a move", *seconds, time, SAME_TIME * (1.0 + time))?;
    if i > j {
        corners.reverse();
    }
    let found = MoveDocument::of_safety(arm.look_at(&corners).as_ref(), &problem.robot.tree);
    alike("whether a move is safe", safe, &found.safe)?;
    alike("what a move endangers", endangered, &found.endangered)?;
    let lists = [[clearance_m, &found.clearance_m], [tip_over_margin_m, &found.tip_over_margin_m]];
    for [stated, found] in lists.map(|pair| pair.map(|value| value.iter().copied().collect::<Vec<f64>>())) {
        numbers("margin on a move", &stated, &found, |what, stated, found| near(what, stated, found, SAME_MARGIN))?;
    }
    Ok(time)
}

/// Time of a straight move from rest to rest: the joints together accelerate as the most sluggish of them allows, up to the speed of the
/// slowest, or up to the greatest from which they can still stop in time.
fn least_time(from: &[f64], to: &[f64], greatest: &[JointLimits], share: f64) -> f64 {
    let slowest = |limit: fn(&JointLimits) -> f64| {
        let shares =
            from.iter().zip(to).zip(greatest).map(|((from, to), limits)| (to - from).abs() / (share * limit(limits)));
        shares.fold(0.0, f64::max)
    };
    let limits: [fn(&JointLimits) -> f64; 3] = [|joint| joint.speed, |joint| joint.acceleration, |joint| joint.jerk];
    let [by_speed, by_acceleration, by_jerk] = limits.map(slowest);
    if by_acceleration == 0.0 {
        return 0.0;
    }
    // Speeds are shares of the way to the second. From this one on the greatest acceleration is reached.
    let eased = by_jerk / (by_acceleration * by_acceleration);
    let speeding_up = |speed: f64| {
        if speed > eased { speed * by_acceleration + by_jerk / by_acceleration } else { 2.0 * (speed * by_jerk).sqrt() }
    };
    let fastest = 1.0 / by_speed;
    if fastest * speeding_up(fastest) <= 1.0 {
        return by_speed + speeding_up(fastest);
    }
    // Half the way is done when the greatest speed is reached.
    let jerk_time = by_jerk / by_acceleration;
    let speed = ((jerk_time * jerk_time + 4.0 * by_acceleration).sqrt() - jerk_time) / (2.0 * by_acceleration);
    2.0 * speeding_up(if speed > eased { speed } else { (0.25 / by_jerk).cbrt() })
}
