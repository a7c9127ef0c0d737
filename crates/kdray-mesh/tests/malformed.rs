//! Every awkward file of the shared collection does what its README says.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use kdray_mesh::load;

/// What must become of a file.
enum Expect {
    /// Refused, with a message that has all of these in it.
    Refused(&'static [&'static str]),
    /// Loaded, with so many vertices and triangles.
    Loaded(usize, usize),
}

use Expect::{Loaded, Refused};

const FILES: &[(&str, Expect)] = &[
    ("glb_truncated_chunk_data.glb", Refused(&["byte 8", "48 bytes are announced, 47 are here"])),
    ("gltf_index_buffer_degenerate_triangle.gltf", Loaded(3, 3)),
    ("gltf_index_buffer_oob.gltf", Refused(&["mesh 0, primitive 0", "index 5", "4 vertices"])),
    ("gltf_infinite_transform.gltf", Refused(&["line 8", "out of range"])),
    ("obj_concave_polygon.obj", Loaded(64, 64)),
    ("obj_face_not_enough_indices.obj", Loaded(3, 1)),
    ("obj_inconsistent_f.obj", Loaded(8, 12)),
    ("obj_index_out_of_range.obj", Refused(&["line 28, face 5", "index 0"])),
    ("obj_invalid_relative_index.obj", Refused(&["line 1, face 0", "index -4", "0 vertices"])),
    ("obj_line_continuation.obj", Loaded(8, 944)),
    ("obj_nan_color.obj", Loaded(8, 12)),
    ("obj_negative_indices.obj", Loaded(8, 12)),
    ("obj_number_formats.obj", Refused(&["line 11, vertex 7", "\"3.1+e2\" is not a number"])),
    ("obj_triangulation_failure.obj", Loaded(16, 28)),
    ("obj_zero_face_index.obj", Refused(&["line 16, face 0", "index 0", "counts from 1"])),
    ("off_huge_face_count.off", Refused(&["353535235358 vertices are announced"])),
    ("ply_binary_crlf_header.ply", Loaded(8, 12)),
    ("ply_fuzz_crash.ply", Refused(&["line 7"])),
    ("ply_header_only.ply", Refused(&["no vertex element"])),
    ("ply_issue623.ply", Refused(&["line 14, vertex 0", "too few values"])),
    ("stl_binary_starting_with_solid.stl", Loaded(682, 1360)),
    ("stl_binary_zero_tris.stl", Loaded(0, 0)),
    ("stl_empty.stl", Loaded(0, 0)),
    ("stl_empty_solid.stl", Loaded(3, 1)),
    ("zero_bytes.ply", Refused(&["the file is empty"])),
];

/// Files that only stand beside others.
const BUFFERS: &[&str] =
    &["index_buffer_degenerate_triangle.bin", "index_buffer_oob.bin", "README.md"];

/// The shared meshes; without them a test has nothing to test, which is an error in CI.
fn shared(folder: &str) -> Option<PathBuf> {
    let path =
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/meshes")).join(folder);
    if path.is_dir() {
        return Some(path);
    }
    assert!(std::env::var_os("CI").is_none(), "{} is not there", path.display());
    eprintln!("not tested: {} is not there", path.display());
    None
}

#[test]
fn every_file_does_what_the_readme_says() {
    let Some(folder) = shared("malformed") else {
        return;
    };
    let mut faults = Vec::new();
    for (name, expect) in FILES {
        let result = load(folder.join(name));
        match (result, expect) {
            (Ok(mesh), Loaded(vertices, triangles)) => {
                let found = (mesh.positions.len(), mesh.triangles.len());
                if found != (*vertices, *triangles) {
                    faults.push(format!("{name}: loaded with {found:?}"));
                }
            }
            (Err(error), Refused(parts)) => {
                let message = error.to_string();
                if !message.contains(name) || !parts.iter().all(|part| message.contains(part)) {
                    faults.push(message);
                }
            }
            (Ok(_), Refused(_)) => faults.push(format!("{name}: loaded, but should be refused")),
            (Err(error), Loaded(..)) => faults.push(error.to_string()),
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn no_file_is_forgotten() {
    let Some(folder) = shared("malformed") else {
        return;
    };
    let entries = folder.read_dir().expect("a readable folder");
    let there: BTreeSet<String> = entries
        .map(|entry| entry.expect("a readable entry").file_name().to_string_lossy().into_owned())
        .collect();
    let known = FILES.iter().map(|(name, _)| *name).chain(BUFFERS.iter().copied());
    assert_eq!(there, known.map(String::from).collect());
}

#[test]
fn the_real_meshes_have_the_triangles_their_readme_says() {
    let Some(folder) = shared("") else { return };
    for (name, triangles) in [
        ("bunny.ply", 69_451),
        ("conference.ply", 331_179),
        ("dragon.ply", 871_414),
        ("gears.ply", 19_426),
        ("teapot.ply", 6_320),
    ] {
        let mesh = load(folder.join(name)).expect(name);
        assert_eq!(mesh.triangles.len(), triangles, "{name}");
        assert!(mesh.notes.is_empty(), "{name}: {:?}", mesh.notes);
    }
}
