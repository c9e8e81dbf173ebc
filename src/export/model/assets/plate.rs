//! The board as a textured plate.
//!
//! The plate's front is as large as the pattern with the white that detectors need around it, and so may be larger than the plate that is
//! tested for collision, which is of the printed size.

use nalgebra::{Point2, Point3};

use super::mesh::{Material, Mesh};
use crate::export::ExportFile;
use crate::export::text::file_name;
use crate::print::{Artwork, Pattern};
use crate::target::Target;

/// Pixels of the picture along its longer side.
const PIXELS: f64 = 2048.0;
/// Points of a pixel along each side that its grey is the mean of.
const POINTS: u32 = 4;

/// Name of the material.
const MATERIAL: &str = "board";

/// Files of a plate.
pub(super) struct Plate {
    /// All of them.
    pub(super) files: Vec<ExportFile>,
    /// Name of the mesh's.
    pub(super) mesh: String,
    /// Name of the picture's; none where the pattern is not known.
    pub(super) picture: Option<String>,
}

/// The plate of a board, in T, with its picture where its pattern is known.
pub(super) fn plate(target: &Target, name: &str) -> Plate {
    let named = |ending: &str| file_name(name, ending);
    let mesh = named("board.obj");
    let pattern = Artwork::new(&target.board).ok().map(|artwork| Pattern::new(&artwork));
    let Some((pattern, grey)) = pattern
        .map(|pattern| (picture(&pattern), pattern))
        .and_then(|((size, grey), pattern)| Some((pattern, png(size, &grey)?)))
    else {
        let (width, height) = target.board.printed_size();
        let bytes = solid([width / 2.0, height / 2.0], target.thickness).obj(None).into_bytes();
        return Plate { files: vec![ExportFile { name: mesh.clone(), bytes }], mesh, picture: None };
    };
    let (material, picture) = (named("board.mtl"), named("board.png"));
    let obj = solid(pattern.half_extents(), target.thickness).obj(Some(Material { file: &material, name: MATERIAL }));
    let mtl = format!("newmtl {MATERIAL}\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nmap_Kd {picture}\n");
    let files = [(mesh.clone(), obj.into_bytes()), (material, mtl.into_bytes()), (picture.clone(), grey)];
    let files = files.map(|(name, bytes)| ExportFile { name, bytes }).to_vec();
    Plate { files, mesh, picture: Some(picture) }
}

/// A plate under its front, which is at z = 0; the picture is on the front, and its lower left corner's colour everywhere else.
fn solid(half: [f64; 2], thickness: f64) -> Mesh {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let level = |z: f64| corners.map(|[x, y]| Point3::new(x * half[0], y * half[1], z));
    let vertices = [level(0.0), level(-thickness)].concat();
    let mut places: Vec<Point2<f64>> =
        corners.iter().map(|[x, y]| Point2::new((x + 1.0) / 2.0, (y + 1.0) / 2.0)).collect();
    let plain = places.len();
    places.push(Point2::new(1e-3, 1e-3));
    let mut triangles = vec![[[0, 0], [1, 1], [2, 2]], [[0, 0], [2, 2], [3, 3]]];
    let mut quad = |[a, b, c, d]: [usize; 4]| {
        triangles.extend([[a, b, c], [a, c, d]].map(|triangle| triangle.map(|vertex| [vertex, plain])));
    };
    quad([4, 7, 6, 5]);
    for i in 0..4 {
        let next = (i + 1) % 4;
        quad([i, i + 4, next + 4, next]);
    }
    Mesh { vertices, places, triangles }
}

/// Width and height in px and the grey values, row by row from the top, of a pattern with its white.
fn picture(pattern: &Pattern) -> ([u32; 2], Vec<u8>) {
    let half = pattern.half_extents();
    let pixel = 2.0 * half[0].max(half[1]) / PIXELS;
    let size = half.map(|half| (2.0 * half / pixel).round().max(1.0) as u32);
    let [width, height] = size;
    // Whole pixels fill the plate.
    let place = |i: u32, count: u32, half: f64| ((f64::from(i) + 0.5) / f64::from(count * POINTS) * 2.0 - 1.0) * half;
    let is_white = |u: u32, v: u32| {
        let (x, y) = (place(u, width, half[0]), -place(v, height, half[1]));
        pattern.is_black(x, y) != Some(true)
    };
    let points = POINTS * POINTS;
    let grey = |i: u32| {
        let (u, v) = (i % width * POINTS, i / width * POINTS);
        let white = (0..points).filter(|k| is_white(u + k % POINTS, v + k / POINTS)).count() as u32;
        (white * 255 / points) as u8
    };
    (size, (0..width * height).map(grey).collect())
}

/// Grey values as a PNG; none of a picture that PNG does not hold.
fn png([width, height]: [u32; 2], grey: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().and_then(|mut writer| writer.write_image_data(grey)).ok()?;
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::target::Board;

    #[test]
    fn the_picture_is_the_pattern_as_seen_from_the_front() {
        let pattern = Pattern::new(&Artwork::new(&Board::checkerboard(4, 3, 0.02)).unwrap());
        let ([width, height], grey) = picture(&pattern);
        let half = pattern.half_extents();
        assert_eq!(width, 2048);
        assert!((f64::from(height) - 2048.0 * half[1] / half[0]).abs() < 1.0);
        // In the middle of each square, and in the white around.
        for (x, y) in (-3..=3).flat_map(|i| (-3..=3).map(move |j| (0.01 * f64::from(i), 0.01 * f64::from(j)))) {
            let (x, y) = (x + 1e-3, y + 1e-3);
            let u = (f64::midpoint(x / half[0], 1.0) * f64::from(width)) as u32;
            let v = ((1.0 - y / half[1]) / 2.0 * f64::from(height)) as u32;
            let expected = if pattern.is_black(x, y) == Some(true) { 0 } else { 255 };
            assert_eq!(grey[(v * width + u) as usize], expected, "{x} {y}");
        }
    }

    #[test]
    fn the_plate_is_closed_and_as_thick_as_the_board() {
        let mesh = solid([0.2, 0.1], 0.005);
        let corner = |vertex: usize| mesh.vertices[vertex].coords;
        let of = |&[[a, _], [b, _], [c, _]]: &[[usize; 2]; 3]| corner(a).dot(&corner(b).cross(&corner(c))) / 6.0;
        assert!((mesh.triangles.iter().map(of).sum::<f64>() - 0.4 * 0.2 * 0.005).abs() < 1e-15);
        let text = mesh.obj(Some(Material { file: "a.mtl", name: "b" }));
        assert!(
            text.contains("mtllib a.mtl\nv -0.2 -0.1 0.0\n") && text.contains("usemtl b\nf 1/1 2/2 3/3\n"),
            "{text}"
        );
    }
}
