//! `calipose board`.

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use crate::cli::arguments::ProblemArguments;
use crate::cli::interrupt::writing;
use crate::cli::output::Screen;
use crate::cli::output::failure::Failure;
use crate::cli::own_files::bears;
use crate::figures::trimmed;
use crate::plan::document::{BoardDocument, PrintedFile};
use crate::plan::results::write_together;
use crate::print::{Artwork, MARK, Page, Paper, Print, PrintSettings};
use crate::target::Board;

#[derive(Debug, Args)]
pub(crate) struct BoardArguments {
    #[command(flatten)]
    problem: ProblemArguments,
    /// Folder, or a file that ends with .pdf or .svg [default: PROBLEM-board.pdf and .svg in the working directory]
    #[arg(long, short)]
    output: Option<PathBuf>,
    /// A5 to A0, letter, legal, tabloid, ansi-c to ansi-e, or a size in mm such as 400x300; turned as it fits [default: the smallest of A4
    /// to A0 that does]
    #[arg(long, value_name = "PAGE")]
    page: Option<Paper>,
    /// Spread a pattern that is too large for the page (A4 unless --page says otherwise) over several
    #[arg(long)]
    tile: bool,
    /// Border that the printer leaves white, in mm
    #[arg(long = "margin-mm", value_name = "MM", default_value_t = PrintSettings::default().margin, value_parser = margin)]
    margin: f64,
    /// What to write [default: both, or what the file's name says]
    #[arg(long)]
    format: Option<Format>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Pdf,
    Svg,
    Both,
}

pub(crate) fn run(arguments: &BoardArguments, screen: &mut Screen) -> Result<(), Failure> {
    let problem = arguments.problem.problem(&[])?;
    let Place { folder, stem, format } = arguments.place()?;
    let settings = PrintSettings { paper: arguments.page, margin: arguments.margin, tile: arguments.tile };
    let artwork = Artwork::new(&problem.target.board)?;
    let print = Print::new(&artwork, &problem.name, &settings)?;
    let files = files(&print, &stem, format);
    for (file, _) in &files {
        let path = folder.join(&file.file);
        if path.symlink_metadata().is_ok() && !bears(&path, MARK) {
            return Err(Failure::Exists(path));
        }
    }
    let stale = stale(&folder, &stem, &files);
    let stale: Vec<&str> = stale.iter().map(String::as_str).collect();
    let written: Vec<(&Path, &[u8])> = files.iter().map(|(file, bytes)| (&*file.file, &**bytes)).collect();
    writing(|| write_together(&folder, &written, &stale))?;
    let files: Vec<PrintedFile> =
        files.into_iter().map(|(file, _)| PrintedFile { file: folder.join(file.file), ..file }).collect();
    screen.document(&BoardDocument::new(&problem, &artwork, &print, &files))?;
    screen.text(&text(&problem.name, &problem.target.board, &artwork, &print, &files, arguments))
}

/// Where files go, what their names begin with, and which are written.
struct Place {
    folder: PathBuf,
    stem: String,
    format: Format,
}

impl BoardArguments {
    fn place(&self) -> Result<Place, Failure> {
        let stem = |path: &Path| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let named = self.output.as_deref().filter(|path| !path.is_dir()).and_then(|path| {
            let extension = path.extension()?.to_ascii_lowercase();
            let format =
                [("pdf", Format::Pdf), ("svg", Format::Svg)].into_iter().find(|(name, _)| extension == *name)?.1;
            Some((path, format))
        });
        let Some((path, format)) = named else {
            let folder = self.output.clone().unwrap_or_default();
            let stem = format!("{}-board", stem(self.problem.path()));
            return Ok(Place { folder, stem, format: self.format.unwrap_or(Format::Both) });
        };
        match self.format {
            Some(asked) if asked != Format::Both && asked != format => {
                Err(Failure::Usage(format!("--format asks for another file than --output {}", path.display())))
            }
            asked => {
                let folder = path.parent().unwrap_or(Path::new("")).to_owned();
                Ok(Place { folder, stem: stem(path), format: asked.unwrap_or(format) })
            }
        }
    }
}

