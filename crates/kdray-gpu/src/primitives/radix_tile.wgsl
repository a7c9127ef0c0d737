// Count the digits of the tile of a workgroup.
//
// As in `scan_tile.wgsl`, an invocation counts 16 neighbouring keys, and two steps through shared
// memory sum the chunks of 16 invocations, and those blocks; here with the counts of all 16 digits
// at once, two in a word: a tile has 4,096 keys, so 16 bits hold each.

//#import count

const DIGITS = 16u;
const CHUNK = 16u;

// 16 bits for each digit: digit 0 in the lower half of `low.x`, digit 15 in the upper of `high.w`.
struct Digits {
    low: vec4u,
    high: vec4u,
}

struct Params {
    count: Count,
    // Tiles of as many keys as there can be.
    tiles: u32,
    // The lowest bit of the digit.
    shift: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> counter: array<u32>;
@group(0) @binding(2) var<storage> keys: array<u32>;

const WORDS = 8u; // Of the counts of all digits.

var<workgroup> chunks: array<u32, WORDS * WORKGROUP>;
var<workgroup> blocks: array<u32, WORDS * CHUNK>;

fn digit_of(key: u32) -> u32 {
    return (key >> params.shift) & (DIGITS - 1u);
}

// One of a digit. Registers cannot be indexed, so all words are compared.
fn one(digit: u32) -> Digits {
    let bit = vec4u(1u << (digit % 2u * 16u));
    let word = vec4u(digit / 2u);
    let none = vec4u();
    return Digits(
        select(none, bit, word == vec4u(0u, 1u, 2u, 3u)),
        select(none, bit, word == vec4u(4u, 5u, 6u, 7u)),
    );
}

// How many there are of a digit.
fn number_of(digit: u32, counts: Digits) -> u32 {
    let word = vec4u(digit / 2u);
    let none = vec4u();
    let low = select(none, counts.low, word == vec4u(0u, 1u, 2u, 3u));
    let high = select(none, counts.high, word == vec4u(4u, 5u, 6u, 7u));
    let words = low | high;
    return ((words.x | words.y | words.z | words.w) >> (digit % 2u * 16u)) & 0xffffu;
}

fn add(a: Digits, b: Digits) -> Digits {
    return Digits(a.low + b.low, a.high + b.high);
}

fn count_digits(start: u32, end: u32) -> Digits {
    var counts = Digits();
    for (var i = start; i < end; i++) {
        counts = add(counts, one(digit_of(keys[i])));
    }
    return counts;
}

// Makes the counts of all invocations' chunks, and of all blocks, known to all.
fn share(chunk: Digits, invocation: u32) {
    for (var i = 0u; i < 4u; i++) {
        chunks[invocation * WORDS + i] = chunk.low[i];
        chunks[invocation * WORDS + 4u + i] = chunk.high[i];
    }
    workgroupBarrier();
    if invocation < WORDS * CHUNK {
        let first = invocation / WORDS * CHUNK * WORDS + invocation % WORDS;
        var block = 0u;
        for (var i = 0u; i < CHUNK; i++) {
            block += chunks[first + i * WORDS];
        }
        blocks[invocation] = block;
    }
    workgroupBarrier();
}

// The counts of a chunk.
fn digits_of(chunk: u32) -> Digits {
    let at = chunk * WORDS;
    return Digits(
        vec4u(chunks[at], chunks[at + 1u], chunks[at + 2u], chunks[at + 3u]),
        vec4u(chunks[at + 4u], chunks[at + 5u], chunks[at + 6u], chunks[at + 7u]),
    );
}
