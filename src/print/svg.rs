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
