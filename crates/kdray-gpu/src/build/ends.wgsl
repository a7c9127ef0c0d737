// The events of a node along an axis, by kind; what there is room for beyond them comes last.
//
// Twin: `ends.rs`.

//#import span

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> positions: array<u32>;
@group(0) @binding(2) var<storage> triangles: array<u32>;
@group(0) @binding(3) var<storage> bounds: array<Part>;
@group(0) @binding(4) var<storage> references: References;
@group(0) @binding(5) var<storage> sums: array<u32>;
@group(0) @binding(6) var<storage, read_write> keys: array<u32>;
@group(0) @binding(7) var<storage, read_write> values: array<u32>;

@compute @workgroup_size(256)
fn ends(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let all = references.count;
    if index >= all {
        put(2u * index, NONE, 0u);
        put(2u * index + 1u, NONE, 0u);
        return;
    }
    let span = span(index, params.axis);
    let before = sums[index];
    let flat_ones = sums[params.events / 2u];
    if span.x == span.y {
        put(all - flat_ones + before, span.x, (index << 2u) | ENTER);
        put(all + before, span.x, (index << 2u) | LEAVE);
    } else {
        put(index - before, span.y, (index << 2u) | END);
        put(all + flat_ones + index - before, span.x, (index << 2u) | START);
    }
}

fn put(place: u32, position: u32, what: u32) {
    keys[place] = position;
    values[place] = what;
}