/// The files by their names, and what is in them.
fn files(print: &Print, stem: &str, format: Format) -> Vec<(PrintedFile, Vec<u8>)> {
    let mut files = Vec::new();
    if format != Format::Svg {
        files.push((PrintedFile::new(format!("{stem}.pdf").into(), None), print.pdf()));
    }
    if format != Format::Pdf {
        files.extend(print.pages.iter().zip(print.svg()).map(|(page, svg)| {
            let place = place_of(page).map_or(String::new(), |(row, column)| format!("-row{row}-column{column}"));
            (PrintedFile::new(format!("{stem}{place}.svg").into(), place_of(page)), svg.into_bytes())
        }));
    }
    files
}

/// SVG files that an earlier run wrote for pages that this one does not have.
fn stale(folder: &Path, stem: &str, files: &[(PrintedFile, Vec<u8>)]) -> Vec<String> {
    let is_svg = |path: &Path| path.extension().is_some_and(|extension| extension == "svg");
    if !files.iter().any(|(file, _)| is_svg(&file.file)) {
        return Vec::new();
    }
    let here = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let names =
        fs::read_dir(here).into_iter().flatten().flatten().filter_map(|entry| entry.file_name().into_string().ok());
    let is_page = |name: &String| {
        let page = name.strip_prefix(stem).and_then(|rest| rest.strip_suffix(".svg"));
        page.is_some_and(|page| page.is_empty() || is_tile(page)) && bears(&folder.join(name), MARK)
    };
    names.filter(is_page).collect()
}

/// Whether the end of a name is that of a tile: `-row1-column2`.
fn is_tile(end: &str) -> bool {
    let numbers = end.strip_prefix("-row").and_then(|rest| rest.split_once("-column"));
    numbers.is_some_and(|(row, column)| [row, column].iter().all(|number| number.parse::<usize>().is_ok()))
}

fn place_of(page: &Page) -> Option<(usize, usize)> {
    page.tile.map(|tile| (tile.row, tile.column))
}

/// Which corner has the number 0.
fn first_corner(board: &Board) -> &'static str {
    match board {
        Board::Checkerboard(_) => "corner 0 is the lower left inner corner.",
        Board::Charuco(_) => "corner 0 is the upper left inner corner, as in OpenCV.",
        Board::AprilGrid(_) => "corner 0 is the lower left corner of the lower left tag, as in Kalibr.",
        Board::Circles(board) if board.is_asymmetric() => "corner 0 is the upper left circle, as in OpenCV.",
        Board::Circles(_) => "corner 0 is the lower left circle.",
        Board::Points(_) => "corner 0 is the first point.",
    }
}

fn text(
    name: &str,
    board: &Board,
    artwork: &Artwork,
    print: &Print,
    files: &[PrintedFile],
    arguments: &BoardArguments,
) -> String {
    let [width, height] = artwork.size.map(|side| trimmed(side, 4));
    let pages = print.tiling.map_or(String::new(), |tiling| {
        format!("{} pages ({} × {}) of ", print.pages.len(), tiling.columns, tiling.rows)
    });
    let files: Vec<String> = files.iter().map(|file| file.file.display().to_string()).collect();
    let mut text = format!(
        "{name}: {}, {width} × {height} mm, on {pages}{}, with {} mm of white around it.\nWritten to {}.\n\
         Print at 100 %, not fitted to the page, and measure the bar: {} mm.",
        artwork.title,
        print.paper,
        trimmed(print.white, 1),
        files.join(", "),
        print.scale_bar
    );
    if print.tiling.is_some() {
        text += " Cut the pages at their marks and join them edge to edge.";
    }
    text += "\nSeen from the front, x points to the right and y up; ";
    text += first_corner(board);
    if arguments.page.is_none() && print.paper.name.is_none() {
        text += "\nNo page up to A0 is large enough: this one is made to measure. `--tile` spreads the pattern over A4 pages.";
    }
    text
}

fn margin(text: &str) -> Result<f64, String> {
    let parsed = text.parse().ok().filter(|margin: &f64| *margin >= 0.0 && margin.is_finite());
    parsed.ok_or_else(|| "must be a number from 0 on".into())
}
