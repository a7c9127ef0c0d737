// Sum every tile. Twin: `reduce` in `scan.rs`.

//#import scan_tile

@group(0) @binding(0) var<uniform> params: Count;
@group(0) @binding(1) var<storage> counter: array<u32>;
@group(0) @binding(2) var<storage> values: array<u32>;
@group(0) @binding(3) var<storage, read_write> sums: array<u32>;

@compute @workgroup_size(256)
fn scan_reduce(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) invocation: u32,
) {
    let count = element_count(params);
    let tile = group_index(group, groups);
    let start = min(tile * TILE + invocation * CHUNK, count);
    share(sum_of(start, min(start + CHUNK, count)), invocation);
    if invocation == 0u && tile * TILE < count {
        sums[tile] = sum_of_blocks(CHUNK);
    }
}
