// Find the least value of every segment. Twin, with `arg_min_reduce.wgsl`: `arg_min.rs`.
//
// Blocks that lie within the segment stand for their values, and blocks of blocks for those; so an
// invocation looks at 62 entries of a level at most, and at a few more on the last.

//#import count
//#import arg_min_tree
//#import arg_min_value

struct Params {
    count: Count, // of segments
    levels: u32,
    width: u32,
    unused: vec2u,
    starts: array<vec4u, 2>, // where the levels start
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> counter: array<u32>;
@group(0) @binding(3) var<storage> blocks: array<u32>;
@group(0) @binding(4) var<storage> offsets: array<u32>;
@group(0) @binding(5) var<storage, read_write> minima: array<u32>;

@compute @workgroup_size(256)
fn arg_min_query(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) invocation: u32,
) {
    let segment = group_index(group, groups) * WORKGROUP + invocation;
    if segment >= element_count(params.count) {
        return;
    }
    var start = offsets[segment];
    var end = offsets[segment + 1u];
    var least = vec4u(NONE);
    for (var level = 0u; level <= params.levels; level++) {
        let base = params.starts[level / 4u][level % 4u];
        if level == params.levels || end - start <= 2u * BLOCK {
            least = least_of(least, level, base, start, end);
            break;
        }
        let first = (start + BLOCK - 1u) / BLOCK;
        let last = end / BLOCK;
        least = least_of(least, level, base, start, first * BLOCK);
        least = least_of(least, level, base, last * BLOCK, end);
        start = first;
        end = last;
    }
    minima[segment] = least.w;
}
