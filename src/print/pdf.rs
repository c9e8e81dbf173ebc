//! Pages as one PDF file.

use pdf_writer::{Content, Name, Pdf, Rect, Ref, Str, TextStr};

use super::MARK;
use super::artwork::{Anchor, Rectangle, Shape, Text};
use super::layout::{Page, Print};

/// Points in a millimetre.
const POINTS: f64 = 72.0 / 25.4;

/// Name of the font in pages.
const FONT: Name = Name(b"F1");

/// All pages as a PDF file.
pub(super) fn pdf(print: &Print) -> Vec<u8> {
    let [catalog, tree, info, font] = [1, 2, 3, 4].map(Ref::new);
    let count = i32::try_from(print.pages.len()).unwrap_or(i32::MAX);
    let page_ids = |i: i32| [5 + 2 * i, 6 + 2 * i].map(Ref::new);
    let mut pdf = Pdf::new();
    let mut root = pdf.catalog(catalog);
    root.pages(tree);
    // Readers that heed it offer to print at 100 %.
    root.viewer_preferences().display_doc_title(true).pair(Name(b"PrintScaling"), Name(b"None"));
    drop(root);
    pdf.document_info(info).title(TextStr(&print.title)).creator(TextStr(MARK));
    pdf.pages(tree).kids((0..count).map(|i| page_ids(i)[0])).count(count);
    pdf.type1_font(font).base_font(Name(b"Helvetica")).encoding_predefined(Name(b"WinAnsiEncoding"));
    for (i, page) in (0..count).zip(&print.pages) {
        let [id, content] = page_ids(i);
        let [width, height] = page.size.map(|side| (side * POINTS) as f32);
        let mut written = pdf.page(id);
        written.parent(tree).media_box(Rect::new(0.0, 0.0, width, height)).contents(content);
        written.resources().fonts().pair(FONT, font);
        drop(written);
        pdf.stream(content, &drawn(page));
    }
    pdf.finish()
}

/// What draws a page, in mm.
fn drawn(page: &Page) -> Vec<u8> {
    let mut content = Content::new();
    let scale = POINTS as f32;
    content.transform([scale, 0.0, 0.0, scale, 0.0, 0.0]).save_state();
    if let Some(window) = &page.window {
        rectangle(&mut content, window);
        content.clip_nonzero().end_path();
    }
    fill(&mut content, &page.pattern);
    content.restore_state();
    fill(&mut content, &page.frame);
    content.finish().into_vec()
}

fn fill(content: &mut Content, shapes: &[Shape]) {
    for shape in shapes {
        match shape {
            Shape::Rectangle(found) => rectangle(content, found),
            Shape::Circle { centre, radius } => circle(content, *centre, *radius),
            Shape::Polygon(corners) => polygon(content, corners),
            Shape::Text(_) => {}
        }
    }
    content.fill_nonzero();
    for shape in shapes {
        if let Shape::Text(words) = shape {
            text(content, words);
        }
    }
}

fn rectangle(content: &mut Content, rectangle: &Rectangle) {
    let ([x, y], [width, height]) = (rectangle.min, rectangle.size());
    content.rect(x as f32, y as f32, width as f32, height as f32);
}

fn polygon(content: &mut Content, corners: &[[f64; 2]]) {
    for (i, [x, y]) in corners.iter().map(|corner| corner.map(|x| x as f32)).enumerate() {
        if i == 0 {
            content.move_to(x, y);
        } else {
            content.line_to(x, y);
        }
    }
    content.close_path();
}

/// Four cubic Bézier curves, at most 0.03 % of the radius off.
fn circle(content: &mut Content, [x, y]: [f64; 2], radius: f64) {
    /// Length of the handles of a quarter.
    const HANDLE: f64 = 0.552_284_749_830_793_6;
    let at = |u: f64, v: f64| [x + u * radius, y + v * radius].map(|x| x as f32);
    let [start_x, start_y] = at(1.0, 0.0);
    content.move_to(start_x, start_y);
    for [u, v] in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] {
        // A quarter leads from (u, v) to (−v, u).
        let ([ax, ay], [bx, by], [cx, cy]) =
            (at(u - HANDLE * v, v + HANDLE * u), at(HANDLE * u - v, HANDLE * v + u), at(-v, u));
        content.cubic_to(ax, ay, bx, by, cx, cy);
    }
    content.close_path();
}

