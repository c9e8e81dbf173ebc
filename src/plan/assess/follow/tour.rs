//! The tour as it goes on.

use crate::calibration::CalibrationError;
use crate::plan::choose::PlanError;
use crate::plan::document::{
    AddedPose, Document, FollowState, MoveDocument, Outcome, Plan, ProblemReference, TakenPicture, Visit, WhyEnded,
};
use crate::problem::Problem;

use super::announcement::{Announcement, End, Input, Refusal, Standing, Stop};
use super::answer::Answer;
use super::doubt::Doubt;
use super::further::further;
use super::knowledge::Known;
use super::mismatch::{Mismatch, fits};
use super::picture::{names, observations, pictures};
use super::until::Until;
use super::ways::{Leg, Ways, legs, reversed};

/// A plan that is carried out.
pub struct Follow<'a> {
    problem: &'a Problem,
    plan: &'a Plan,
    until: Until,
    /// Whether pictures are watched for.
    watches: bool,
    /// Most poses to add.
    more: usize,
    legs: Vec<Leg>,
    /// How many of them are the plan's.
    planned: usize,
    state: FollowState,
    /// What the pictures tell; none without pictures.
    known: Option<Result<Known, CalibrationError>>,
    /// Pictures of this pose that are in doubt, and whether they can count.
    doubtful: Vec<(TakenPicture, bool)>,
    /// The stop as it was announced; what comes after a picture of it is told to an arm that stands there.
    stop: Option<Stop>,
    has_arrived: bool,
}

impl<'a> Follow<'a> {
    /// Carries out `plan`, whose file has the hash `plan_sha256`, from its beginning, or from what `state` says. With `watches`, pictures are
    /// waited for, and at most `more` poses are added until the accuracies are reached.
    ///
    /// # Errors
    /// When the state is not one of this plan.
    pub fn new(
        problem: &'a Problem,
        plan: &'a Plan,
        plan_sha256: &str,
        until: Until,
        watches: bool,
        more: usize,
        state: Option<FollowState>,
    ) -> Result<Self, Mismatch> {
        let mut legs = legs(plan);
        let state = if let Some(state) = state {
            fits(&state, problem, plan_sha256, &legs)?;
            state
        } else {
            let visit = |leg: &Leg| Visit { id: leg.pose.id, outcome: Outcome::Open, pictures: vec![], added: None };
            FollowState {
                header: FollowState::header(),
                problem: ProblemReference::new(problem),
                plan_sha256: plan_sha256.into(),
                visits: legs.iter().map(visit).collect(),
                place: 0,
                seconds: 0.0,
            }
        };
        let planned = legs.len();
        let added = state.visits.iter().filter_map(|visit| visit.added.clone());
        legs.extend(added.map(|AddedPose { pose, way }| Leg { pose, way: Some(way) }));
        Ok(Self {
            problem,
            plan,
            until,
            watches,
            more,
            legs,
            planned,
            state,
            known: None,
            doubtful: Vec::new(),
            stop: None,
            has_arrived: false,
        })
    }

    /// How far it has come.
    pub fn state(&self) -> &FollowState {
        &self.state
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        self.plan
    }

    /// The problem that the plan answers.
    pub fn problem(&self) -> &Problem {
        self.problem
    }

    /// The accuracy at which it ends.
    pub fn until(&self) -> &Until {
        &self.until
    }

    /// Whether pictures are waited for.
    pub fn watches(&self) -> bool {
        self.watches
    }

    /// What the pictures so far tell, where they give a camera.
    pub fn known(&self) -> Option<&Known> {
        self.known.as_ref().and_then(|known| known.as_ref().ok())
    }

    /// Names of all pictures, in the order of the views of [`known`](Self::known), none twice.
    pub fn names(&self) -> Vec<String> {
        names(pictures(&self.state.visits).map(|(_, picture)| picture))
    }

    /// How many poses have that outcome.
    pub fn count(&self, outcome: Outcome) -> usize {
        self.state.visits.iter().filter(|visit| visit.outcome == outcome).count()
    }

    /// Time by the plan of the moves to the poses that are left and of their pictures, s.
    pub fn seconds_left(&self) -> f64 {
        let dwell = self.problem.motion.dwell;
        let left = self.legs.iter().skip(self.state.place);
        left.map(|leg| dwell + leg.way.as_ref().map_or(0.0, |way| way.seconds)).sum()
    }

    /// Counts time that passed.
    pub fn pass(&mut self, seconds: f64) {
        self.state.seconds += seconds;
    }

    /// Begins, or goes on where the state says.
    pub fn begin(&mut self) -> Vec<Announcement> {
        let mut told = self.learn();
        self.go_on(&mut told, None);
        told
    }

