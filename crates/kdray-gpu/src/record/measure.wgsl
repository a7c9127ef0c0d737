// Make the grids of a count: one for an element an invocation, one for a tile a workgroup.
//
// Twin: `grid` in `count.rs`.

//#import count

const ROW = 65535u;

@group(0) @binding(0) var<uniform> params: Count;
@group(0) @binding(1) var<storage> counter: array<u32>;
@group(0) @binding(2) var<storage, read_write> grids: array<vec4u, 2>;

@compute @workgroup_size(256)
fn measure(@builtin(local_invocation_index) invocation: u32) {
    if invocation < 2u {
        let per_group = select(WORKGROUP, TILE, invocation == 1u);
        grids[invocation] = vec4u(grid(div_ceil(element_count(params), per_group)), 0u);
    }
}

// Rows of workgroups, at least `groups` in all.
fn grid(groups: u32) -> vec3u {
    return vec3u(min(groups, ROW), div_ceil(groups, ROW), min(groups, 1u));
}
