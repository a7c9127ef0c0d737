// Replace every value by the sum of those before it. Twin: `apply` in `scan.rs`.

//#import scan_tile

struct Params {
    count: Count,
    // Where in `total` the sum of all values goes, or NOWHERE.
    total_at: u32,
    // Whether `sums` has what comes before each tile; if not, there is one tile.
    has_sums: u32,
}

const NOWHERE = 0xffffffffu;

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> counter: array<u32>;
@group(0) @binding(2) var<storage> sums: array<u32>;
@group(0) @binding(3) var<storage, read_write> values: array<u32>;
@group(0) @binding(4) var<storage, read_write> total: array<u32>;

@compute @workgroup_size(256)
fn scan_apply(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) invocation: u32,
) {
    let count = element_count(params.count);
    let tile = group_index(group, groups);
    let start = min(tile * TILE + invocation * CHUNK, count);
    let end = min(start + CHUNK, count);
    share(sum_of(start, end), invocation);
    var before = sum_before(invocation);
    if params.has_sums != 0u {
        before += sums[tile];
    }
    for (var i = start; i < end; i++) {
        let value = values[i];
        values[i] = before;
        before += value;
    }
    if invocation == WORKGROUP - 1u && params.total_at != NOWHERE {
        total[params.total_at] = before;
    }
}
