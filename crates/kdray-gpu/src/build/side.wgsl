// On which sides of its node's plane each reference has a part, by its bounds.
//
// Twin: `side.rs`.

//#import span

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> positions: array<u32>;
@group(0) @binding(2) var<storage> triangles: array<u32>;
@group(0) @binding(3) var<storage> bounds: array<Part>;
@group(0) @binding(4) var<storage> references: References;
@group(0) @binding(5) var<storage> plans: array<Plan>;
@group(0) @binding(6) var<storage, read_write> marks: array<u32>;

@compute @workgroup_size(256)
fn side(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count || index >= references.count {
        return;
    }
    let plan = plans[references.list[index].slot];
    if (plan.what & 3u) == LEAF {
        return;
    }
    let span = span(index, plan.what & 3u);
    let left = select(0u, LEFT, span.x < plan.position);
    marks[index] = left | select(0u, RIGHT, span.y > plan.position);
}
