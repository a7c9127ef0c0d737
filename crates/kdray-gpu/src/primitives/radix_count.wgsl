// Count the digits of every tile. Twin: `count` in `radix.rs`.

//#import radix_tile

// Digit after digit, the counts of all tiles.
@group(0) @binding(3) var<storage, read_write> counts: array<u32>;

@compute @workgroup_size(256)
fn radix_count(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) invocation: u32,
) {
    let count = element_count(params.count);
    let tile = group_index(group, groups);
    let start = min(tile * TILE + invocation * CHUNK, count);
    share(count_digits(start, min(start + CHUNK, count)), invocation);
    if invocation < DIGITS && tile < params.tiles {
        var sum = 0u;
        for (var block = 0u; block < CHUNK; block++) {
            sum += (blocks[block * WORDS + invocation / 2u] >> (invocation % 2u * 16u)) & 0xffffu;
        }
        counts[invocation * params.tiles + tile] = sum;
    }
}
