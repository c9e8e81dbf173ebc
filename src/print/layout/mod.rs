//! From an artwork to pages: one sheet, or several that are put together.

mod sheet;
mod strip;
mod tiles;

use super::artwork::{Artwork, Rectangle, Shape};
use super::error::PrintError;
use super::paper::Paper;
use sheet::Sheet;
use tiles::tiles;

/// Rounding of sums of lengths in mm.
const ROUNDING: f64 = 1e-9;

/// How to print a target.
#[derive(Debug, Clone, PartialEq)]
pub struct PrintSettings {
    /// The page, which may be turned; when left out the smallest of A4 to A0 that the pattern fits on (of several pages: A4), and
    /// one made to measure where it fits on none.
    pub paper: Option<Paper>,
    /// Border in mm that printers leave white, from 0.
    pub margin: f64,
    /// Whether a pattern that is too large for the page may be spread over several.
    pub tile: bool,
}

impl Default for PrintSettings {
    fn default() -> Self {
        Self { paper: None, margin: 10.0, tile: false }
    }
}

/// A target laid out on pages.
#[derive(Debug, Clone, PartialEq)]
pub struct Print {
    /// What it is.
    pub title: String,
    /// The pages; those of a tiling row by row, from the top left one.
    pub pages: Vec<Page>,
    /// Size of every page, as it lies.
    pub paper: Paper,
    /// Least width in mm of the white around the pattern.
    pub white: f64,
    /// Length in mm of the bar on every page by which its scale is checked.
    pub scale_bar: f64,
    /// How the pages are put together, where there are several.
    pub tiling: Option<Tiling>,
}

/// How pages are put together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tiling {
    /// Rows of pages.
    pub rows: usize,
    /// Columns of pages.
    pub columns: usize,
    /// Width in mm of the strip that neighbours both have.
    pub overlap: f64,
}

/// A page, in mm from its lower left corner, x to the right and y up.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Width and height.
    pub size: [f64; 2],
    /// The pattern's shapes on it.
    pub pattern: Vec<Shape>,
    /// What is seen of the pattern, where that is not all.
    pub window: Option<Rectangle>,
    /// Title, scale bar and marks.
    pub frame: Vec<Shape>,
    /// Its place among several.
    pub tile: Option<Tile>,
}

/// The place of a page among several, and its part of the pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tile {
    /// Row, from 1 at the top.
    pub row: usize,
    /// Column, from 1 at the left.
    pub column: usize,
    /// The part that it has alone, once it is cut at its marks, in frame T.
    pub part: Rectangle,
    /// Where T's origin is on the page.
    pub origin: [f64; 2],
}

impl Print {
    /// The `artwork` laid out on pages that bear the target's `name`.
    ///
    /// # Errors
    /// When the pattern does not fit on the page, or not on a reasonable number of them.
    pub fn new(artwork: &Artwork, name: &str, settings: &PrintSettings) -> Result<Self, PrintError> {
        let PrintSettings { paper, margin, tile } = *settings;
        if !(margin >= 0.0 && margin.is_finite()) {
            return Err(PrintError::Margin { margin });
        }
        let title = format!("{}. {}. calipose {}", artwork.title, printable(name), env!("CARGO_PKG_VERSION"));
        let fits = |paper: Paper| Sheet::best(artwork, paper, margin);
        let next = |like: Paper| like.family().find(|&paper| fits(paper).is_some());
        let usual = Paper { name: Some("A4"), size: [210.0, 297.0] };
        let needed = Sheet::needed(artwork, margin);
        let paper = match paper {
            None if tile => usual,
            None => next(usual).unwrap_or(Paper { name: None, size: needed.map(|side| (side - ROUNDING).ceil()) }),
            Some(paper) => paper,
        };
        if paper.size.iter().any(|&side| side > Paper::MOST) {
            return Err(PrintError::TooLarge { needed });
        }
        if let Some(sheet) = fits(paper) {
            return Ok(sheet.print(artwork, &title));
        }
        if tile {
            return tiles(artwork, paper, margin, &title);
        }
        let (pattern, quiet) = (artwork.size, artwork.quiet);
        Err(PrintError::TooSmall { paper, pattern, quiet, needed, next: next(paper) })
    }
}

