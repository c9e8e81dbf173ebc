//! What a plan, a study or a design comes to, in words: the same in the terminal and on its page.

use crate::figures::{grouped, short};
use crate::plan::document::{
    AxisMeans, ContinuumDocument, DesignDocument, GaveWayDocument, MoveDocument, Plan, StudyDocument, TourDocument,
    TradeDocument,
};

/// What was chosen, and what is proven of it.
pub fn outcome(plan: &Plan) -> String {
    let Plan { count, method, criterion, value, bound, efficiency, search, fewest, certificate, .. } = plan;
    let views = grouped(plan.survey.views);
    let anywhere = certificate.continuum.as_ref().map(|continuum| format!("\n{}", anywhere(plan, continuum)));
    let anywhere = anywhere.unwrap_or_default();
    if let Some(fewest) = fewest {
        let reached: Vec<String> = fewest
            .accuracies
            .iter()
            .map(|accuracy| format!("{} {} (requested {})", accuracy.name, short(accuracy.reached), accuracy.requested))
            .collect();
        let proof = match (&fewest.refutation, fewest.least) {
            (_, least) if let Some(found) = fewest.found => {
                let not_enough = match least {
                    least if least == found => format!("{} of the {views} views are proven not to", found - 1),
                    least => format!("fewer than {least} of the {views} views are proven not to"),
                };
                format!("{found} suffice too, with a longer tour; {not_enough}.")
            }
            (Some(_), least) if least == *count => {
                format!("{} of the {views} views are proven not to suffice.", count - 1)
            }
            (None, least) if least == *count => "Fewer cannot be chosen.".into(),
            (_, least) if least + 1 == *count => {
                format!(
                    "Fewer than {least} of the {views} views are proven not to suffice; whether {least} suffice is not known."
                )
            }
            (_, least) => format!(
                "Fewer than {least} of the {views} views are proven not to suffice; whether {least} to {} suffice is not \
                 known.",
                count - 1,
            ),
        };
        return format!("{count} poses reach the accuracy: {}.\n{proof}{anywhere}", reached.join(", "));
    }
    let most_poses = plan.tour.as_ref().and_then(|tour| tour.trade.as_ref()).and_then(|trade| trade.most_poses);
    if let Some(most) = most_poses {
        return format!(
            "{count} poses, as many as serve in the time, for criterion `{criterion}`: value {}, bound {}, certified efficiency \
             {efficiency:.4}: no poses of the {views} views whose tour keeps the time, {} at most, can give more than {:.2} % more \
             information.",
            short(*value),
            short(*bound),
            grouped(most),
            spare(*efficiency),
        );
    }
    let chosen = format!("{count} poses by `{method}` for criterion `{criterion}`: value {}", short(*value));
    match search {
        Some(search) if search.end == "optimal" => format!(
            "{chosen}, proven optimal: no {count} of the {views} views are better ({} nodes).{anywhere}",
            grouped(search.nodes)
        ),
        _ => {
            let ended = search
                .as_ref()
                .map(|search| format!(" The search ended by {} after {} nodes.", search.end, grouped(search.nodes)));
            format!(
                "{chosen}, bound {}, certified efficiency {efficiency:.4}: no {count} of the {views} views can give \
                 more than {:.2} % more information.{}{anywhere}",
                short(*bound),
                spare(*efficiency),
                ended.unwrap_or_default(),
            )
        }
    }
}

/// What is proven of all joint values.
fn anywhere(plan: &Plan, continuum: &ContinuumDocument) -> String {
    let ContinuumDocument { count, bound, efficiency, boxes, end, .. } = continuum;
    let reached = match end.as_str() {
        "closed" => String::new(),
        end => format!(" (the bound reached after {} boxes: {end})", grouped(*boxes)),
    };
    if plan.fewest.is_some() {
        return if *bound < 1.0 {
            format!("{count} poses are proven not to suffice at any joint values.")
        } else {
            format!("That {count} poses suffice at other joint values is not excluded{reached}.")
        };
    }
    format!(
        "At whatever joint values, no {count} poses can give more than {:.2} % more information: certified efficiency \
         {efficiency:.4}{reached}.",
        spare(*efficiency)
    )
}

