//! `calipose study submit`.

use std::io::ErrorKind;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use clap::Args;

use super::processes::run_all;
use super::{StudyArguments, threads};
use crate::cli::by_name;
use crate::cli::interrupt::writing;
use crate::cli::number_of;
use crate::cli::output::failure::Failure;
use crate::cli::output::{Screen, grouped};
use crate::experiment::{Engine, Job, Store, Study, Work, shell_line};
use crate::plan::document::{Document, JobDocument};
use crate::plan::results::write_together;

#[derive(Debug, Args)]
pub(crate) struct SubmitArguments {
    #[command(flatten)]
    arguments: StudyArguments,
    /// What runs the job
    #[arg(long, value_parser = by_name(&Engine::ALL, Engine::name))]
    engine: Engine,
    /// Tasks to divide the cells into, at most one for each cell [default: 8, or with `local` what this machine does at a time]
    #[arg(long, value_name = "N", value_parser = number_of(false))]
    shards: Option<usize>,
    /// Cores that each task works on
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    cores: u16,
    /// Option for Slurm's `sbatch`, as in --option=--partition=short; repeatable
    #[arg(long = "option", value_name = "OPTION", allow_hyphen_values = true)]
    options: Vec<String>,
    /// Write the job's files, and start nothing
    #[arg(long)]
    dry_run: bool,
}

/// Name of the folder of a job, in that of the results.
const FOLDER: &str = "job";

/// Shards where nothing says how many.
const SHARDS: usize = 8;

pub(super) fn submit(arguments: &SubmitArguments, screen: &mut Screen) -> Result<(), Failure> {
    let SubmitArguments { engine, options, dry_run, .. } = arguments;
    if *engine != Engine::Slurm && !options.is_empty() {
        return Err(Failure::Usage(format!("--option is for Slurm's sbatch; the engine {} takes none", engine.name())));
    }
    let (study, output) = arguments.arguments.study()?;
    let work = arguments.work(&study, &output)?;
    if *engine == Engine::Slurm && work.output.contains(['%', '\\']) {
        return Err(Failure::Usage(format!(
            "Slurm reads % and \\ in the names of its logs in its own way, and these would be in {}; choose another folder with --output",
            work.output
        )));
    }
    // That another run is at work, or the folder another study's, is better told now than by each of the tasks.
    drop(Store::alone(&output, &study, work.force)?);
    let job = engine.job(&work, options);
    let folder = output.join(FOLDER);
    writing(|| write_together(&folder, &job.files, &Engine::FILES))?;
    let mut merged = String::new();
    let jobs = match engine {
        _ if *dry_run => Vec::new(),
        Engine::Local => {
            merged = run_here(&work, screen)?;
            Vec::new()
        }
        Engine::Slurm | Engine::HyperQueue => start(*engine, &job, &folder)?,
    };
    screen.document(&JobDocument {
        header: JobDocument::header(),
        name: work.name.clone(),
        engine: engine.name().into(),
        cells: work.cells,
        shards: work.shards.get(),
        cores: work.cores.get(),
        output: PathBuf::from(&work.output),
        folder: PathBuf::from(&work.output).join(FOLDER),
        files: job.files.iter().map(|(name, _)| (*name).to_owned()).collect(),
        started: !dry_run,
        start: job.start.clone(),
        jobs: jobs.clone(),
        merge: work.merge(),
    })?;
    let mut text = arguments.told(&work, &job, &folder);
    text += &match engine {
        _ if *dry_run => unstarted(&job, &folder),
        Engine::Local => format!("\n{}", merged.trim_end()),
        Engine::Slurm | Engine::HyperQueue => watched(*engine, &jobs, &folder),
    };
    if *engine != Engine::Local && !dry_run {
        text += &format!(
            "\nIf a task fails, submit the study again: cells that are there are not computed again.\nTo merge them again: {}",
            shell_line(&work.merge())
        );
    }
    screen.text(&text)
}

impl SubmitArguments {
    /// Tasks that this machine does at a time.
    fn at_once(&self) -> usize {
        (threads().get() / usize::from(self.cores)).max(1)
    }

    fn work(&self, study: &Study, output: &Path) -> Result<Work, Failure> {
        let calipose =
            std::env::current_exe().map_err(|error| Failure::Usage(format!("where is calipose? {error}")))?;
        let shards = self.shards.unwrap_or(if self.engine == Engine::Local { self.at_once() } else { SHARDS });
        let some = |number: usize| NonZero::new(number).unwrap_or(NonZero::<usize>::MIN);
        Ok(Work {
            calipose: absolute(&calipose)?,
            file: absolute(&self.arguments.study.file)?,
            output: absolute(output)?,
            name: study.name.clone(),
            cells: study.cells(),
            shards: some(shards.min(study.cells())),
            cores: some(self.cores.into()),
            force: self.arguments.force,
        })
    }

    /// What was written.
    fn told(&self, work: &Work, job: &Job, folder: &Path) -> String {
        let shards = work.shards.get();
        let counted =
            |count: usize, what: &str| format!("{} {what}{}", grouped(count), if count == 1 { "" } else { "s" });
        let asked = match self.shards {
            Some(asked) if asked > shards => format!("; {} would leave some without a cell", grouped(asked)),
            _ => String::new(),
        };
        let names: Vec<&str> = job.files.iter().map(|(name, _)| *name).collect();
        format!(
            "{}: {} in {}{asked}.\nWritten to {}: {}.",
            work.name,
            counted(work.cells, "cell"),
            counted(shards, "shard"),
            folder.display(),
            names.join(", ")
        )
    }
}

