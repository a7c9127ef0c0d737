// Moves the pieces to where they stay until the tree is packed.
//
// Twin: `stow.rs`.

//#import piece

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> nodes: array<Node>;
@group(0) @binding(2) var<storage> inner: array<u32>;
@group(0) @binding(3) var<storage> pieces: array<u32>;
@group(0) @binding(4) var<storage, read_write> plans: array<Plan>;
@group(0) @binding(5) var<storage, read_write> finished: array<u32>;

@compute @workgroup_size(TEAM)
fn stow(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let slot = team(group, groups);
    if slot >= params.count || plans[slot].what != FINISHED {
        return;
    }
    let start = PIECE * nodes[slot].first;
    let rank = params.nodes + slot;
    let to = params.finished + params.leaf + inner[rank] - inner[params.nodes];
    let words = 2u + 2u * pieces[start];
    for (var word = local; word < words; word += TEAM) {
        finished[to + word] = pieces[start + word];
    }
    let references = start + references_at(nodes[slot].count);
    for (var index = local; index < pieces[start + 1u]; index += TEAM) {
        finished[to + words + index] = pieces[references + index];
    }
    if local == 0u {
        plans[slot].place = to;
    }
}