/// What the poses take in the order of their tour.
pub fn on_the_way(tour: &TourDocument) -> String {
    let TourDocument { moving_s, least_moving_s, moving_by_id_s, total_s, dwell_s, assumed_speeds, .. } = tour;
    let gap = 100.0 * (1.0 - least_moving_s / moving_s);
    // Hundredths of a percent are rounding to who waits.
    let best = if *moving_s == 0.0 || gap < 0.01 {
        "no order takes less".to_owned()
    } else {
        format!("no order takes more than {gap:.2} % less")
    };
    let assumed = if assumed_speeds.is_empty() {
        String::new()
    } else {
        format!(" The speed of {} is not stated: a slow one is assumed.", assumed_speeds.join(", "))
    };
    let trade = tour.trade.as_ref().map(|trade| traded(trade, *total_s)).unwrap_or_default();
    format!(
        "In this order the moves take {moving_s:.1} s, by ascending id {moving_by_id_s:.1} s; {best}. With {dwell_s} s at each pose, \
         {total_s:.0} s in all.{assumed}{trade}{}{}",
        gave_way(&tour.gave_way),
        safety(tour)
    )
}

/// What the poses were chosen for beside their information, in a sentence or two.
fn traded(trade: &TradeDocument, total: f64) -> String {
    let TradeDocument { kept, best_total_s, least_total_s, most_poses: _ } = trade;
    let saved = match (kept, best_total_s) {
        (Some(kept), Some(best)) if *kept < 1.0 => format!(
            "\nChosen for a short tour too: the best poses found have {:.2} % more information and take {best:.1} s.",
            spare(*kept)
        ),
        (Some(_), Some(best)) => {
            format!("\nChosen for a short tour: the fewest poses found that suffice take {best:.1} s.")
        }
        _ => String::new(),
    };
    let bound = least_total_s.filter(|least| *least > 0.0).map(|least| {
        let gap = 100.0 * (1.0 - least / total);
        format!(" No set of the views that is as good takes less than {least:.1} s ({gap:.0} % less), which is proven.")
    });
    format!("{saved}{}", bound.unwrap_or_default())
}

/// Which views could not be led to.
fn gave_way(gone: &[GaveWayDocument]) -> String {
    if gone.is_empty() {
        return String::new();
    }
    let named: Vec<String> =
        gone.iter().map(|gone| format!("{} ({})", gone.id, in_the_way(&gone.endangered))).collect();
    format!("\nGave way to other poses, because no safe move was found that leads to them: {}.", named.join(", "))
}

/// What is known of the moves between the poses, where something is tested.
fn safety(tour: &TourDocument) -> String {
    let blocked = tour.blocked().map(|(place, found)| {
        let endangered = found.endangered.as_deref().unwrap_or_default();
        format!("move {} ({})", place + 1, in_the_way(endangered))
    });
    let blocked: Vec<String> = blocked.collect();
    if !blocked.is_empty() {
        return format!(
            "\nNOT SAFE, and no way round was found: {}. Do not run the tour as it is: choose other poses by `forbid`, or lead the arm \
             by hand.",
            blocked.join(", ")
        );
    }
    let least = |of: fn(&MoveDocument) -> Option<f64>| tour.moves.iter().filter_map(of).reduce(f64::min);
    // A bound is not rounded up.
    let millimetres = |least: f64| format!("{:.1} mm", (1e4 * least).floor() / 10.0);
    let clearance = least(|found| found.clearance_m)
        .map(|least| format!("no tested links come nearer than {}", millimetres(least)));
    let balance = least(|found| found.tip_over_margin_m)
        .map(|least| format!("the tip-over margin stays above {}", millimetres(least)));
    if clearance.is_none() && balance.is_none() {
        return String::new();
    }
    let untested = if clearance.is_none() { " Links were not tested for collision." } else { "" };
    let proven: Vec<String> = clearance.into_iter().chain(balance).collect();
    let round = tour.moves.iter().filter(|found| !found.via_rad.is_empty()).count();
    let round = match round {
        0 => "all moves straight".to_owned(),
        1 => "one move goes round about".to_owned(),
        round => format!("{round} moves go round about"),
    };
    format!("\nProven all along the way: {} ({round}).{untested}", proven.join(", "))
}

/// What makes a move unsafe, by the names of two links.
fn in_the_way(endangered: &[String]) -> String {
    match endangered {
        [a, b] => format!("{a} and {b} come within the clearance"),
        _ => "the tip-over margin falls below what is allowed".to_owned(),
    }
}

/// How much more than a share there is, in %.
fn spare(efficiency: f64) -> f64 {
    100.0 * (1.0 / efficiency - 1.0)
}

