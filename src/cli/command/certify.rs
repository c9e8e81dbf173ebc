//! `calipose certify`.

use std::path::PathBuf;

use clap::Args;

use crate::cli::loaded_plan::LoadedPlan;
use crate::cli::output::failure::Failure;
use crate::cli::output::{Screen, grouped, short};
use crate::plan::assess::{CertifyError, Unchecked, certify};

#[derive(Debug, Args)]
pub(crate) struct CertifyArguments {
    /// plan.json of the plan, as `calipose plan` wrote it
    plan: PathBuf,
    /// Problem file [default: the one named in run.json beside the plan]
    #[arg(long)]
    problem: Option<PathBuf>,
}

pub(crate) fn run(arguments: &CertifyArguments, screen: &mut Screen) -> Result<(), Failure> {
    let loaded = LoadedPlan::open(&arguments.plan, arguments.problem.as_deref())?;
    let refused = |error: CertifyError| Failure::Certify { path: arguments.plan.clone(), error: Box::new(error) };
    loaded.plan.fit(&loaded.problem).map_err(|error| refused(error.into()))?;
    let survey = loaded.survey(&arguments.plan, screen)?;
    let LoadedPlan { plan, problem, text, .. } = &loaded;
    let mut confirmed = certify(plan, problem, &survey).map_err(refused)?;
    confirmed.unchecked.extend(Unchecked::unknown(text, plan));
    loaded.among_its_own(&arguments.plan, &[])?;
    screen.document(&confirmed.document(plan))?;
    let mut text = format!(
        "{}: the certificate holds. Criterion `{}`, {} poses: value {}, bound {} over all {} views, certified efficiency \
         {:.4}.\nEvery field of the plan, except those listed below, was recomputed from the problem file and the plan's \
         matrix, and agrees to {:.0e}.",
        plan.problem.name,
        plan.criterion,
        plan.count,
        short(confirmed.value),
        short(confirmed.bound),
        grouped(confirmed.views),
        confirmed.efficiency,
        confirmed.tolerance,
    );
    if let Some([bound, efficiency]) = confirmed.continuum {
        text += &format!(
            "\nOver all joint values: bound {}, certified efficiency {efficiency:.4}, by boxes of joint values bounded anew.",
            short(bound)
        );
    }
    if let Some(fewest) = &plan.fewest {
        text += &match (confirmed.least, &fewest.refutation) {
            (Some(least), _) => format!("\n{} poses are proven not to reach the accuracy.", least - 1),
            (None, Some(_)) => {
                format!("\n{} poses do not reach the accuracy; this was found by search.", fewest.least - 1)
            }
            (None, None) => String::new(),
        };
    }
    if plan.search.is_some() {
        text += "\nThe plan claims more than its matrix proves: a bound found by search, which only `calipose plan` can repeat.";
    }
    for same_reason in confirmed.unchecked.chunk_by(|a, b| a.reason == b.reason) {
        let fields: Vec<String> = same_reason.iter().map(|unchecked| format!("`{}`", unchecked.field)).collect();
        text += &format!("\nNot checked: {}: {}.", fields.join(", "), same_reason[0].reason);
    }
    screen.text(&text)
}
