//! `calipose follow`.

mod answers;
mod state;
mod summary;
mod watch;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;

use answers::{Answers, Heard};
use state::StateFile;
use watch::{News, Watch};

use crate::cli::known::known_by;
use crate::cli::loaded_plan::LoadedPlan;
use crate::cli::long_work::sweeping;
use crate::cli::output::failure::Failure;
use crate::cli::output::verdict::Verdict;
use crate::cli::output::{Screen, wrapped};
use crate::formats::Known;
use crate::plan::assess::{Announcement, Answer, Follow, Input, Until};
use crate::plan::document::{EventKind, FollowEvent, TakenPicture};
use crate::plan::results::{FOLLOW_FILE, hash, probe};

/// Time between two looks at the files of detections.
const BETWEEN_LOOKS: Duration = Duration::from_millis(100);

#[derive(Debug, Args)]
pub(crate) struct FollowArguments {
    /// plan.json of the plan, as `calipose plan` wrote it
    plan: PathBuf,
    /// Problem file [default: the one named in run.json beside the plan]
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Folder to which a detector writes files of detected corners, mrcal's vnl or calipose's JSON: a new picture ends its pose
    #[arg(long, value_name = "FOLDER", group = "pictures")]
    watch: Option<PathBuf>,
    /// One such file that grows
    #[arg(long, value_name = "FILE", group = "pictures")]
    detections: Option<PathBuf>,
    /// Use only images whose names match, with `*` for any text, as in '*cam0*'
    #[arg(long, value_name = "PATTERN", requires = "pictures")]
    images: Option<String>,
    /// Accuracy at which the tour ends, of the map error or intrinsics, as in `map_error_px=1.5,fx=0.8` [default: the
    /// problem file's accuracy, else the map error that the plan promises]
    #[arg(long, value_name = "NAME=VALUE", value_delimiter = ',', value_parser = accuracy, requires = "pictures")]
    until: Vec<(String, f64)>,
    /// Most poses to add where the plan's do not reach the accuracy
    #[arg(long, value_name = "N", default_value_t = 0, requires = "pictures")]
    more: usize,
    /// Folder for the calibration by the pictures, as `calipose calibrate` writes it, and for their corners
    #[arg(long, short, requires = "pictures")]
    output: Option<PathBuf>,
    /// Begin anew, whatever follow.json beside the plan says
    #[arg(long)]
    restart: bool,
}

pub(crate) fn run(arguments: &FollowArguments, screen: &mut Screen) -> Result<Verdict, Failure> {
    let path = &arguments.plan;
    let LoadedPlan { plan, problem, text, .. } =
        LoadedPlan::read_to_add(path, arguments.problem.as_deref(), &[FOLLOW_FILE])?;
    let until =
        Until::new(&problem, &plan, &arguments.until).map_err(|error| Failure::Usage(format!("--until: {error}")))?;
    probe(path.parent().unwrap_or(Path::new("")))?;
    if let Some(output) = &arguments.output {
        probe(output)?;
    }
    let mut file = StateFile::new(path, &text);
    let state = if arguments.restart { None } else { file.read()? };
    let is_resumed = state.is_some();
    let taken: Vec<TakenPicture> =
        state.iter().flat_map(|state| &state.visits).flat_map(|visit| visit.pictures.iter().cloned()).collect();
    let watch = arguments.watched(known_by(&problem, arguments.images.clone()), &taken)?;
    let follow = Follow::new(&problem, &plan, &hash(text.as_bytes()), until, watch.is_some(), arguments.more, state)
        .map_err(|mismatch| file.refused(&format!("{mismatch}; begin anew with --restart")))?;
    if is_resumed {
        let place = follow.state().place;
        let at = if place == follow.state().visits.len() { "its end".into() } else { format!("pose {}", place + 1) };
        screen.text(&wrapped(&format!("The tour goes on at {at}; --restart begins it anew.\n")))?;
    }
    Session { arguments, follow, watch, file, screen, since: Instant::now() }.run()
}

impl FollowArguments {
    /// What is watched, where pictures are; `taken` count already.
    fn watched(&self, known: Known, taken: &[TakenPicture]) -> Result<Option<Watch>, Failure> {
        match (&self.watch, &self.detections) {
            (Some(folder), _) if !folder.is_dir() => {
                Err(Failure::Usage(format!("--watch {}: there is no such folder", folder.display())))
            }
            (Some(folder), _) => Ok(Some(Watch::folder(folder.clone(), known, taken))),
            (None, Some(file)) if file.is_dir() => {
                let file = file.display();
                Err(Failure::Usage(format!("--detections {file} is a folder: watch it with --watch {file}")))
            }
            (None, Some(file)) => Ok(Some(Watch::file(file.clone(), known, taken))),
            (None, None) => Ok(None),
        }
    }

    /// Where pictures come from, in words.
    fn source(&self) -> Option<String> {
        let folder = self.watch.as_ref().map(|folder| format!("a file of detections in {}", folder.display()));
        folder.or_else(|| self.detections.as_ref().map(|file| file.display().to_string()))
    }
}

/// A tour between its files and its user.
struct Session<'a> {
    arguments: &'a FollowArguments,
    follow: Follow<'a>,
    watch: Option<Watch>,
    file: StateFile,
    screen: &'a mut Screen,
    /// Since when time has not been counted.
    since: Instant,
}

