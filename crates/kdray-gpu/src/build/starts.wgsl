// How many references enter the left side in each chunk of events.
//
// Twin: `starts.rs`.

//#import level

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> references: References;
@group(0) @binding(2) var<storage> events: array<Event>;
@group(0) @binding(3) var<storage, read_write> sums: array<u32>;

@compute @workgroup_size(256)
fn starts(
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
    let end = min((chunk + 1u) * CHUNK, 2u * references.count);
    var sum = 0u;
    for (var place = chunk * CHUNK; place < end; place++) {
        sum += events[axis * params.events + place].what & 1u;
    }
    sums[index] = sum;
}
