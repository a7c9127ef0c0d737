// Nodes and leaf references in depth-first order: the finished tree.
//
// Twin: `pack.rs`. A team a record.

//#import team

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> records: array<vec2u>;
@group(0) @binding(2) var<storage> extents: array<vec2u>;
@group(0) @binding(3) var<storage> finished: array<u32>;
@group(0) @binding(4) var<storage, read_write> tree_nodes: array<vec2u>;
@group(0) @binding(5) var<storage, read_write> tree_references: array<u32>;

@compute @workgroup_size(TEAM)
fn pack(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = team(group, groups);
    if index >= params.count {
        return;
    }
    let record = records[index];
    let before = extents[index];
    if record.y == NONE {
        pack_piece(record.x, before, local);
        return;
    }
    var node = record;
    if (record.y & 3u) == LEAF {
        node.x = before.y;
        copy_references(record.x, record.y >> 2u, before.y, local);
    } else {
        node.y = (extents[(record.y >> 2u) + 1u].x << 2u) | (record.y & 3u);
    }
    if local == 0u {
        tree_nodes[before.x] = node;
    }
}

// A subtree's nodes name each other and their references as if it were the whole tree.
fn pack_piece(piece: u32, before: vec2u, local: u32) {
    let nodes = finished[piece];
    for (var index = local; index < nodes; index += TEAM) {
        var node = vec2u(finished[piece + 2u + 2u * index], finished[piece + 3u + 2u * index]);
        if (node.y & 3u) == LEAF {
            node.x += before.y;
        } else {
            node.y += before.x << 2u;
        }
        tree_nodes[before.x + index] = node;
    }
    copy_references(piece + 2u + 2u * nodes, finished[piece + 1u], before.y, local);
}

fn copy_references(start: u32, count: u32, to: u32, local: u32) {
    for (var index = local; index < count; index += TEAM) {
        tree_references[to + index] = finished[start + index];
    }
}
