//! The vertices of meshes that faces use, which is all that their convex hull needs.
//!
//! | file | module | what is read |
//! |---|---|---|
//! | STL, binary and ASCII | `stl` | the corners of the triangles |
//! | Wavefront OBJ | `obj` | the `v` lines that `f` lines use |
//! | COLLADA (DAE) | `collada` | the positions of every geometry instance in the scene, in m |

mod collada;
mod obj;
mod stl;

use std::path::Path;

use nalgebra::Point3;
use thiserror::Error;

use super::disk::{DiskError, bytes};

/// Why a mesh has no vertices.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum MeshError {
    /// The file could not be read.
    #[error(transparent)]
    Disk(#[from] DiskError),
    /// The extension is of no format that is read.
    #[error("the extension is \"{found}\"; supported are STL, OBJ and DAE")]
    Extension {
        /// The extension.
        found: String,
    },
    /// The contents are wrong.
    #[error("line {line}: {message}")]
    Text {
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        message: String,
    },
    /// A binary STL has not as many bytes as its triangles take.
    #[error("{triangles} triangles take {} bytes, but the file has {bytes}", stl::size(*triangles))]
    Size {
        /// Triangles that the header states.
        triangles: u32,
        /// Bytes of the file.
        bytes: usize,
    },
    /// A coordinate is not finite.
    #[error("vertex {vertex} is not finite")]
    NotFinite {
        /// Number of the vertex, from 1.
        vertex: usize,
    },
    /// In place of the mesh there is a pointer to where Git keeps it.
    #[error("this is a Git LFS pointer, not the mesh itself; fetch the mesh with `git lfs pull`")]
    LfsPointer,
    /// The vertices span no solid.
    #[error("the mesh has {vertices} different vertices; a solid needs at least 4")]
    Flat {
        /// How many there are.
        vertices: usize,
    },
}

impl MeshError {
    fn at(line: usize, message: impl Into<String>) -> Self {
        Self::Text { line, message: message.into() }
    }
}

/// The different vertices of the mesh at `path`, in m.
///
/// ```no_run
/// use std::path::Path;
///
/// let vertices = calipose::formats::read_mesh(Path::new("meshes/forearm.stl"))?;
/// # Ok::<(), calipose::formats::MeshError>(())
/// ```
///
/// # Errors
/// When the file cannot be read, is of an unknown format, or has too few vertices.
pub fn read_mesh(path: &Path) -> Result<Vec<Point3<f64>>, MeshError> {
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let contents = || match bytes(path) {
        Ok(contents) if contents.starts_with(b"version https://git-lfs.github.com/spec/") => Err(MeshError::LfsPointer),
        contents => Ok(contents?),
    };
    let mut points = match extension.as_str() {
        "stl" => stl::vertices(&contents()?)?,
        "obj" => obj::vertices(&contents()?)?,
        "dae" => collada::vertices(&contents()?)?,
        _ => return Err(MeshError::Extension { found: extension }),
    };
    if let Some(i) = points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
        return Err(MeshError::NotFinite { vertex: i + 1 });
    }
    points.sort_unstable_by(|a, b| a.iter().partial_cmp(b.iter()).unwrap_or(std::cmp::Ordering::Equal));
    points.dedup();
    if points.len() < 4 { Err(MeshError::Flat { vertices: points.len() }) } else { Ok(points) }
}

/// The text of a file; bytes that belong to no character, as in comments of old exporters, are replaced.
fn text(bytes: &[u8]) -> std::borrow::Cow<'_, str> {
    String::from_utf8_lossy(bytes)
}

