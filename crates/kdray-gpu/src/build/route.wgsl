// Where a reference goes.
//
// Twin: `route.rs`. Whoever imports this has the parameters and the sums.

//#import level

// Ways to go; the order of the counts in the sums.
const WAY_BOTH = 0u;
const WAY_LEFT = 1u;
const WAY_RIGHT = 2u;
const WAY_LEAF = 3u;
const WAY_FINISHED = 4u;
const WAYS = 5u;

// Bounds that only touch the plane do not cross it.
fn route(what: u32, mark: u32) -> u32 {
    if what == LEAF {
        return WAY_LEAF;
    }
    if what == FINISHED {
        return WAY_FINISHED;
    }
    if mark == 0u {
        return select(WAY_LEFT, WAY_RIGHT, (what & FLAT_RIGHT) != 0u);
    }
    return select(mark, WAY_BOTH, mark == (LEFT | RIGHT));
}

fn reference_chunks() -> u32 {
    return chunks_of(params.events / 2u);
}

// How many references before a chunk go a way.
fn before(way: u32, chunk: u32) -> u32 {
    let first = way * reference_chunks();
    return sums[first + chunk] - sums[first];
}
