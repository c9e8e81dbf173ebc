//! What a plan proves, in words: the same in the terminal and on its page.

use crate::figures::{grouped, short};
use crate::plan::document::Plan;

/// What was chosen, and what is proven of it.
pub fn outcome(plan: &Plan) -> String {
    let Plan { count, method, criterion, value, bound, efficiency, search, fewest, .. } = plan;
    let spare = 100.0 * (1.0 / efficiency - 1.0);
    let views = grouped(plan.survey.views);
    if let Some(fewest) = fewest {
        let reached: Vec<String> = fewest
            .accuracies
            .iter()
            .map(|accuracy| format!("{} {} (requested {})", accuracy.name, short(accuracy.reached), accuracy.requested))
            .collect();
        let proof = match (&fewest.refutation, fewest.least) {
            (Some(_), least) if least == *count => format!("{} are proven not to suffice.", count - 1),
            (None, least) if least == *count => "Fewer cannot be chosen.".into(),
            (_, least) if least + 1 == *count => {
                format!("Fewer than {least} are proven not to suffice; whether {least} suffice is not known.")
            }
            (_, least) => format!(
                "Fewer than {least} are proven not to suffice; whether {least} to {} suffice is not known.",
                count - 1,
            ),
        };
        return format!("{count} poses reach the accuracy: {}.\n{proof}", reached.join(", "));
    }
    let chosen = format!("{count} poses by `{method}` for criterion `{criterion}`: value {}", short(*value));
    match search {
        Some(search) if search.end == "optimal" => format!(
            "{chosen}, proven optimal: no {count} of the {views} views are better ({} nodes).",
            grouped(search.nodes)
        ),
        _ => {
            let ended = search
                .as_ref()
                .map(|search| format!(" The search ended by {} after {} nodes.", search.end, grouped(search.nodes)));
            format!(
                "{chosen}, bound {}, certified efficiency {efficiency:.4}: no {count} of the {views} views can give \
                 more than {spare:.2} % more information.{}",
                short(*bound),
                ended.unwrap_or_default(),
            )
        }
    }
}