    /// Takes what comes in. After the end nothing changes any more, but for further poses.
    pub fn take(&mut self, input: Input) -> Vec<Announcement> {
        match input {
            Input::Closed => vec![self.end(WhyEnded::Closed)],
            Input::Answer(Answer::Quit) => vec![self.end(WhyEnded::Quit)],
            Input::Further(added) => self.add(added),
            _ if self.is_through() => Vec::new(),
            Input::Answer(Answer::Done) => self.done(),
            Input::Answer(Answer::Skip) => self.skip(),
            Input::Answer(Answer::Back) => self.back(),
            Input::Answer(Answer::Again) => self.again(),
            Input::Pictures(pictures) => self.look_at(pictures),
        }
    }

    /// Poses to go on with, at most `most`; none where no more are needed. `observe` is told the number of configurations swept.
    ///
    /// # Errors
    /// When there are no views to choose from, or what is known does not suffice to choose.
    pub fn further(&self, most: usize, observe: &(dyn Fn(usize) + Sync)) -> Result<Vec<AddedPose>, PlanError> {
        let (Some(known), Some(last)) = (self.known(), self.legs.last()) else { return Ok(Vec::new()) };
        further(self.problem, known, &self.until, most, &last.pose.joints_rad, observe)
    }

    /// Whether all poses are done.
    fn is_through(&self) -> bool {
        self.state.place == self.legs.len()
    }

    fn visit(&mut self) -> &mut Visit {
        &mut self.state.visits[self.state.place]
    }

    /// The pose is taken, as far as it can be.
    fn done(&mut self) -> Vec<Announcement> {
        if !self.watches {
            self.visit().outcome = Outcome::Taken;
            return self.leave(Vec::new());
        }
        let is_in_doubt = !self.doubtful.is_empty();
        let kept: Vec<TakenPicture> =
            self.doubtful.drain(..).filter(|(_, can_count)| *can_count).map(|(picture, _)| picture).collect();
        let mut told = Vec::new();
        if !kept.is_empty() {
            self.visit().pictures.extend(kept.iter().cloned());
            told.extend(kept.into_iter().map(Announcement::Taken));
            told.extend(self.learn());
        }
        if self.visit().pictures.is_empty() {
            let refusal = if is_in_doubt { Refusal::Unusable } else { Refusal::NoPicture };
            return vec![Announcement::Refused(refusal)];
        }
        self.visit().outcome = Outcome::Taken;
        self.leave(told)
    }

    fn skip(&mut self) -> Vec<Announcement> {
        self.visit().outcome = Outcome::Skipped;
        let told = self.without_pictures();
        self.leave(told)
    }

    fn back(&mut self) -> Vec<Announcement> {
        let Some(before) = self.state.place.checked_sub(1) else {
            return vec![Announcement::Refused(Refusal::First)];
        };
        self.doubtful.clear();
        let way = self.way_to(self.state.place).as_ref().map(reversed);
        let from = Standing::Pose(self.state.place);
        self.state.place = before;
        vec![self.announce(from, way)]
    }

    fn again(&mut self) -> Vec<Announcement> {
        self.visit().outcome = Outcome::Open;
        let mut told = self.without_pictures();
        let (from, way) = match self.stop.take() {
            Some(stop) if !self.has_arrived => (stop.from, stop.way),
            _ => (Standing::Here, None),
        };
        let has_arrived = self.has_arrived;
        told.push(self.announce(from, way));
        self.has_arrived = has_arrived;
        told
    }

    /// Leaves out the pictures of this pose; what the others tell.
    fn without_pictures(&mut self) -> Vec<Announcement> {
        self.doubtful.clear();
        self.visit().pictures.clear();
        self.learn()
    }

    /// Looks at pictures of this pose, and counts those that are not in doubt.
    fn look_at(&mut self, new: Vec<TakenPicture>) -> Vec<Announcement> {
        if new.is_empty() {
            return Vec::new();
        }
        self.has_arrived = true;
        self.doubtful.clear();
        if self.visit().outcome != Outcome::Open {
            // These take the place of what it had before.
            self.visit().outcome = Outcome::Open;
            self.visit().pictures.clear();
        }
        let mut told = Vec::new();
        let mut counted = false;
        for picture in new {
            let doubts = self.doubts(&picture);
            if doubts.is_empty() {
                self.visit().pictures.push(picture.clone());
                told.push(Announcement::Taken(picture));
                counted = true;
            } else {
                self.doubtful.push((picture.clone(), !doubts.iter().any(Doubt::is_fatal)));
                told.push(Announcement::InDoubt(picture, doubts));
            }
        }
        if counted {
            told.extend(self.learn());
        }
        if self.visit().pictures.len() >= self.plan.pictures || counted && self.reaches() {
            self.visit().outcome = Outcome::Taken;
            return self.leave(told);
        }
        told
    }

    /// What is wrong with a picture of this pose.
    fn doubts(&self, picture: &TakenPicture) -> Vec<Doubt> {
        let place = self.state.place;
        let others = pictures(&self.state.visits).filter(|(other, _)| *other != place);
        let others = others.map(|(other, taken)| (&self.legs[other].pose, taken));
        let at_sight = Doubt::at_sight(self.problem, picture, &self.legs[place].pose, others);
        if at_sight.iter().any(Doubt::is_fatal) {
            return at_sight;
        }
        let views = pictures(&self.state.visits).map(|(_, taken)| taken.view()).chain([picture.view()]).collect();
        // Each was found usable.
        let among = observations(self.problem, views).map(|views| Doubt::among(self.problem, &views));
        at_sight.into_iter().chain(among.unwrap_or_default()).collect()
    }