/// What matters most for a study's first outcome, in a sentence.
pub fn strongest(study: &StudyDocument) -> String {
    let Some(summary) = study.outcomes.first() else { return String::new() };
    let spans = summary.means.iter().filter_map(|AxisMeans { axis, means }| {
        let mut levels: Vec<(&str, Vec<f64>)> = Vec::new();
        for mean in means {
            let Some(value) = mean.mean else { continue };
            match levels.iter_mut().find(|(level, _)| *level == mean.level) {
                Some((_, values)) => values.push(value),
                None => levels.push((&mean.level, vec![value])),
            }
        }
        let averaged =
            levels.into_iter().map(|(level, values)| (level, values.iter().sum::<f64>() / values.len() as f64));
        let averaged: Vec<(&str, f64)> = averaged.collect();
        let least = averaged.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let most = averaged.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((axis, *least, *most))
    });
    let wider = |(_, least, most): &(&String, (&str, f64), (&str, f64))| most.1 / least.1;
    match spans.max_by(|a, b| wider(a).total_cmp(&wider(b))) {
        Some((axis, least, most)) => format!(
            "Of what varies, {axis} matters most for {}: its mean is {} at {} and {} at {}.",
            summary.outcome,
            short(least.1),
            least.0,
            short(most.1),
            most.0,
        ),
        None => format!("Nothing varies that {} could depend on.", summary.outcome),
    }
}

/// What a design found, in a sentence.
pub fn gain(design: &DesignDocument) -> String {
    let px = |number: Option<f64>| number.map_or_else(|| "-".into(), short);
    let best = design.best.map_error_px;
    let found = format!("The best set-up found gives {} poses a map error of {} px", design.count, px(best));
    match design.as_given.as_ref().map(|given| given.map_error_px) {
        Some(given) => {
            let factor = given.zip(best).map(|(given, best)| given / best);
            format!("{found}, {} times smaller than the file's own set-up with {} px.", px(factor), px(given))
        }
        None => format!("{found}; the file's own set-up has no plan of so many poses."),
    }
}

/// What a design proves, in a sentence.
pub fn family(design: &DesignDocument) -> String {
    let proof = &design.proof;
    let examined = grouped(proof.examined);
    match (proof.map_error_bound_px, proof.bound) {
        (Some(bound), _) => {
            format!("No plan for any of the {examined} set-ups examined can have less than {} px.", short(bound))
        }
        (None, Some(bound)) => format!(
            "No plan for any of the {examined} set-ups examined can have a better value than {}; the best found has {}.",
            short(bound),
            design.best.value.map_or_else(|| "-".into(), short)
        ),
        (None, None) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tour(moves: Vec<MoveDocument>) -> TourDocument {
        TourDocument {
            order: (0..=moves.len()).collect(),
            home_rad: None,
            returns: false,
            moving_s: moves.iter().map(|found| found.seconds).sum(),
            least_moving_s: 3.0,
            moving_by_id_s: 9.0,
            dwell_s: 1.0,
            total_s: 7.0,
            trade: None,
            gave_way: vec![],
            assumed_speeds: vec![],
            moves,
        }
    }

    fn safe(clearance_m: Option<f64>, tip_over_margin_m: Option<f64>) -> MoveDocument {
        MoveDocument {
            seconds: 2.0,
            via_rad: vec![],
            safe: Some(true),
            clearance_m,
            tip_over_margin_m,
            endangered: None,
        }
    }

    #[test]
    fn what_is_proven_is_not_rounded_up() {
        let said = on_the_way(&tour(vec![safe(Some(0.0046), Some(0.0207)), safe(Some(0.004_69), Some(0.3))]));
        assert!(said.contains("no order takes more than 25.00 % less"), "{said}");
        assert!(
            said.contains("no tested links come nearer than 4.6 mm, the tip-over margin stays above 20.7 mm"),
            "{said}"
        );
        assert!(said.ends_with("(all moves straight)."), "{said}");
        let said = on_the_way(&tour(vec![safe(None, Some(0.03)), safe(None, Some(0.03))]));
        assert!(said.ends_with("Links were not tested for collision."), "{said}");
    }

    #[test]
    fn moves_that_are_not_safe_come_first() {
        let blocked = |endangered: &[&str]| MoveDocument {
            safe: Some(false),
            endangered: Some(endangered.iter().map(|&name| name.to_owned()).collect()),
            ..safe(None, None)
        };
        let said = on_the_way(&tour(vec![safe(Some(0.1), None), blocked(&["arm", "board"]), blocked(&[])]));
        let expected = "NOT SAFE, and no way round was found: move 2 (arm and board come within the clearance), move 3 (the tip-over \
                        margin falls below what is allowed).";
        assert!(said.contains(expected) && !said.contains("Proven"), "{said}");
    }
}
