// How many events of each chunk keep their order in the left and in the right child.
//
// Twin: `tally.rs`.

//#import kept

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> events: array<Event>;
@group(0) @binding(2) var<storage> marks: array<u32>;
@group(0) @binding(3) var<storage, read_write> sums: array<u32>;

@compute @workgroup_size(256)
fn tally(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let chunks = chunks_of(params.events);
    let axis = index / chunks;
    let chunk = index % chunks;
    let end = min((chunk + 1u) * CHUNK, event_count());
    let counts = kept(axis, chunk * CHUNK, end);
    sums[2u * axis * chunks + chunk] = counts.x;
    sums[(2u * axis + 1u) * chunks + chunk] = counts.y;
}
