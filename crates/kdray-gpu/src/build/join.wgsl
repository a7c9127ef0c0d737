// Events along an axis, from their sorted positions and what these stand for.
//
// Twin: `join.rs`.

//#import level

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> keys: array<u32>;
@group(0) @binding(2) var<storage> values: array<u32>;
@group(0) @binding(3) var<storage, read_write> events: array<Event>;

@compute @workgroup_size(256)
fn join(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let start = (params.axis - params.base_axis) * params.events;
    events[start + index] = Event(keys[index], values[index]);
}
