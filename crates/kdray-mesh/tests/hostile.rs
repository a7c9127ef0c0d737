//! Damaged files and false claims: an error or a sound mesh, never a panic, never much memory.

mod support;

use kdray_mesh::{Format, Reason, generate, read};
use proptest::prelude::*;
use support::Polygons;

fn samples() -> Vec<(Format, Vec<u8>)> {
    let mesh = Polygons::of_triangles(&generate::sphere(0));
    vec![
        (Format::Ply, support::ply_ascii(&mesh)),
        (Format::Ply, support::ply_binary(&mesh, false)),
        (Format::Ply, support::ply_binary(&mesh, true)),
        (Format::Obj, support::obj(&mesh)),
        (Format::Off, support::off(&mesh)),
        (Format::Stl, support::stl_ascii(&mesh)),
        (Format::Stl, support::stl_binary(&mesh)),
        (Format::Gltf, support::gltf(&mesh)),
        (Format::Gltf, support::glb(&mesh)),
    ]
}

/// Reads, and checks what a loaded mesh promises.
fn assert_sound(bytes: &[u8], format: Format) {
    match read(bytes, format) {
        Ok(loaded) => {
            let vertices = loaded.positions.len() as u32;
            assert!(loaded.triangles.iter().flatten().all(|&index| index < vertices));
            // A triangle takes a byte at least; but glTF has zeros without bytes, within a limit.
            assert!(loaded.triangles.len() <= bytes.len() + 65_536);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    #[test]
    fn cut_and_changed_files_do_no_harm(
        cut in 0.0..1.2_f64,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..8),
    ) {
        for (format, mut bytes) in samples() {
            bytes.truncate((cut * bytes.len() as f64) as usize);
            for (at, value) in &changes {
                if !bytes.is_empty() {
                    *at.get_mut(&mut bytes) = *value;
                }
            }
            assert_sound(&bytes, format);
        }
    }

    #[test]
    fn digits_changed_in_text_do_no_harm(
        changes in prop::collection::vec((any::<prop::sample::Index>(), b'0'..=b'9'), 1..6),
    ) {
        for (format, mut bytes) in samples() {
            let digits: Vec<usize> =
                (0..bytes.len()).filter(|&at| bytes[at].is_ascii_digit()).collect();
            if digits.is_empty() {
                continue;
            }
            for (at, value) in &changes {
                bytes[*at.get(&digits)] = *value;
            }
            assert_sound(&bytes, format);
        }
    }

    #[test]
    fn any_bytes_do_no_harm(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        for format in [Format::Ply, Format::Obj, Format::Stl, Format::Off, Format::Gltf] {
            assert_sound(&bytes, format);
        }
    }
}

/// Files whose counts are far beyond their bytes.
fn false_claims() -> Vec<(Format, Vec<u8>)> {
    let ply = |format: &str, elements: &str| {
        format!("ply\nformat {format} 1.0\n{elements}end_header\n\x03\x03\x03\x03\x03\x03")
            .into_bytes()
    };
    let xyz = "property float x\nproperty float y\nproperty float z\n";
    let huge_vertices = format!("element vertex 4000000000000000000\n{xyz}");
    let huge_list =
        format!("element vertex 0\n{xyz}element face 1\nproperty list int int vertex_indices\n");
    let mut stl = vec![0; 80];
    stl.extend([255, 255, 255, 127, 0, 0]);
    let gltf = |accessor: &str| {
        format!(
            r#"{{"asset":{{"version":"2.0"}},"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
            "accessors":[{{{accessor},"componentType":5126,"type":"VEC3"}}],
            "bufferViews":[{{"buffer":0,"byteOffset":18446744073709551615,"byteLength":3}},
            {{"buffer":0,"byteLength":3,"byteStride":18446744073709551615}}],
            "buffers":[{{"byteLength":3,"uri":"data:,abc"}}]}}"#
        )
        .into_bytes()
    };
    vec![
        (Format::Ply, ply("ascii", &huge_vertices)),
        (Format::Ply, ply("binary_little_endian", &huge_vertices)),
        (Format::Ply, ply("binary_big_endian", &huge_list)),
        (Format::Ply, ply("ascii", &huge_list.replace("end_header", ""))),
        (Format::Off, b"OFF\n3 900000000000 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n".to_vec()),
        (Format::Off, b"OFF\n1 1 0\n0 0 0\n18446744073709551615 0\n".to_vec()),
        (Format::Stl, stl),
        (Format::Gltf, gltf(r#""count":18446744073709551615"#)),
        (Format::Gltf, gltf(r#""bufferView":0,"count":1"#)),
        (Format::Gltf, gltf(r#""bufferView":1,"count":3"#)),
        (Format::Gltf, b"glTF\x02\0\0\0\x14\0\0\0\xff\xff\xff\xffJSON".to_vec()),
    ]
}

#[test]
fn false_claims_are_refused_at_once() {
    for (format, bytes) in false_claims() {
        let text = bytes.escape_ascii().to_string();
        let error = read(&bytes, format).expect_err(&text);
        let is_clear = matches!(error.reason, Reason::Truncated(_) | Reason::Malformed(_));
        assert!(is_clear, "{error}\n{text}");
    }
}

#[test]
fn an_element_without_properties_takes_no_time() {
    let ply = b"ply\nformat binary_little_endian 1.0\nelement nothing 18000000000000000000\n\
        element vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    assert_eq!(read(ply, Format::Ply).expect("an empty mesh").positions.len(), 0);
}
