//! Boards drawn as SVG, read back by an XML parser.

use calipose::print::{Artwork, Paper, Print, PrintSettings};
use calipose::target::Board;
use roxmltree::{Document, Node};

fn attribute(node: Node, name: &str) -> f64 {
    node.attribute(name).unwrap().trim_end_matches("mm").parse().unwrap()
}

#[test]
fn squares_stand_in_the_file_as_the_board_has_them() {
    let board = Board::checkerboard(8, 5, 0.0357);
    let artwork = Artwork::new(&board).unwrap();
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
        let from_first = corner - board.corner(0);
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
    let artwork = Artwork::new(&Board::checkerboard(8, 6, 0.04)).unwrap();
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
