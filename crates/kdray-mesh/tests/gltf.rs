//! glTF documents: transforms, modes, sparse and quantised accessors, and graphs that are not trees.

use kdray_mesh::{Format, Loaded, read};
use serde_json::{Value, json};

/// A document over a buffer that holds the corners of a unit square in z = 0 and some indices.
fn document(nodes: Value, primitives: Value, accessors: Value) -> Value {
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0_f32]];
    let floats = corners.iter().flat_map(|[x, y]| [*x, *y, 0.0]);
    let mut bytes: Vec<u8> = floats.flat_map(f32::to_le_bytes).collect();
    // At byte 48: 8-bit indices; at 56: 16-bit indices; at 64: one position for sparse accessors.
    bytes.extend([0, 1, 2, 3, 2, 1, 9, 9]);
    bytes.extend([0, 0, 1, 0, 2, 0, 3, 0]);
    bytes.extend([5.0, 6.0, 7.0_f32].iter().flat_map(|value| value.to_le_bytes()));
    let content: String = bytes.iter().map(|byte| format!("%{byte:02x}")).collect();
    json!({
        "asset": {"version": "2.0"},
        "nodes": nodes,
        "meshes": [{"primitives": primitives}],
        "accessors": accessors,
        "bufferViews": [{"buffer": 0, "byteLength": bytes.len()}],
        "buffers": [{"byteLength": bytes.len(), "uri": format!("data:,{content}")}],
    })
}

fn square() -> Value {
    json!({"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"})
}

fn indices(component: u32, offset: u32, count: u32) -> Value {
    json!({"bufferView": 0, "componentType": component, "byteOffset": offset, "count": count, "type": "SCALAR"})
}

fn load(document: &Value) -> Result<Loaded, String> {
    read(document.to_string().as_bytes(), Format::Gltf).map_err(|error| error.to_string())
}

/// A document of one primitive under the given nodes.
fn scene(nodes: Value) -> Value {
    document(nodes, json!([{"attributes": {"POSITION": 0}, "mode": 5}]), json!([square()]))
}

#[test]
fn every_mode_and_index_type() {
    for (mode, accessor, expected) in [
        (4, indices(5121, 48, 6), vec![[0, 1, 2], [3, 2, 1]]),
        (5, indices(5123, 56, 4), vec![[0, 1, 2], [1, 3, 2]]),
        (6, indices(5121, 48, 4), vec![[1, 2, 0], [2, 3, 0]]),
        (4, indices(5121, 48, 5), vec![[0, 1, 2]]),
        (1, indices(5121, 48, 4), vec![]),
    ] {
        let primitive = json!([{"attributes": {"POSITION": 0}, "mode": mode, "indices": 1}]);
        let loaded = load(&document(json!([]), primitive, json!([square(), accessor])));
        assert_eq!(loaded.expect("a sound document").triangles, expected, "mode {mode}");
    }
}

#[test]
fn transforms_nest_and_mirrors_turn_triangles() {
    let quarter = std::f64::consts::FRAC_1_SQRT_2;
    let nodes = json!([
        {"children": [1], "translation": [10.0, 0.0, 1e7], "rotation": [0.0, 0.0, quarter, quarter]},
        {"mesh": 0, "scale": [-2.0, 3.0, 1.0]},
    ]);
    let loaded = load(&scene(nodes)).expect("a sound document");
    // (1, 0) becomes (-2, 0), then turns to (0, -2); (0, 1) becomes (0, 3), then (-3, 0).
    let expected = [[10.0, 0.0, 1e7], [10.0, -2.0, 1e7], [7.0, 0.0, 1e7], [7.0, -2.0, 1e7]];
    for (found, expected) in loaded.positions.iter().flatten().zip(expected.as_flattened()) {
        assert!((found - expected).abs() < 1e-8, "{found} {expected}");
    }
    assert_eq!(loaded.triangles, [[0, 2, 1], [1, 2, 3]]);
    let matrix = json!([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [4, 5, 6, 1]]);
    let flat: Vec<&Value> =
        matrix.as_array().unwrap().iter().flat_map(|c| c.as_array().unwrap()).collect();
    let loaded = load(&scene(json!([{"mesh": 0, "matrix": flat}]))).expect("a sound document");
    assert_eq!(loaded.positions[3], [5.0, 6.0, 6.0]);
}

#[test]
fn only_the_default_scene_counts_and_instances_repeat() {
    let mut document = scene(json!([{"mesh": 0}, {"mesh": 0}, {"mesh": 0}]));
    assert_eq!(load(&document).expect("all roots").triangles.len(), 6);
    document["scenes"] = json!([{"nodes": [0, 1]}, {"nodes": [2]}]);
    assert_eq!(load(&document).expect("the first scene").triangles.len(), 4);
    document["scene"] = json!(1);
    assert_eq!(load(&document).expect("the second scene").triangles.len(), 2);
    document["scene"] = json!(2);
    assert!(load(&document).expect_err("no such scene").contains("scene 2"));
}

#[test]
fn primitives_share_the_vertices_of_one_accessor() {
    let primitive = json!({"attributes": {"POSITION": 0}, "mode": 5});
    let loaded = load(&document(json!([]), json!([primitive, primitive]), json!([square()])));
    assert_eq!(loaded.expect("a sound document").positions.len(), 4);
}

#[test]
fn sparse_and_quantised_accessors() {
    let sparse = json!({"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {
        "count": 1,
        "indices": {"bufferView": 0, "byteOffset": 49, "componentType": 5121},
        "values": {"bufferView": 0, "byteOffset": 64}}});
    let primitive = json!([{"attributes": {"POSITION": 0}}]);
    let loaded = load(&document(json!([]), primitive.clone(), json!([sparse])));
    let expected = [[0.0; 3], [5.0, 6.0, 7.0], [0.0; 3]];
    assert_eq!(loaded.expect("a sound document").positions, expected);
    let mut quantised = indices(5121, 51, 1);
    quantised["type"] = json!("VEC3");
    quantised["normalized"] = json!(true);
    let mut document = document(json!([]), primitive, json!([quantised]));
    document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let expected = [[3.0 / 255.0, 2.0 / 255.0, 1.0 / 255.0]];
    assert_eq!(load(&document).expect("a sound document").positions, expected);
}

#[test]
fn bad_graphs_and_needs_are_refused_with_a_reason() {
    let twice = json!([{"children": [1, 1]}, {"mesh": 0}]);
    let mut cycle = scene(json!([{"children": [1]}, {"children": [0]}]));
    cycle["scenes"] = json!([{"nodes": [0]}]);
    let mut draco = scene(json!([]));
    draco["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let mut old = scene(json!([]));
    old["asset"]["version"] = json!("1.0");
    for (document, reason) in [
        (scene(twice), "node 1"),
        (cycle, "node 0"),
        (draco, "KHR_draco_mesh_compression"),
        (old, "version 1.0"),
        (scene(json!([{"mesh": 7}])), "mesh 7"),
        (scene(json!([{"children": [9]}])), "node 9"),
        (scene(json!([{"mesh": 0, "rotation": [0, 0, 0, 0]}])), "node 0"),
    ] {
        let message = load(&document).expect_err(reason);
        assert!(message.contains(reason), "{message}");
    }
}
