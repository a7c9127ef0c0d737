// Sum up the tile of a workgroup.
//
// An invocation sums 16 neighbouring values; two steps through shared memory sum the chunks of 16
// invocations, and those blocks. Few barriers, and no subgroups.

//#import count

const CHUNK = 16u;

var<workgroup> chunks: array<u32, WORKGROUP>;
var<workgroup> blocks: array<u32, CHUNK>;

// The sum of the values in a range of the tile.
fn sum_of(start: u32, end: u32) -> u32 {
    var sum = 0u;
    for (var i = start; i < end; i++) {
        sum += values[i];
    }
    return sum;
}

// Makes the sums of all invocations' chunks, and of all blocks, known to all.
fn share(chunk: u32, invocation: u32) {
    chunks[invocation] = chunk;
    workgroupBarrier();
    if invocation < CHUNK {
        var block = 0u;
        for (var i = 0u; i < CHUNK; i++) {
            block += chunks[invocation * CHUNK + i];
        }
        blocks[invocation] = block;
    }
    workgroupBarrier();
}

// The sum of the first `end` blocks.
fn sum_of_blocks(end: u32) -> u32 {
    var sum = 0u;
    for (var i = 0u; i < end; i++) {
        sum += blocks[i];
    }
    return sum;
}

// The sum of the chunks before an invocation's own, in its tile.
fn sum_before(invocation: u32) -> u32 {
    let block = invocation / CHUNK;
    var sum = sum_of_blocks(block);
    for (var i = block * CHUNK; i < invocation; i++) {
        sum += chunks[i];
    }
    return sum;
}
