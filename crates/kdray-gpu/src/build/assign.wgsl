// How many references of each chunk go which way.
//
// Twin: `assign.rs`.

//#import route

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> references: References;
@group(0) @binding(2) var<storage> plans: array<Plan>;
@group(0) @binding(3) var<storage> marks: array<u32>;
@group(0) @binding(4) var<storage, read_write> sums: array<u32>;

@compute @workgroup_size(256)
fn assign(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let chunks = reference_chunks();
    let end = min((index + 1u) * CHUNK, references.count);
    var counts = array<u32, WAYS>();
    for (var place = index * CHUNK; place < end; place++) {
        let way = route(plans[references.list[place].slot].what, marks[place]);
        counts[way]++;
    }
    for (var way = 0u; way < WAYS; way++) {
        sums[way * chunks + index] = counts[way];
    }
    if index == 0u {
        sums[WAYS * chunks] = 0u;
    }
}