    /// Calibrates anew; what that tells.
    fn learn(&mut self) -> Vec<Announcement> {
        let views: Vec<_> = pictures(&self.state.visits).map(|(_, picture)| picture.view()).collect();
        let left: Vec<Leg> = self
            .legs
            .iter()
            .zip(&self.state.visits)
            .filter(|(_, visit)| visit.outcome == Outcome::Open && visit.pictures.is_empty())
            .map(|(leg, _)| leg.clone())
            .collect();
        let observed = (!views.is_empty()).then(|| observations(self.problem, views).ok()).flatten();
        self.known = observed.map(|observed| Known::new(self.problem, observed, &self.until, &left));
        match &self.known {
            None => Vec::new(),
            Some(Ok(_)) => vec![Announcement::Known],
            Some(Err(error)) => vec![Announcement::Unknown(error.clone())],
        }
    }

    fn reaches(&self) -> bool {
        self.watches && self.known().is_some_and(Known::reaches)
    }

    /// From the pose that is done to the next.
    fn leave(&mut self, mut told: Vec<Announcement>) -> Vec<Announcement> {
        self.doubtful.clear();
        let left = self.state.place;
        self.state.place += 1;
        self.go_on(&mut told, Some(left));
        told
    }

    /// To the pose of this place, if the tour does not end; `left` is where the arm stands, where that is known.
    fn go_on(&mut self, told: &mut Vec<Announcement>, left: Option<usize>) {
        let may_add = (self.planned + self.more).saturating_sub(self.legs.len());
        let announcement = if self.reaches() {
            self.end(WhyEnded::Accuracy)
        } else if !self.is_through() {
            let before = left.or_else(|| self.state.place.checked_sub(1));
            let way = self.way_to(self.state.place);
            let from = match before {
                Some(place) => Standing::Pose(place),
                None if way.is_some() => Standing::Home,
                None => Standing::Anywhere,
            };
            self.announce(from, way)
        } else if self.watches && may_add > 0 && self.known().is_some() {
            Announcement::More(may_add)
        } else {
            self.end(WhyEnded::Poses)
        };
        told.push(announcement);
    }

    /// Adds poses and goes to the first; ends where there are none.
    fn add(&mut self, added: Vec<AddedPose>) -> Vec<Announcement> {
        if added.is_empty() || !self.is_through() {
            return vec![self.end(WhyEnded::Poses)];
        }
        let mut told = vec![Announcement::Added(added.len())];
        for added in added {
            let AddedPose { pose, way } = added.clone();
            let visit = Visit { id: pose.id, outcome: Outcome::Open, pictures: vec![], added: Some(added) };
            self.state.visits.push(visit);
            self.legs.push(Leg { pose, way: Some(way) });
        }
        told.extend(self.learn());
        self.go_on(&mut told, None);
        told
    }

    fn announce(&mut self, from: Standing, way: Option<MoveDocument>) -> Announcement {
        self.has_arrived = false;
        let place = self.state.place;
        let stop = Stop { place, pose: self.legs[place].pose.clone(), from, way };
        self.stop = Some(stop.clone());
        Announcement::Go(Box::new(stop))
    }

    /// The move to the pose of that place from the one before. Plans without a tour do not have it: it is found now.
    fn way_to(&mut self, place: usize) -> Option<MoveDocument> {
        if self.legs[place].way.is_none()
            && let Some(before) = place.checked_sub(1)
        {
            let [from, to] = [before, place].map(|place| &self.legs[place].pose.joints_rad);
            self.legs[place].way = Ways::new(self.problem).between(from, to);
        }
        self.legs[place].way.clone()
    }

    fn end(&self, why: WhyEnded) -> Announcement {
        let good = match why {
            WhyEnded::Accuracy => true,
            WhyEnded::Poses => !self.watches || self.known().is_some_and(|known| known.will_do(&self.until)),
            WhyEnded::Quit | WhyEnded::Closed => false,
        };
        let way = if good { self.way_home() } else { None };
        Announcement::End(End { why, good, way })
    }

    /// The way home from the last pose that was gone to, where the tour returns.
    fn way_home(&self) -> Option<MoveDocument> {
        let home = self.problem.motion.home.as_ref().filter(|home| home.returns)?;
        let last = self.state.place.checked_sub(1)?;
        let planned = self.plan.tour.as_ref().filter(|_| last + 1 == self.planned);
        let planned = planned.and_then(|tour| tour.moves.last()).cloned();
        planned.or_else(|| Ways::new(self.problem).between(&self.legs[last].pose.joints_rad, &home.q))
    }
}