fn text(content: &mut Content, text: &Text) {
    let back = match text.anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => text.width() / 2.0,
    };
    let [x, y] = text.at;
    let matrix = if text.upwards { [0.0, 1.0, -1.0, 0.0, x, y - back] } else { [1.0, 0.0, 0.0, 1.0, x - back, y] };
    content.begin_text().set_font(FONT, text.size as f32).set_text_matrix(matrix.map(|x| x as f32));
    content.show(Str(&encoded(&text.words))).end_text();
}

/// The text in `WinAnsiEncoding`, with `?` for what Helvetica does not have.
fn encoded(text: &str) -> Vec<u8> {
    let byte = |character: char| match u32::from(character) {
        code @ (0x20..=0x7e | 0xa0..=0xff) => code as u8,
        _ => b'?',
    };
    text.chars().map(byte).collect()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::print::{Artwork, Paper, PrintSettings};
    use crate::target::Board;

    fn print(paper: &str, tile: bool) -> Print {
        let artwork = Artwork::new(&Board::checkerboard(8, 6, 0.0357)).unwrap();
        let settings = PrintSettings { paper: Some(paper.parse().unwrap()), tile, ..PrintSettings::default() };
        Print::new(&artwork, "Ärm (Ω)", &settings).unwrap()
    }

    /// The operands of every `operator` in the file, whose streams are not compressed.
    fn operands(file: &[u8], operator: &str) -> Vec<Vec<f64>> {
        let text = String::from_utf8_lossy(file);
        let lines = text.lines().filter_map(|line| line.trim().strip_suffix(operator));
        lines.map(|line| line.split_whitespace().filter_map(|word| word.parse().ok()).collect()).collect()
    }

    #[test]
    fn squares_stand_in_the_file_as_laid_out() {
        let print = print("A3", false);
        let file = print.pdf();
        assert_eq!(operands(&file, " cm"), [[2.834_645_7, 0.0, 0.0, 2.834_645_7, 0.0, 0.0]]);
        let rectangles = operands(&file, " re");
        let page = &print.pages[0];
        for (read, shape) in rectangles.iter().zip(&page.pattern) {
            let Rectangle { min: [x, y], max } = shape.bounds();
            for (read, laid_out) in read.iter().zip([x, y, max[0] - x, max[1] - y]) {
                assert!((read - laid_out).abs() < 1e-4, "{read} {laid_out}");
            }
        }
        let drawn = |shapes: &[Shape]| shapes.iter().filter(|shape| matches!(shape, Shape::Rectangle(_))).count();
        assert_eq!(rectangles.len(), drawn(&page.pattern) + drawn(&page.frame));
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains("/MediaBox [0 0 1190.551") && text.contains("/PrintScaling /None"), "{text}");
    }

    #[test]
    fn pages_of_a_tiling_are_in_one_file_with_a_window_each() {
        let print = print("A4", true);
        let file = print.pdf();
        let windows = operands(&file, "W").len();
        assert_eq!((print.pages.len() > 1, windows), (true, print.pages.len()));
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains(&format!("/Count {windows}")), "{text}");
        // Texts with letters beyond ASCII are written in hexadecimal.
        let hex: String = b"Row 1 of 2, column 2 of 2".iter().map(|byte| format!("{byte:02X}")).collect();
        assert!(text.contains(&format!("<{hex}")), "{text}");
        assert_eq!(file, print.pdf(), "the same bytes");
    }

    #[test]
    fn letters_that_helvetica_lacks_are_marked() {
        assert_eq!(encoded("8 × Ä Ω\n"), b"8 \xd7 \xc4 ??");
        assert_eq!((Paper::MOST * POINTS).round(), 14_400.0, "the longest side that PDF 1.7 recommends");
    }
}