/// A name on one line.
fn printable(name: &str) -> String {
    name.split(|c: char| c.is_control() || c.is_whitespace())
        .filter(|word| !word.is_empty())
        .collect::<Vec<_>>()
        .join(" ")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use proptest::prelude::*;

    use super::*;
    use crate::target::Board;

    fn board(columns: usize, rows: usize, square_mm: f64) -> Artwork {
        Artwork::new(&Board::checkerboard(columns, rows, square_mm / 1e3)).unwrap()
    }

    fn on(artwork: &Artwork, paper: &str, tile: bool) -> Result<Print, PrintError> {
        let settings = PrintSettings { paper: Some(paper.parse().unwrap()), tile, ..PrintSettings::default() };
        Print::new(artwork, "robot", &settings)
    }

    /// Where the pattern lies on a page that has all of it.
    fn place(page: &Page) -> Rectangle {
        let bounds: Vec<Rectangle> = page.pattern.iter().map(Shape::bounds).collect();
        let side = |pick: fn(&Rectangle, usize) -> f64, most: fn(f64, f64) -> f64| {
            [0, 1].map(|axis| bounds.iter().map(|found| pick(found, axis)).reduce(most).unwrap())
        };
        Rectangle { min: side(|r, axis| r.min[axis], f64::min), max: side(|r, axis| r.max[axis], f64::max) }
    }

    #[test]
    fn the_smallest_page_is_taken_and_turned_as_the_pattern_lies() {
        let paper = |columns, rows, square_mm| {
            let print = Print::new(&board(columns, rows, square_mm), "robot", &PrintSettings::default()).unwrap();
            assert_eq!(print.pages.len(), 1);
            print.paper.to_string()
        };
        assert_eq!(paper(8, 6, 10.0), "A4 (297 × 210 mm)");
        assert_eq!(paper(6, 8, 10.0), "A4 (210 × 297 mm)");
        assert_eq!(paper(8, 6, 35.0), "A3 (420 × 297 mm)");
        assert_eq!(paper(9, 6, 80.0), "A0 (1189 × 841 mm)");
        assert_eq!(paper(9, 6, 200.0), "2126 × 1500 mm", "made to measure");
    }

    #[test]
    fn pages_too_small_name_the_next_of_their_family() {
        let next = |paper: &str, square_mm| match on(&board(8, 6, square_mm), paper, false).unwrap_err() {
            PrintError::TooSmall { next, .. } => next.map(|paper| paper.name.unwrap()),
            other => panic!("{other}"),
        };
        assert_eq!(next("A4", 35.0), Some("A3"));
        assert_eq!(next("letter", 35.0), Some("ansi-c"));
        assert_eq!(next("300x200", 35.0), Some("A3"));
        assert_eq!(next("A0", 300.0), None);
        let error = on(&board(8, 6, 35.0), "A4", false).unwrap_err().to_string();
        assert_eq!(
            error,
            "A4 (210 × 297 mm) is too small: the pattern has 315 × 245 mm, and with 17.5 mm of white around it, title and scale bar it \
             takes 376 × 280 mm"
        );
        assert!(on(&board(8, 6, 35.0), "376x280", false).is_ok() && on(&board(8, 6, 35.0), "280x376", false).is_ok());
        assert!(on(&board(8, 6, 35.0), "375.9x280", false).is_err());
        let wide = PrintSettings { margin: f64::NAN, ..PrintSettings::default() };
        assert!(matches!(Print::new(&board(8, 6, 35.0), "", &wide), Err(PrintError::Margin { .. })));
        let vast = Print::new(&board(900, 900, 35.0), "", &PrintSettings::default()).unwrap_err();
        assert!(matches!(vast, PrintError::TooLarge { .. }));
        assert!(matches!(on(&board(900, 900, 35.0), "A4", true), Err(PrintError::TooManyPages { .. })));
        assert!(matches!(on(&board(8, 6, 35.0), "60x90", true), Err(PrintError::NoRoom { .. })));
    }

    #[test]
    fn what_fits_on_a_page_is_not_tiled() {
        assert_eq!(on(&board(8, 6, 20.0), "A4", true), on(&board(8, 6, 20.0), "A4", false));
    }

    #[test]
    fn pages_say_what_they_have() {
        let print = on(&board(8, 6, 35.0), "A4", true).unwrap();
        assert_eq!(print.tiling.map(|tiling| (tiling.rows, tiling.columns)), Some((2, 2)));
        let words = |page: &Page| {
            let texts = page
                .frame
                .iter()
                .filter_map(|shape| if let Shape::Text(text) = shape { Some(&text.words[..]) } else { None });
            texts.collect::<Vec<_>>().join("|")
        };
        let said = words(&print.pages[1]);
        for part in ["Row 1 of 2, column 2 of 2", "8 × 6 inner corners, squares of 35 mm", "100 %", "100 mm"] {
            assert!(said.contains(part), "{part}: {said}");
        }
        let has_corner_0: Vec<bool> = print.pages.iter().map(|page| words(page).contains("corner 0")).collect();
        assert_eq!(has_corner_0, [false, false, true, false]);
        assert!(words(&on(&board(8, 6, 35.0), "A3", false).unwrap().pages[0]).contains(". robot. calipose "));
        assert_eq!(printable(" a\nb\t c "), "a b c");
    }

    proptest! {
        #[test]
        fn white_is_kept_around_the_pattern_and_the_margin_is_empty(
            columns in 2_usize..15, rows in 2_usize..15, square_mm in 1.0..60.0, margin in 0.0..20.0
        ) {
            let artwork = board(columns, rows, square_mm);
            let print = Print::new(&artwork, "robot", &PrintSettings { margin, ..PrintSettings::default() }).unwrap();
            let page = &print.pages[0];
            prop_assert_eq!(page.size, print.paper.size);
            let Rectangle { min, max } = place(page);
            let least = print.white - 1e-9;
            prop_assert!(least >= artwork.quiet - 2e-9);
            let wide = Rectangle { min: min.map(|x| x - least), max: max.map(|x| x + least) };
            for axis in 0..2 {
                prop_assert!(wide.min[axis] >= 0.0 && wide.max[axis] <= page.size[axis]);
                prop_assert!((max[axis] - min[axis] - artwork.size[axis]).abs() < 1e-9);
            }
            let inside = Rectangle { min: [margin - 1e-9; 2], max: page.size.map(|side| side - margin + 1e-9) };
            for shape in &page.frame {
                let bounds = shape.bounds();
                prop_assert!(!bounds.overlaps(&wide), "{:?}", shape);
                let within = (0..2).all(|i| bounds.min[i] >= inside.min[i] && bounds.max[i] <= inside.max[i]);
                prop_assert!(within, "{:?} on {:?}", shape, page.size);
            }
        }

        #[test]
        fn tiles_make_up_the_pattern(
            columns in 2_usize..15, rows in 2_usize..15, square_mm in 20.0..80.0, margin in 0.0..15.0
        ) {
            let artwork = board(columns, rows, square_mm);
            let settings = PrintSettings { margin, tile: true, paper: Paper::named("A4") };
            let print = Print::new(&artwork, "robot", &settings).unwrap();
            let Some(tiling) = print.tiling else { return Ok(()) };
            prop_assert_eq!(print.pages.len(), tiling.rows * tiling.columns);
            let mut area = 0.0;
            for page in &print.pages {
                let Tile { part, origin, .. } = page.tile.unwrap();
                let [width, height] = part.size();
                prop_assert!(width > 0.0 && height > 0.0);
                area += width * height;
                // All of the part is seen, and every shape that it touches is drawn, in the place that the tile states.
                let window = page.window.unwrap();
                let in_frame_t = |corner: [f64; 2]| [corner[0] - origin[0], corner[1] - origin[1]];
                let seen = Rectangle { min: in_frame_t(window.min), max: in_frame_t(window.max) };
                for axis in 0..2 {
                    prop_assert!(seen.min[axis] <= part.min[axis] + 1e-9 && seen.max[axis] >= part.max[axis] - 1e-9);
                    prop_assert!(window.min[axis] >= margin && window.max[axis] <= page.size[axis] - margin);
                }
                let drawn = artwork.shapes.iter().filter(|shape| shape.bounds().overlaps(&part));
                for shape in drawn {
                    prop_assert!(page.pattern.contains(&shape.moved(origin)));
                }
                // No page's edge passes through a corner.
                let [x, y] = [0, 1].map(|axis| [part.min[axis], part.max[axis]]);
                for corner in artwork.shapes.iter().map(Shape::bounds) {
                    prop_assert!(x.iter().all(|x| (x - corner.min[0]).abs() > square_mm / 4.0));
                    prop_assert!(y.iter().all(|y| (y - corner.min[1]).abs() > square_mm / 4.0));
                }
                for shape in &page.frame {
                    prop_assert!(!shape.bounds().overlaps(&window), "{:?}", shape);
                }
            }
            let [width, height] = artwork.size.map(|side| side + 2.0 * artwork.quiet);
            prop_assert!((area - width * height).abs() < 1e-6 * area);
        }
    }
}
