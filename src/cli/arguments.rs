//! Arguments that several commands share.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, StringValueParser, TypedValueParser};

use super::output::failure::Failure;
use crate::information::Criterion;
use crate::problem::{Method, Overrides, Problem};

/// A problem file, and what the command line says in place of its values.
#[derive(Debug, Args)]
pub(super) struct ProblemArguments {
    /// Problem file (TOML), such as `calipose init` writes
    pub(super) file: PathBuf,
    /// Replace the value of a key of the problem file, by its path, as in `camera.fx_px=900`; repeatable
    #[arg(long = "set", value_name = "KEY=VALUE")]
    set: Vec<String>,
}

/// The keys of the selection that have an option of their own, each with the text typed: what is wrong with it is told as of the
/// file's.
#[derive(Debug, Args)]
pub(super) struct SelectionArguments {
    /// What to optimise [default: the file's criterion or accuracy]
    #[arg(long, value_parser = Named(Criterion::ALL.map(|criterion| (criterion.name(), criterion.phrase()))))]
    criterion: Option<String>,
    /// Seed of everything random [default: the file's]
    #[arg(long)]
    seed: Option<String>,
}

impl ProblemArguments {
    /// The problem file.
    pub(super) fn path(&self) -> &Path {
        &self.file
    }

    /// The problem, with `options` (keys and what was typed for them) after those of `--set`.
    ///
    /// # Errors
    /// When a text of `--set` is no `KEY=VALUE`, or the problem is refused.
    pub(super) fn problem(&self, options: &[(&str, Option<String>)]) -> Result<Problem, Failure> {
        let typed = options.iter().filter_map(|(key, value)| Some(format!("{key}={}", value.as_ref()?)));
        let mut overrides = Overrides::new();
        for text in self.set.iter().cloned().chain(typed) {
            overrides = overrides.set(&text).map_err(|error| Failure::Usage(error.to_string()))?;
        }
        Ok(Problem::read_with(&self.file, &overrides)?)
    }
}

impl SelectionArguments {
    /// The keys, and what was typed for them.
    pub(super) fn options(&self) -> [(&'static str, Option<String>); 2] {
        [("selection.criterion", self.criterion.clone()), ("selection.seed", self.seed.clone())]
    }
}

/// Parser of `--method`.
pub(super) fn method() -> impl TypedValueParser<Value = String> {
    Named(Method::ALL.map(|method| (method.name(), method.phrase())))
}

/// Takes any text; names that help and completions show, each with a phrase, are known to the problem's own checks.
#[derive(Debug, Clone)]
struct Named<const N: usize>([(&'static str, &'static str); N]);

impl<const N: usize> TypedValueParser for Named<N> {
    type Value = String;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &std::ffi::OsStr,
    ) -> Result<String, clap::Error> {
        StringValueParser::new().parse_ref(command, argument, value)
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.0.iter().map(|&(name, phrase)| PossibleValue::new(name).help(phrase))))
    }
}
