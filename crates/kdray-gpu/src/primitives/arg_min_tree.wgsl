// Least values: of blocks, of blocks of those, and of any range by both.
//
// Kernels say what `value_of` an index is, and bind `blocks`: the indices of the least values of 32
// values each, of 32 of those, and so on.

const BLOCK = 32u;
const NONE = 0xffffffffu;

// A value and its index. Of equal values the first is the least.
fn key_of(i: u32) -> vec4u {
    return vec4u(value_of(i), i);
}

fn lesser(a: vec4u, b: vec4u) -> vec4u {
    let less = a < b;
    let differ = a != b;
    let last = select(less.w, less.z, differ.z);
    let is_less = select(select(last, less.y, differ.y), less.x, differ.x);
    return select(b, a, is_less);
}

// The least of `best` and the entries `start` to `end` of a level, which starts at `base`; level 0
// are the values themselves.
fn least_of(best: vec4u, level: u32, base: u32, start: u32, end: u32) -> vec4u {
    var least = best;
    for (var i = start; i < end; i++) {
        var index = i;
        if level != 0u {
            index = blocks[base + i];
        }
        least = lesser(key_of(index), least);
    }
    return least;
}
