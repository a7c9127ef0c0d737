// The place of each inner node's children among those of the level.
//
// Twin: `pair.rs`.

//#import level

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> nodes: array<Node>;
@group(0) @binding(2) var<storage> inner: array<u32>;
@group(0) @binding(3) var<storage, read_write> plans: array<Plan>;
@group(0) @binding(4) var<storage, read_write> pairs: array<Pair>;

@compute @workgroup_size(256)
fn pair(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    if (plans[index].what & 3u) == LEAF {
        return;
    }
    let place = inner[index];
    plans[index].place = place;
    pairs[place].first = nodes[index].first;
    pairs[place].count = nodes[index].count;
}
