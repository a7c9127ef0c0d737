//! Small writers of every format, for tests only.

use std::fmt::Write;

/// A mesh of polygons to write.
#[derive(Debug, Clone)]
pub(crate) struct Polygons {
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) faces: Vec<Vec<u32>>,
}

impl Polygons {
    pub(crate) fn of_triangles(mesh: &kdray_mesh::Loaded) -> Self {
        let faces = mesh.triangles.iter().map(|triangle| triangle.to_vec()).collect();
        Self { positions: mesh.positions.clone(), faces }
    }

    fn corners(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.faces.iter().flatten().map(|&corner| self.positions[corner as usize])
    }
}

fn ply_header(mesh: &Polygons, format: &str, position: &str, index: &str) -> String {
    format!(
        "ply\nformat {format} 1.0\ncomment made by a test\nelement vertex {}\nproperty uchar red\n\
         property {position} z\nproperty {position} x\nproperty {position} y\nelement face {}\n\
         property list uchar float texcoord\nproperty list ushort {index} vertex_indices\n\
         element edge 0\nproperty int vertex1\nend_header\n",
        mesh.positions.len(),
        mesh.faces.len(),
    )
}

pub(crate) fn ply_ascii(mesh: &Polygons) -> Vec<u8> {
    let mut text = ply_header(mesh, "ascii", "float32", "int32").replace('\n', "\r\n");
    for [x, y, z] in &mesh.positions {
        writeln!(text, "255 {z} {x:e} {y}\r").unwrap();
    }
    for face in &mesh.faces {
        writeln!(text, "2 .5 1. {}{}", face.len(), spaced(face)).unwrap();
    }
    text.into_bytes()
}

fn spaced(face: &[u32]) -> String {
    face.iter().map(|corner| format!(" {corner}")).collect()
}

/// Binary PLY with single-precision positions, most significant byte first if `is_big`.
pub(crate) fn ply_binary(mesh: &Polygons, is_big: bool) -> Vec<u8> {
    let format = if is_big { "binary_big_endian" } else { "binary_little_endian" };
    let mut bytes = ply_header(mesh, format, "float", "uint").into_bytes();
    let mut put = |value: &[u8]| {
        let mut value = value.to_vec();
        if is_big {
            value.reverse();
        }
        bytes.extend(value);
    };
    for &[x, y, z] in &mesh.positions {
        put(&[7]);
        [z, x, y].iter().for_each(|&value| put(&(value as f32).to_le_bytes()));
    }
    for face in &mesh.faces {
        put(&[1]);
        put(&0.5_f32.to_le_bytes());
        put(&(face.len() as u16).to_le_bytes());
        face.iter().for_each(|corner| put(&corner.to_le_bytes()));
    }
    bytes
}

/// OBJ with all forms of a corner, relative indices, and joined lines.
pub(crate) fn obj(mesh: &Polygons) -> Vec<u8> {
    let mut text = String::from("# made by a test\nmtllib a.mtl\no thing\n");
    for [x, y, z] in &mesh.positions {
        writeln!(text, "v {x} {y} {z} 1 nan 0").unwrap();
    }
    text.push_str("vt 0 0\nvn 0 0 1\ng part # two\n");
    let count = mesh.positions.len() as i64;
    for (number, face) in mesh.faces.iter().enumerate() {
        text.push('f');
        for &corner in face {
            let (absolute, relative) = (i64::from(corner) + 1, i64::from(corner) - count);
            match number % 4 {
                0 => write!(text, " {absolute}"),
                1 => writeln!(text, " {absolute}/1 \\"),
                2 => write!(text, "\t{relative}//-1"),
                _ => write!(text, "  {absolute}/1/1"),
            }
            .unwrap();
        }
        text.push('\n');
    }
    text.into_bytes()
}

pub(crate) fn off(mesh: &Polygons) -> Vec<u8> {
    let mut text =
        format!("COFF # made by a test\n{} {} 0\n\n", mesh.positions.len(), mesh.faces.len());
    for [x, y, z] in &mesh.positions {
        writeln!(text, "{x} {y} {z} 255 0 0 255").unwrap();
    }
    for face in &mesh.faces {
        writeln!(text, "{}{} 0.5 0.5 0.5", face.len(), spaced(face)).unwrap();
    }
    text.into_bytes()
}

/// ASCII STL of triangles, in two solids.
pub(crate) fn stl_ascii(mesh: &Polygons) -> Vec<u8> {
    let mut text = String::from("solid first part\n");
    for (number, face) in mesh.faces.iter().enumerate() {
        if number == mesh.faces.len() / 2 {
            text.push_str("endsolid first part\nsolid\n");
        }
        text.push_str(" facet normal 0 0 nan\n  outer loop\n");
        for &corner in face {
            let [x, y, z] = mesh.positions[corner as usize];
            writeln!(text, "   vertex {x} {y} {z}").unwrap();
        }
        text.push_str("  endloop\n endfacet\n");
    }
    text.push_str("endsolid");
    text.into_bytes()
}

/// Binary STL of triangles, with a header that starts as an ASCII file does.
pub(crate) fn stl_binary(mesh: &Polygons) -> Vec<u8> {
    let mut bytes = b"solid made by a test".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((mesh.faces.len() as u32).to_le_bytes());
    for (number, corner) in mesh.corners().enumerate() {
        if number % 3 == 0 {
            bytes.extend([0; 12]);
        }
        bytes.extend(corner.iter().flat_map(|&value| (value as f32).to_le_bytes()));
        if number % 3 == 2 {
            bytes.extend([0; 2]);
        }
    }
    bytes
}

/// The binary buffer of a glTF document: single-precision positions, then 32-bit indices.
pub(crate) fn gltf_buffer(mesh: &Polygons) -> Vec<u8> {
    let positions = mesh.positions.iter().flatten();
    let indices = mesh.faces.iter().flatten();
    positions
        .flat_map(|&value| (value as f32).to_le_bytes())
        .chain(indices.flat_map(|index| index.to_le_bytes()))
        .collect()
}

/// The glTF document over that buffer, which `uri` names if it is not empty.
pub(crate) fn gltf_document(mesh: &Polygons, uri: &str) -> String {
    let (vertices, corners) = (mesh.positions.len(), 3 * mesh.faces.len());
    let (split, end) = (12 * vertices, 12 * vertices + 4 * corners);
    let uri = if uri.is_empty() { String::new() } else { format!(r#""uri":"{uri}","#) };
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[
          {{"bufferView":0,"componentType":5126,"count":{vertices},"type":"VEC3"}},
          {{"bufferView":1,"componentType":5125,"count":{corners},"type":"SCALAR"}}],
        "bufferViews":[
          {{"buffer":0,"byteLength":{split}}},
          {{"buffer":0,"byteOffset":{split},"byteLength":{}}}],
        "buffers":[{{{uri}"byteLength":{end}}}]}}"#,
        end - split
    )
}

/// glTF with its buffer in a data URI.
pub(crate) fn gltf(mesh: &Polygons) -> Vec<u8> {
    let content: String = gltf_buffer(mesh).iter().map(|byte| format!("%{byte:02x}")).collect();
    gltf_document(mesh, &format!("data:application/octet-stream,{content}")).into_bytes()
}

pub(crate) fn glb(mesh: &Polygons) -> Vec<u8> {
    let mut json = gltf_document(mesh, "").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut content = gltf_buffer(mesh);
    content.resize(content.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF\x02\0\0\0".to_vec();
    bytes.extend((28 + json.len() as u32 + content.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &json), (b"BIN\0", &content)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}
