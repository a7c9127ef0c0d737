//! Frames from files, from raw positions, and from glTF animations, whose positions are compared with
//! ones that were worked out by hand.

use std::fs;
use std::path::PathBuf;

use kdray_mesh::Sequence;
use serde_json::{Value, json};
use tempfile::TempDir;

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.0.path().join(name);
        fs::write(&path, content).expect("the folder can be written");
        path
    }
}

const TRIANGLE: &str = "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

fn raw(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

fn error(paths: &[PathBuf]) -> String {
    let frames = Sequence::open(paths, 1.0).and_then(|sequence| {
        (0..sequence.frames()).map(|index| sequence.frame(index)).collect::<Result<Vec<_>, _>>()
    });
    frames.expect_err("it is wrong").to_string()
}

#[test]
fn a_mesh_a_frame() {
    let folder = Folder::new();
    let paths = [
        folder.write("0.off", TRIANGLE),
        folder.write("1.off", TRIANGLE.replace("1 0 0\n0", "2 0 0\n0")),
    ];
    let sequence = Sequence::open(&paths, 1.0).expect("two meshes");
    assert_eq!((sequence.frames(), sequence.triangles()), (2, 1));
    assert_eq!(sequence.frame(1).expect("a mesh").positions[1], [2.0, 0.0, 0.0]);
    let two = folder.write("2.off", "OFF 3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 2 1\n");
    let message = error(&[paths[0].clone(), two]);
    assert!(
        message.ends_with("2.off: frame 1: 2 triangles, but the first frame has 1"),
        "{message}"
    );
}

#[test]
fn a_mesh_with_raw_positions() {
    let folder = Folder::new();
    let base = folder.write("base.off", TRIANGLE);
    let numbers: Vec<f32> = (0..18).map(|number| number as f32).collect();
    let frames = folder.write("frames.f32", raw(&numbers));
    let sequence = Sequence::open(&[base.clone(), frames], 1.0).expect("two frames");
    assert_eq!(sequence.frames(), 2);
    let second = sequence.frame(1).expect("a frame");
    assert_eq!(second.positions, [[9.0, 10.0, 11.0], [12.0, 13.0, 14.0], [15.0, 16.0, 17.0]]);
    assert_eq!(second.triangles, [[0, 1, 2]]);
    let short = folder.write("short.f32", raw(&numbers[..17]));
    let message = error(&[base.clone(), short]);
    let expected = "68 bytes are no whole number of frames of 3 vertices, 36 bytes each";
    assert!(message.contains("short.f32: ") && message.contains(expected), "{message}");
    assert!(error(&[base.clone(), folder.write("none.f32", "")]).contains("empty"));
    assert!(error(&[base, PathBuf::from("nowhere.f32")]).starts_with("nowhere.f32: "));
    assert!(error(&[]).contains("empty"));
}

/// A document with a triangle, whose buffer has `numbers` behind the three corners, in f32.
fn document(numbers: &[f32], mut rest: Value) -> String {
    let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let bytes = raw(&[&corners, numbers].concat());
    let content: String = bytes.iter().map(|byte| format!("%{byte:02x}")).collect();
    rest["asset"] = json!({"version": "2.0"});
    rest["buffers"] = json!([{"byteLength": bytes.len(), "uri": format!("data:,{content}")}]);
    rest["bufferViews"] = json!([{"buffer": 0, "byteLength": bytes.len()}]);
    rest.to_string()
}

/// An accessor of f32 that starts at a number of the buffer.
fn floats(start: usize, count: usize, shape: &str) -> Value {
    json!({"bufferView": 0, "byteOffset": 4 * start, "componentType": 5126, "count": count, "type": shape})
}

/// The positions of all frames, at two a second.
fn frames(document: &str) -> Vec<Vec<[f64; 3]>> {
    let folder = Folder::new();
    let sequence = Sequence::open(&[folder.write("a.gltf", document)], 2.0).expect("it moves");
    (0..sequence.frames()).map(|index| sequence.frame(index).expect("a frame").positions).collect()
}

fn assert_close(found: &[[f64; 3]], expected: [[f64; 3]; 3]) {
    for (found, expected) in found.as_flattened().iter().zip(expected.as_flattened()) {
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
}

/// Key times 0 and 1, and a channel to a node with these values behind them.
fn moving(path: &str, interpolation: &str, values: &[f32], shape: &str) -> String {
    let width = if shape == "VEC3" { 3 } else { 4 };
    let numbers = [&[0.0, 1.0], values].concat();
    document(
        &numbers,
        json!({
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [floats(0, 3, "VEC3"), floats(9, 2, "SCALAR"), floats(11, values.len() / width, shape)],
            "animations": [{
                "channels": [{"sampler": 0, "target": {"node": 0, "path": path}}],
                "samplers": [{"input": 1, "output": 2, "interpolation": interpolation}],
            }],
        }),
    )
}

#[test]
fn nodes_move_by_every_interpolation() {
    let ends = [0.0, 0.0, 0.0, 4.0, 2.0, 0.0];
    let linear = frames(&moving("translation", "LINEAR", &ends, "VEC3"));
    assert_eq!(linear.len(), 3);
    assert_close(&linear[1], [[2.0, 1.0, 0.0], [3.0, 1.0, 0.0], [2.0, 2.0, 0.0]]);
    let step = frames(&moving("scale", "STEP", &[1.0, 1.0, 1.0, 2.0, 3.0, 1.0], "VEC3"));
    assert_close(&step[1], [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    assert_close(&step[2], [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0]]);
    // A quarter turn about z, half of it after half a second: 45 degrees.
    let quarter = std::f32::consts::FRAC_1_SQRT_2;
    let turn = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -quarter, -quarter];
    let turned = frames(&moving("rotation", "LINEAR", &turn, "VEC4"));
    let half = f64::from(quarter);
    assert_close(&turned[1], [[0.0; 3], [half, half, 0.0], [-half, half, 0.0]]);
    // In-tangent, value, out-tangent of 0, then of 1: 8 (t³ - 2t² + t) + 4 (3t² - 2t³) at a half.
    let cubic = [
        [[0.0; 3], [0.0; 3], [8.0, 0.0, 0.0]].concat(),
        [[0.0; 3], [4.0, 0.0, 0.0], [0.0; 3]].concat(),
    ];
    let cubic = frames(&moving("translation", "CUBICSPLINE", &cubic.concat(), "VEC3"));
    assert_close(&cubic[1], [[3.0, 0.0, 0.0], [4.0, 0.0, 0.0], [3.0, 1.0, 0.0]]);
}

#[test]
fn morph_targets_move_vertices() {
    // Key times, weights of two targets at both, the first target, the second target.
    let mut numbers = vec![0.0, 1.0, 0.0, 0.5, 1.0, 0.5];
    numbers.extend([0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    numbers.extend([0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0]);
    let document = document(
        &numbers,
        json!({
            "nodes": [{"mesh": 0, "translation": [10.0, 0.0, 0.0]}],
            "meshes": [{"primitives": [{
                "attributes": {"POSITION": 0}, "targets": [{"POSITION": 3}, {"POSITION": 4}],
            }]}],
            "accessors": [
                floats(0, 3, "VEC3"), floats(9, 2, "SCALAR"), floats(11, 4, "SCALAR"),
                floats(15, 3, "VEC3"), floats(24, 3, "VEC3"),
            ],
            "animations": [{
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}],
                "samplers": [{"input": 1, "output": 2}],
            }],
        }),
    );
    let frames = frames(&document);
    assert_close(&frames[0], [[10.0, 0.0, 0.0], [11.0, 2.0, 0.0], [10.0, 1.0, 0.0]]);
    assert_close(&frames[1], [[10.0, 0.0, 1.0], [11.0, 2.0, 0.0], [10.0, 1.0, 0.0]]);
    assert_close(&frames[2], [[10.0, 0.0, 2.0], [11.0, 2.0, 0.0], [10.0, 1.0, 0.0]]);
}

/// The first corner hangs on the arm, the second half and half, the third on the root. The arm is a
/// child of the root one to its right, and turns a quarter about z within a second.
fn skinned(joint: f32) -> String {
    let quarter = std::f32::consts::FRAC_1_SQRT_2;
    let mut numbers = vec![0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, quarter, quarter];
    numbers.extend([1.0, 0.0, 0.0, 0.0, 0.0, joint, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    numbers.extend([1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
    let bind =
        |x: f32| [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -x, 0.0, 0.0, 1.0];
    numbers.extend([bind(0.0), bind(1.0)].concat());
    document(
        &numbers,
        json!({
            "nodes": [
                {"mesh": 0, "skin": 0, "translation": [99.0, 99.0, 99.0]},
                {"children": [2], "translation": [0.0, 0.0, 5.0]},
                {"translation": [1.0, 0.0, 0.0]},
            ],
            "meshes": [{"primitives": [{
                "attributes": {"POSITION": 0, "JOINTS_0": 3, "WEIGHTS_0": 4},
            }]}],
            "skins": [{"joints": [1, 2], "inverseBindMatrices": 5}],
            "accessors": [
                floats(0, 3, "VEC3"), floats(9, 2, "SCALAR"), floats(11, 2, "VEC4"),
                floats(19, 3, "VEC4"), floats(31, 3, "VEC4"), floats(43, 2, "MAT4"),
            ],
            "animations": [{
                "channels": [{"sampler": 0, "target": {"node": 2, "path": "rotation"}}],
                "samplers": [{"input": 1, "output": 2}],
            }],
        }),
    )
}

#[test]
fn skins_follow_their_joints() {
    let frames = frames(&skinned(1.0));
    // At rest the joints are where they were bound, but for the root's own way.
    assert_close(&frames[0], [[0.0, 0.0, 5.0], [1.0, 0.0, 5.0], [0.0, 1.0, 5.0]]);
    // The arm turns about (1, 0): (0, 0) goes to (1, -1). The middle corner lies on its pivot.
    assert_close(&frames[2], [[1.0, -1.0, 5.0], [1.0, 0.0, 5.0], [0.0, 1.0, 5.0]]);
}

#[test]
fn animations_that_make_no_sense_are_refused() {
    let folder = Folder::new();
    let said = |document: &str| error(&[folder.write("bad.gltf", document)]);
    let still = document(&[], json!({"nodes": []}));
    assert!(said(&still).ends_with("animation 0: there is no such animation"), "{}", said(&still));
    let message = said(&skinned(7.0));
    assert!(message.contains("accessor 3: vertex 1 hangs on joint 7"), "{message}");
    let few = moving("translation", "LINEAR", &[0.0, 0.0, 0.0], "VEC3");
    assert!(said(&few).contains("not as many as its key times ask for"), "{}", said(&few));
    let path = moving("colour", "LINEAR", &[0.0; 6], "VEC3");
    assert!(said(&path).contains("\"colour\" is no path"), "{}", said(&path));
    let fast = Sequence::open(
        &[folder.write("fast.gltf", moving("scale", "STEP", &[1.0; 6], "VEC3"))],
        1e9,
    );
    assert!(fast.expect_err("too many frames").to_string().contains("frames a second make"));
}
