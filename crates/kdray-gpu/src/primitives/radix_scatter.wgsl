// Move every key, and its value, to its place among those of all digits. Twin: `scatter` in
// `radix.rs`.

//#import radix_tile

// Digit after digit, where the keys of each tile go: the scan of the counts.
@group(0) @binding(3) var<storage> places: array<u32>;
@group(0) @binding(4) var<storage> values: array<u32>;
@group(0) @binding(5) var<storage, read_write> sorted_keys: array<u32>;
@group(0) @binding(6) var<storage, read_write> sorted_values: array<u32>;

@compute @workgroup_size(256)
fn radix_scatter(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) invocation: u32,
) {
    let count = element_count(params.count);
    let tile = group_index(group, groups);
    let start = min(tile * TILE + invocation * CHUNK, count);
    let end = min(start + CHUNK, count);
    share(count_digits(start, end), invocation);
    // What a chunk has becomes what comes before it in its tile.
    if invocation < WORDS * CHUNK {
        let block = invocation / WORDS;
        let word = invocation % WORDS;
        var sum = 0u;
        for (var i = 0u; i < block; i++) {
            sum += blocks[i * WORDS + word];
        }
        for (var i = 0u; i < CHUNK; i++) {
            let at = (block * CHUNK + i) * WORDS + word;
            let count = chunks[at];
            chunks[at] = sum;
            sum += count;
        }
    }
    workgroupBarrier();
    var before = digits_of(invocation);
    for (var i = start; i < end; i++) {
        let key = keys[i];
        let digit = digit_of(key);
        let place = places[digit * params.tiles + tile] + number_of(digit, before);
        before = add(before, one(digit));
        sorted_keys[place] = key;
        sorted_values[place] = values[i];
    }
}
