//! What is written in any format loads back as it was.

mod support;

use kdray_mesh::{Format, Loaded, generate, load, read};
use proptest::prelude::*;
use support::Polygons;

/// A way to write a mesh.
type Writer = fn(&Polygons) -> Vec<u8>;

/// Formats that keep indices, and can have polygons or not.
const INDEXED: [(&str, Format, bool, Writer); 7] = [
    ("ASCII PLY", Format::Ply, true, support::ply_ascii),
    ("little-endian PLY", Format::Ply, true, |mesh| support::ply_binary(mesh, false)),
    ("big-endian PLY", Format::Ply, true, |mesh| support::ply_binary(mesh, true)),
    ("OBJ", Format::Obj, true, support::obj),
    ("OFF", Format::Off, true, support::off),
    ("glTF", Format::Gltf, false, support::gltf),
    ("GLB", Format::Gltf, false, support::glb),
];

/// Formats that only know positions.
const LOOSE: [(&str, Writer); 2] =
    [("ASCII STL", support::stl_ascii), ("binary STL", support::stl_binary)];

fn corners(mesh: &Loaded) -> Vec<[[f64; 3]; 3]> {
    let corner = |index: u32| mesh.positions[index as usize];
    mesh.triangles.iter().map(|triangle| triangle.map(corner)).collect()
}

fn assert_round_trip(mesh: &Loaded) {
    let polygons = Polygons::of_triangles(mesh);
    for (name, format, _, write) in INDEXED {
        let bytes = write(&polygons);
        assert_eq!(&read(&bytes, format).expect(name), mesh, "{name}");
        assert_eq!(Format::sniff(&bytes), Some(format), "{name}");
    }
    for (name, write) in LOOSE {
        let bytes = write(&polygons);
        let loaded = read(&bytes, Format::Stl).expect(name);
        assert_eq!(corners(&loaded), corners(mesh), "{name}");
        assert!(loaded.positions.len() <= mesh.positions.len(), "{name}");
        assert_eq!(Format::sniff(&bytes), Some(Format::Stl), "{name}");
    }
}

#[test]
fn generated_meshes_survive_every_format() {
    for mesh in [
        generate::cube(),
        generate::sphere(2),
        generate::torus_knot([2, 3], 30, 5),
        generate::grid(4),
        generate::soup(50, 1),
        generate::showcase(2_000),
    ] {
        assert_round_trip(&mesh);
    }
}

#[test]
fn a_closed_mesh_stays_welded_in_stl() {
    let sphere = generate::sphere(3);
    for (name, write) in LOOSE {
        let loaded = read(&write(&Polygons::of_triangles(&sphere)), Format::Stl).expect(name);
        assert_eq!(loaded.positions.len(), sphere.positions.len(), "{name}");
    }
}

#[test]
fn polygons_become_the_same_triangles_in_every_format() {
    let mesh = Polygons {
        positions: vec![
            [0.0, 0.0, 0.0],
            [4.0, 0.0, 0.0],
            [4.0, 4.0, 0.0],
            [2.0, 1.0, 0.0],
            [0.0, 4.0, 0.0],
            [2.0, 0.0, -3.0],
        ],
        faces: vec![vec![0, 1, 2, 3, 4], vec![0, 5, 1], vec![1, 5, 2, 3]],
    };
    let formats = INDEXED.iter().filter(|(_, _, has_polygons, _)| *has_polygons);
    let all: Vec<Loaded> =
        formats.map(|(name, format, _, write)| read(&write(&mesh), *format).expect(name)).collect();
    assert_eq!(all[0].triangles.len(), 6);
    assert!(all.iter().all(|loaded| loaded == &all[0]));
}

#[test]
fn a_gltf_file_finds_its_buffer_beside_it_only() {
    let folder = std::env::temp_dir().join(format!("kdray-mesh-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("my parts")).expect("a writable folder");
    let mesh = generate::sphere(1);
    let polygons = Polygons::of_triangles(&mesh);
    let buffer = support::gltf_buffer(&polygons);
    std::fs::write(folder.join("my parts/one.bin"), buffer).expect("a writable folder");
    let mut results = Vec::new();
    for uri in ["my%20parts/one.bin", "./../one.bin", "/etc/hosts", "http://a/b.bin", "none.bin"] {
        let path = folder.join("mesh.gltf");
        std::fs::write(&path, support::gltf_document(&polygons, uri)).expect("a writable folder");
        results.push(load(&path).map_err(|error| error.to_string()));
    }
    std::fs::remove_dir_all(&folder).expect("a writable folder");
    assert_eq!(results[0].as_ref(), Ok(&mesh));
    for (result, reason) in results[1..].iter().zip(["outside", "outside", "remote", "none.bin"]) {
        let message = result.as_ref().expect_err(reason);
        assert!(message.contains("mesh.gltf: buffer 0") && message.contains(reason), "{message}");
    }
}

#[test]
fn base64_data_uris_are_read() {
    // The corners (0, 0, 0), (1, 0, 0), (0, 2, 0).
    let uri =
        "data:application/gltf-buffer;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAEAAAAAA";
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":36}}],"buffers":[{{"byteLength":36,"uri":"{uri}"}}]}}"#
    );
    let loaded = read(json.as_bytes(), Format::Gltf).expect("a sound document");
    assert_eq!(loaded.positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..Default::default() })]

    /// Any finite single-precision positions, any triangles over them.
    #[test]
    fn random_meshes_survive_every_format(
        positions in prop::collection::vec(prop::array::uniform3(prop::num::f32::NORMAL), 1..20),
        corners in prop::collection::vec(prop::array::uniform3(0_u32..1000), 1..30),
    ) {
        let count = positions.len() as u32;
        let positions = positions.into_iter().map(|position| position.map(f64::from)).collect();
        let triangles = corners.into_iter().map(|triangle| triangle.map(|index| index % count));
        assert_round_trip(&Loaded { positions, triangles: triangles.collect(), notes: Vec::new() });
    }
}
