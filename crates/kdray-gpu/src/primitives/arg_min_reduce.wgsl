// Find the least value of every block. Twin, with `arg_min_query.wgsl`: `arg_min.rs`.

//#import count
//#import arg_min_tree
//#import arg_min_value

struct Params {
    count: Count, // of blocks
    level: u32, // of their entries
    below: u32, // where that level starts
    to: u32, // where the blocks' own starts
    width: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> counter: array<u32>;
@group(0) @binding(3) var<storage, read_write> blocks: array<u32>;

@compute @workgroup_size(256)
fn arg_min_reduce(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) invocation: u32,
) {
    let block = group_index(group, groups) * WORKGROUP + invocation;
    if block >= element_count(params.count) {
        return;
    }
    var entries = params.count;
    entries.per /= BLOCK;
    let end = min((block + 1u) * BLOCK, element_count(entries));
    let least = least_of(vec4u(NONE), params.level, params.below, block * BLOCK, end);
    blocks[params.to + block] = least.w;
}