/// A path as it stands in a job's files.
fn absolute(path: &Path) -> Result<String, Failure> {
    let whole = std::path::absolute(path).ok().and_then(|path| path.into_os_string().into_string().ok());
    whole.ok_or_else(|| {
        Failure::Usage(format!("the path {} is not text, and cannot stand in a job's file", path.display()))
    })
}

/// Runs the processes of a job on this machine, and gives what the merge says.
fn run_here(work: &Work, screen: &Screen) -> Result<String, Failure> {
    let shards = work.shards.get();
    // They keep to the cores that this process was given.
    let at_once = (threads().get() / work.cores).max(1);
    let quiet = |mut command: Vec<String>| {
        command.push("--quiet".to_owned());
        command
    };
    let bar = screen.spinner("computing");
    let commands: Vec<Vec<String>> = (0..shards).map(|shard| quiet(work.shard(shard))).collect();
    let failed = |what: String| move |said| Failure::Process { what, said };
    run_all(&commands, at_once, &|done| bar.set_message(format!("{done} of {shards} shards")))
        .map_err(|(shard, said)| failed(format!("shard {shard} of {shards}"))(said))?;
    bar.finish_and_clear();
    let bar = screen.spinner("merging");
    let merged = run_all(&[work.merge()], 1, &|_| {}).map_err(|(_, said)| failed("the merge".into())(said))?;
    bar.finish_and_clear();
    Ok(merged.concat())
}

/// Runs the command lines that start a job. Gives what the engine calls what was started.
fn start(engine: Engine, job: &Job, folder: &Path) -> Result<Vec<String>, Failure> {
    let mut jobs: Vec<String> = Vec::new();
    for number in 0..job.start.len() {
        let command = job.line(number, jobs.last().map_or("", String::as_str));
        let refused = |said: String| Failure::Engine {
            engine: engine.name(),
            command: shell_line(&command),
            said,
            before: jobs.join(", "),
        };
        let (program, arguments) = command.split_first().ok_or_else(|| refused(String::new()))?;
        let run = Command::new(program).args(arguments).current_dir(folder).stdin(Stdio::null()).output();
        let output = run.map_err(|error| match error.kind() {
            ErrorKind::NotFound => Failure::NoEngine { engine: engine.name(), missing: format!("`{program}`") },
            _ => refused(error.to_string()),
        })?;
        let said = String::from_utf8_lossy(&output.stderr);
        if said.contains(NO_PACKAGE) {
            return Err(Failure::NoEngine { engine: engine.name(), missing: "Python's package hyperqueue".into() });
        }
        // After its name comes that of the cluster, where Slurm has several.
        let printed = String::from_utf8_lossy(&output.stdout);
        let name = printed.trim().lines().last().and_then(|line| line.split(';').next()).unwrap_or_default();
        if !output.status.success() || name.is_empty() {
            let said = if said.trim().is_empty() { output.status.to_string() } else { last_lines(&said) };
            return Err(refused(said));
        }
        jobs.push(name.to_owned());
    }
    Ok(jobs)
}

/// What Python says where the package is not installed.
const NO_PACKAGE: &str = "No module named 'hyperqueue'";

/// The last lines of what a program says, where the reason is.
fn last_lines(said: &str) -> String {
    const MOST: usize = 6;
    let lines: Vec<&str> = said.trim().lines().filter(|line| !line.trim().is_empty()).collect();
    lines[lines.len().saturating_sub(MOST)..].join("\n")
}

/// How a job is started that was only written.
fn unstarted(job: &Job, folder: &Path) -> String {
    let folder = folder.display().to_string();
    let lines: Vec<String> = match &job.start[..] {
        [] => job.files.iter().map(|(name, _)| format!("sh {name}")).collect(),
        commands => commands.iter().map(|command| shell_line(command)).collect(),
    };
    let name = Job::BEFORE;
    let number =
        if lines.len() > 1 { format!("\n{name} stands for the number that the first prints.") } else { String::new() };
    format!(
        "\nNothing was started. To start it:\n  {}\n  {}{number}",
        shell_line(&["cd".to_owned(), folder]),
        lines.join("\n  ")
    )
}

/// How a job can be watched.
fn watched(engine: Engine, jobs: &[String], folder: &Path) -> String {
    let folder = folder.display();
    match (engine, jobs) {
        (Engine::Slurm, [cells, merge]) => format!(
            "\nSubmitted to Slurm: the cells as job {cells}, the merge as job {merge}.\nTo watch them: squeue --jobs={cells},{merge}; \
             what they say is in {folder}, in shard-*.log and merge.log.\nTo end them: scancel {cells} {merge}"
        ),
        (_, jobs) => {
            let job = jobs.join(" ");
            format!(
                "\nSubmitted to HyperQueue as job {job}.\nTo watch it: hq job progress {job}; what its tasks say is in {folder}, in shard-*.out, \
                 shard-*.err, merge.out and merge.err.\nTo end it: hq job cancel {job}"
            )
        }
    }
}
