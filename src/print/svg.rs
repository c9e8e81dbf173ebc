//! A page as SVG, its unit the millimetre.

use super::MARK;
use super::artwork::{Anchor, Rectangle, Shape, Text};
use super::layout::Page;
use crate::figures::trimmed;

/// The page as an SVG file.
pub(super) fn svg(page: &Page, title: &str) -> String {
    let [width, height] = page.size;
    let svg = Svg { height };
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- {MARK} -->\n\
         <svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}mm\" height=\"{1}mm\" viewBox=\"0 0 {0} {1}\">\n\
         <title>{2}</title>\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
        number(width),
        number(height),
        escaped(title)
    );
    let clip = page.window.map(|window| format!("<clipPath id=\"window\">{}</clipPath>\n", svg.rectangle(&window)));
    text += clip.as_deref().unwrap_or_default();
    text += &format!("<g id=\"pattern\"{}>\n", clip.map_or("", |_| " clip-path=\"url(#window)\""));
    text += &svg.lines(&page.pattern);
    text += "</g>\n<g id=\"frame\" font-family=\"Helvetica, Arial, sans-serif\">\n";
    text += &svg.lines(&page.frame);
    text + "</g>\n</svg>\n"
}

/// In SVG, y points down.
struct Svg {
    height: f64,
}

impl Svg {
    fn lines(&self, shapes: &[Shape]) -> String {
        shapes.iter().map(|shape| self.shape(shape) + "\n").collect()
    }

    fn point(&self, [x, y]: [f64; 2]) -> [String; 2] {
        [number(x), number(self.height - y)]
    }

    fn rectangle(&self, rectangle: &Rectangle) -> String {
        let [x, y] = self.point([rectangle.min[0], rectangle.max[1]]);
        let [width, height] = rectangle.size().map(number);
        format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"/>")
    }

    fn shape(&self, shape: &Shape) -> String {
        match shape {
            Shape::Rectangle(rectangle) => self.rectangle(rectangle),
            Shape::Circle { centre, radius } => {
                let [x, y] = self.point(*centre);
                format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\"/>", number(*radius))
            }
            Shape::Polygon(corners) => {
                let points: Vec<String> = corners.iter().map(|&corner| self.point(corner).join(",")).collect();
                format!("<polygon points=\"{}\"/>", points.join(" "))
            }
            Shape::Text(text) => self.text(text),
        }
    }

    fn text(&self, text: &Text) -> String {
        let [x, y] = self.point(text.at);
        let anchor = match text.anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
        };
        let turn = if text.upwards { format!(" transform=\"rotate(-90 {x} {y})\"") } else { String::new() };
        let (size, words) = (number(text.size), escaped(&text.words));
        format!("<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"{anchor}{turn}>{words}</text>")
    }
}

/// A length to a nanometre.
fn number(length: f64) -> String {
    trimmed(length, 6)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use roxmltree::{Document, Node};

    use crate::print::{Artwork, Paper, Print, PrintSettings};
    use crate::target::Board;

    fn attribute(node: Node, name: &str) -> f64 {
        node.attribute(name).unwrap().trim_end_matches("mm").parse().unwrap()
    }

    #[test]
    fn squares_stand_in_the_file_as_the_board_has_them() {
        let board = Board { columns: 8, rows: 5, square: 0.0357 };
        let artwork = Artwork::checkerboard(&board).unwrap();
        let print = Print::new(&artwork, "R&D <1>", &PrintSettings::default()).unwrap();
        let text = &print.svg()[0];
        let file = Document::parse(text).unwrap();
        let root = file.root_element();
        assert!(file.descendants().any(|node| node.text().is_some_and(|text| text.contains("R&D <1>"))));
        let [width, height] = print.paper.size;
        assert_eq!([attribute(root, "width"), attribute(root, "height")], [width, height]);
        assert_eq!(root.attribute("viewBox").unwrap(), format!("0 0 {width} {height}"));
        let pattern = root.children().find(|node| node.attribute("id") == Some("pattern")).unwrap();
        let squares: Vec<[f64; 4]> = pattern
            .children()
            .filter(Node::is_element)
            .map(|node| ["x", "y", "width", "height"].map(|name| attribute(node, name)))
            .collect();
        assert_eq!(squares.len(), 27);
        // Corner 0 is at the lower left: the first square's corner with the greatest x and the least y of the file.
        let [x0, y0] = [squares[0][0] + 35.7, squares[0][1]];
        for (index, corner) in board.corners().enumerate() {
            let from_first = corner - board.corner(0, 0);
            let at = [x0 + from_first.x * 1e3, y0 - from_first.y * 1e3];
            let touching = squares.iter().filter(|[x, y, width, height]| {
                let is_near = |a: f64, b: f64| (a - b).abs() < 1e-5;
                let x_meets = is_near(*x, at[0]) || is_near(x + width, at[0]);
                x_meets && (is_near(*y, at[1]) || is_near(y + height, at[1]))
            });
            assert_eq!(touching.count(), 2, "corner {index}");
        }
    }

    #[test]
    fn windows_of_tiles_hide_the_rest() {
        let artwork = Artwork::checkerboard(&Board { columns: 8, rows: 6, square: 0.04 }).unwrap();
        let settings = PrintSettings { tile: true, paper: Paper::named("A4"), ..PrintSettings::default() };
        let print = Print::new(&artwork, "robot", &settings).unwrap();
        for (text, page) in print.svg().iter().zip(&print.pages) {
            let file = Document::parse(text).unwrap();
            let clip = file.descendants().find(|node| node.has_tag_name("clipPath")).unwrap();
            let window = clip.first_element_child().unwrap();
            let expected = page.window.unwrap();
            assert!((attribute(window, "x") - expected.min[0]).abs() < 1e-5);
            assert!((attribute(window, "y") - (page.size[1] - expected.max[1])).abs() < 1e-5);
            assert!((attribute(window, "width") - expected.size()[0]).abs() < 1e-5);
            assert!(text.contains("clip-path=\"url(#window)\""));
        }
    }
}