impl Session<'_> {
    fn run(mut self) -> Result<Verdict, Failure> {
        let answers = Answers::new();
        let mut told = self.follow.begin();
        loop {
            if let Some(verdict) = self.tell(told)? {
                return Ok(verdict);
            }
            told = match answers.wait(self.watch.as_ref().map(|_| BETWEEN_LOOKS)) {
                Heard::Line(line) => match line.parse::<Answer>() {
                    Ok(answer) => self.follow.take(Input::Answer(answer)),
                    Err(error) => {
                        self.event(EventKind::Refused, &format!("{error}."))?;
                        Vec::new()
                    }
                },
                Heard::End => self.follow.take(Input::Closed),
                Heard::Nothing => self.look()?,
            };
        }
    }

    /// What the files of detections bring.
    fn look(&mut self) -> Result<Vec<Announcement>, Failure> {
        let mut pictures = Vec::new();
        let news: Vec<News> = self.watch.iter_mut().flat_map(Watch::look).collect();
        for news in news {
            match news {
                News::Picture(picture) => pictures.push(picture),
                News::Unreadable { file, reason } => self.unreadable(&file, &reason)?,
            }
        }
        Ok(if pictures.is_empty() { Vec::new() } else { self.follow.take(Input::Pictures(pictures)) })
    }

    fn unreadable(&mut self, file: &str, reason: &str) -> Result<(), Failure> {
        self.event(EventKind::Unreadable, &format!("{file} cannot be read, and is waited on: {reason}."))
    }

    /// Keeps how far the tour has come, then tells of it; the verdict if it ends.
    fn tell(&mut self, mut told: Vec<Announcement>) -> Result<Option<Verdict>, Failure> {
        if told.is_empty() {
            return Ok(None);
        }
        loop {
            self.keep()?;
            let mut further = None;
            for announcement in &told {
                match announcement {
                    Announcement::More(most) => further = Some(*most),
                    Announcement::End(end) => return self.end(announcement, end.good).map(Some),
                    _ => self.announce(announcement)?,
                }
            }
            let Some(most) = further else { return Ok(None) };
            let added = sweeping(self.screen, self.follow.problem(), |observe| self.follow.further(most, observe))?;
            told = self.follow.take(Input::Further(added));
        }
    }

    /// Writes how far the tour has come.
    fn keep(&mut self) -> Result<(), Failure> {
        self.follow.pass(self.since.elapsed().as_secs_f64());
        self.since = Instant::now();
        self.file.write(self.follow.state())
    }

    fn announce(&mut self, announcement: &Announcement) -> Result<(), Failure> {
        if let (Announcement::Go(_), Some(watch)) = (announcement, &mut self.watch) {
            // Before anybody can have taken a picture for this pose.
            let early = watch.mark();
            let first = early.pictures.first().cloned();
            if let Some(first) = first {
                let more = early.pictures.len() - 1;
                let others = if more > 0 { format!(" and {more} more") } else { String::new() };
                let text = format!("{first}{others} do not count: they were there before the pose was announced.");
                let text =
                    if more > 0 { text } else { text.replace("do not count: they were", "does not count: it was") };
                self.event(EventKind::Early, &text)?;
            }
            for (file, reason) in early.unreadable {
                self.unreadable(&file, &reason)?;
            }
        }
        if let Some(document) = announcement.document(&self.follow, None) {
            self.screen.line(&document)?;
        }
        let mut text = wrapped(&announcement.sentence(&self.follow));
        if let Announcement::Go(stop) = announcement {
            let chain = &self.follow.problem().robot.chain;
            let source = self.arguments.source();
            text = format!(
                "\n{text}\n\n{}\n\n{}",
                summary::values(stop, chain),
                wrapped(&summary::prompt(source.as_deref()))
            );
        }
        self.screen.text(&text)
    }

    fn event(&mut self, kind: EventKind, text: &str) -> Result<(), Failure> {
        self.screen.line(&FollowEvent::new(kind, text.to_owned()))?;
        self.screen.text(&wrapped(text))
    }

    /// Writes the calibration if that is asked for, and sums up.
    fn end(&mut self, announcement: &Announcement, is_good: bool) -> Result<Verdict, Failure> {
        let output = self.arguments.output.as_deref().zip(self.follow.known());
        let written = output.map(|(folder, known)| summary::write(&self.follow, known, folder)).transpose()?;
        let folder = output.map(|(folder, _)| folder.display().to_string());
        if let Some(document) = announcement.document(&self.follow, folder.as_deref()) {
            self.screen.line(&document)?;
        }
        let mut text = format!("\n{}\n{}", wrapped(&announcement.sentence(&self.follow)), summary::text(&self.follow));
        text += &written.map(|written| format!("\n{written}")).unwrap_or_default();
        self.screen.text(&text)?;
        Ok(Verdict::good_if(is_good))
    }
}

/// Parser of an accuracy.
fn accuracy(text: &str) -> Result<(String, f64), String> {
    let parsed = text.split_once('=').and_then(|(name, value)| {
        let value = value.trim().parse().ok().filter(|value: &f64| *value > 0.0 && value.is_finite())?;
        Some((name.trim().to_owned(), value))
    });
    parsed.ok_or_else(|| "must be a name and a positive number, as in map_error_px=1.5".into())
}