/// Three numbers from `words`.
fn point<'w>(words: impl Iterator<Item = &'w str>, line: usize) -> Result<Point3<f64>, MeshError> {
    let mut point = Point3::origin();
    let mut words = words;
    for x in &mut point.coords {
        let word = words.next().ok_or_else(|| MeshError::at(line, "a vertex has three coordinates"))?;
        *x = word.parse().map_err(|_| MeshError::at(line, format!("\"{word}\" is not a number")))?;
    }
    Ok(point)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(name: &str, contents: &[u8]) -> Result<Vec<Point3<f64>>, MeshError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, contents).unwrap();
        read_mesh(&path)
    }

    /// Corners of a tetrahedron, sorted.
    fn tetrahedron() -> Vec<Point3<f64>> {
        [[0.0, 0.0, 0.0], [0.0, 0.0, 4.0], [0.0, 2.0, 0.0], [1.0, 0.0, 0.0]].map(Point3::from).to_vec()
    }

    const FACES: [[usize; 3]; 4] = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]];

    #[test]
    fn one_tetrahedron_in_every_format() {
        let corners = tetrahedron();
        let mut ascii = String::from("solid tetrahedron\n");
        let mut binary = b"solid, but binary".to_vec();
        binary.resize(80, 0);
        binary.extend(4u32.to_le_bytes());
        let mut obj = String::from("# caf\u{e9}\no solid\n");
        for p in &corners {
            obj += &format!("v {} {} {} 1.0\nvn 0 0 1\n", p.x, p.y, p.z);
        }
        for face in FACES {
            ascii += "facet normal 0 0 0\n outer loop\n";
            binary.extend([0; 12]);
            for p in face.map(|i| corners[i]) {
                ascii += &format!("  vertex {} {} {:e}\n", p.x, p.y, p.z);
                binary.extend(p.iter().flat_map(|&x| (x as f32).to_le_bytes()));
            }
            ascii += " endloop\nendfacet\n";
            binary.extend([0; 2]);
            obj += &format!("f {}/1/1 {}/1/1 {}/1/1\n", face[0] + 1, face[1] + 1, face[2] + 1);
        }
        ascii += "endsolid\n";
        obj += "v 9 9 9\nf -5 -4 2\n";
        assert_eq!(read("a.STL", ascii.as_bytes()).unwrap(), corners);
        assert_eq!(read("capitals.stl", ascii.to_ascii_uppercase().as_bytes()).unwrap(), corners);
        assert_eq!(read("b.stl", &binary).unwrap(), corners);
        assert_eq!(read("c.obj", obj.as_bytes()).unwrap(), corners);
    }

    #[test]
    fn colladas_are_placed_by_their_scene_and_unit() {
        // In cm, with x and y exchanged by the node's matrix, instanced once more 10 cm higher.
        let dae = r##"<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"><asset><unit meter="0.01"/></asset>
            <library_geometries><geometry id="g"><mesh>
              <source id="p"><float_array id="pa" count="15">0 0 0 200 0 0 0 100 0 0 0 400 7 7 7</float_array>
                <technique_common><accessor source="#pa" count="5" stride="3"/></technique_common></source>
              <source id="n"><float_array id="na" count="3">9 9 9</float_array></source>
              <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
              <triangles count="4"><input semantic="NORMAL" source="#n" offset="0"/>
                <input semantic="VERTEX" source="#v" offset="1"/>
                <p>0 0 0 1 0 2 0 0 0 1 0 3</p><p>0 0 0 2 0 3 0 1 0 2 0 3</p></triangles>
            </mesh></geometry></library_geometries>
            <library_visual_scenes><visual_scene id="s">
              <node><matrix>0 1 0 0 1 0 0 0 0 0 1 0 0 0 0 1</matrix><instance_geometry url="#g"/></node>
              <node><translate>0 0 1000</translate><node><rotate>0 0 1 90</rotate><scale>1 -1 1</scale>
                <instance_geometry url="#g"/></node></node>
            </visual_scene></library_visual_scenes>
            <scene><instance_visual_scene url="#s"/></scene></COLLADA>"##;
        let points = read("a.dae", dae.as_bytes()).unwrap();
        assert_eq!(points.len(), 8);
        let mut expected = tetrahedron();
        expected.extend(tetrahedron().iter().map(|p| Point3::new(p.x, p.y, p.z + 10.0)));
        for p in expected {
            assert!(points.iter().any(|q| (p - q).norm() < 1e-12), "{p} {points:?}");
        }
    }

    #[test]
    fn mistakes_are_named() {
        let fail = |name: &str, contents: &str| read(name, contents.as_bytes()).unwrap_err().to_string();
        let mut short = vec![0; 80];
        short.extend(7u32.to_le_bytes());
        let short = read("short.stl", &short).unwrap_err().to_string();
        insta::assert_snapshot!(
            [
                fail("a.ply", ""),
                fail("empty.stl", ""),
                fail("pointer.stl", "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n"),
                short,
                fail("word.stl", "solid\nvertex 1 2 x\n"),
                fail("two.obj", "v 1 2 3\nv 1 2\n"),
                fail("unknown.obj", "v 1 2 3\nf 1 2 3\n"),
                fail("nan.obj", "v 1 2 3\nv nan 1 2\nf 1 2 1"),
                fail("flat.obj", "v 0 0 0\nv 0 0 1\nv 0 0 1\nf 1 2 3\n"),
                fail("broken.dae", "<COLLADA>\n<a></COLLADA>"),
                fail("none.dae", "<COLLADA/>"),
                fail(
                    "word.dae",
                    "<COLLADA><library_geometries><geometry id='g'><mesh>\n<source id='p'><float_array>1 2 y</float_array></source>\
                     <vertices id='v'><input semantic='POSITION' source='#p'/></vertices><triangles>\
                     <input semantic='VERTEX' source='#v' offset='0'/><p>0 0 0</p></triangles></mesh></geometry></library_geometries></COLLADA>"
                ),
            ]
            .join("\n"),
            @r#"
        the extension is "ply"; supported are STL, OBJ and DAE
        the mesh has 0 different vertices; a solid needs at least 4
        this is a Git LFS pointer, not the mesh itself; fetch the mesh with `git lfs pull`
        7 triangles take 434 bytes, but the file has 84
        line 2: "x" is not a number
        line 2: a vertex has three coordinates
        line 2: there is no vertex "2" yet
        vertex 2 is not finite
        the mesh has 2 different vertices; a solid needs at least 4
        line 2: expected 'a' tag, not 'COLLADA'
        the mesh has 0 different vertices; a solid needs at least 4
        line 2: "y" is not a number
        "#
        );
    }
}
