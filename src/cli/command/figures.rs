//! `calipose figures`.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::report::Reported;
use crate::cli::interrupt::writing;
use crate::cli::loaded_plan::LoadedPlan;
use crate::cli::output::Screen;
use crate::cli::output::failure::Failure;
use crate::plan::document::{Document, FigureFile, FiguresDocument, ProblemReference};
use crate::plan::results::{probe, write_together};
use crate::report::{Figure, Style, plan_drawings, plan_figures, png, svg, tour_figure};

#[derive(Debug, Args)]
pub(crate) struct FiguresArguments {
    /// plan.json of the plan, as `calipose plan` wrote it
    plan: PathBuf,
    /// Problem file [default: the one that run.json beside the plan names]
    #[arg(long)]
    problem: Option<PathBuf>,
    /// Folder for the figures [default: `figures` beside the plan]
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// Write these figures only, by their names
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    only: Vec<String>,
    /// What to write
    #[arg(long, default_value = "both")]
    format: Format,
    /// Width in mm; a column of a two-column paper has some 85
    #[arg(long = "width-mm", value_name = "MM", default_value_t = 120.0)]
    width: f64,
    /// Height in mm [default: 0.65 of the width]
    #[arg(long = "height-mm", value_name = "MM")]
    height: Option<f64>,
    /// Size of the text in pt
    #[arg(long = "font-pt", value_name = "PT", default_value_t = 8.0)]
    font: f64,
    /// Dots per inch of PNG
    #[arg(long, default_value_t = 300.0)]
    dpi: f64,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Svg,
    Png,
    Both,
}

/// Dots along a side of a PNG at most: more is a slip of the keyboard.
const MOST_DOTS: f64 = 20_000.0;

pub(crate) fn run(arguments: &FiguresArguments, screen: &mut Screen) -> Result<(), Failure> {
    let style = arguments.style()?;
    let path = &arguments.plan;
    let loaded = LoadedPlan::read(path, arguments.problem.as_deref())?;
    let beside = path.parent().unwrap_or(Path::new("")).join("figures");
    let folder = arguments.output.clone().unwrap_or(beside);
    probe(&folder)?;
    let survey = loaded.survey(&arguments.plan, screen)?;
    let (chooser, selected) = loaded.locate(path, &survey)?;
    let reported = Reported::beside(path, &loaded.plan, &chooser, &selected)?;
    let documents = reported.documents(&loaded.plan)?;
    let tour = tour_figure(&documents).into_iter().collect();
    let all = [plan_figures(&documents), tour, plan_drawings(&documents)].concat();
    let figures = arguments.chosen(&all)?;
    let mut files = Vec::new();
    let mut listed = Vec::new();
    for figure in figures {
        for (name, bytes) in arguments.files(figure, &style)? {
            listed.push(FigureFile {
                figure: figure.name.to_string(),
                title: figure.title.clone(),
                file: name.clone(),
            });
            files.push((name, bytes));
        }
    }
    let named: Vec<(&Path, &[u8])> = files.iter().map(|(name, bytes)| (Path::new(name), bytes.as_slice())).collect();
    writing(|| write_together(&folder, &named, &[]))?;
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    screen.document(&FiguresDocument {
        header: FiguresDocument::header(),
        problem: ProblemReference::new(&loaded.problem),
        files: listed,
    })?;
    screen.text(&format!("Written to {}: {}.", folder.display(), names.join(", ")))
}

impl FiguresArguments {
    fn style(&self) -> Result<Style, Failure> {
        let height = self.height.unwrap_or(0.65 * self.width);
        let named = [
            ("--width-mm", self.width, 20.0, 2000.0),
            ("--height-mm", height, 20.0, 2000.0),
            ("--font-pt", self.font, 2.0, 100.0),
            ("--dpi", self.dpi, 10.0, 2400.0),
        ];
        for (name, value, least, most) in named {
            if !(least..=most).contains(&value) {
                return Err(Failure::Usage(format!("{name} is {value}; it must be from {least} to {most}")));
            }
        }
        let dots = self.width.max(height) / 25.4 * self.dpi;
        if self.format != Format::Svg && dots > MOST_DOTS {
            return Err(Failure::Usage(format!(
                "a PNG would have {dots:.0} dots along its longer side; at most {MOST_DOTS:.0} are written: take a smaller --dpi, or \
                 --format svg"
            )));
        }
        Ok(Style::paper(self.width, height, self.font))
    }

    fn chosen<'a>(&self, all: &'a [Figure]) -> Result<Vec<&'a Figure>, Failure> {
        if self.only.is_empty() {
            return Ok(all.iter().collect());
        }
        let find = |name: &String| {
            all.iter().find(|figure| figure.name == *name).ok_or_else(|| {
                let names: Vec<&str> = all.iter().map(|figure| &*figure.name).collect();
                Failure::Usage(format!("--only: this plan has no figure \"{name}\"; it has {}", names.join(", ")))
            })
        };
        self.only.iter().map(find).collect()
    }

    fn files(&self, figure: &Figure, style: &Style) -> Result<Vec<(String, Vec<u8>)>, Failure> {
        let mut files = Vec::new();
        if self.format != Format::Png {
            files.push((format!("{}.svg", figure.name), svg(figure, style).into_bytes()));
        }
        if self.format != Format::Svg {
            let picture = png(figure, style, self.dpi).map_err(|error| Failure::Table(error.to_string()))?;
            files.push((format!("{}.png", figure.name), picture));
        }
        Ok(files)
    }
}
