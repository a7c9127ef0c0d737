// The first plane with the lowest price: of equals the lowest axis, then the lowest position.
//
// Twin: `choose.rs`. Indices are inverted, so that the first is the greatest. Chunks in which no plane
// is as cheap are passed over.

//#import sweep

struct Best {
    price: u32,
    index: atomic<u32>,
    left_index: atomic<u32>,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> references: References;
@group(0) @binding(2) var<storage> nodes: array<Node>;
@group(0) @binding(3) var<storage> events: array<Event>;
@group(0) @binding(4) var<storage> sums: array<u32>;
@group(0) @binding(5) var<storage> inner: array<u32>;
@group(0) @binding(6) var<storage> lows: array<u32>;
@group(0) @binding(7) var<storage, read_write> best: array<Best>;

@compute @workgroup_size(256)
fn choose(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let chunks = chunks_of(params.events);
    let lane = index / chunks;
    let axis = params.base_axis + lane;
    let chunk = index % chunks;
    let end = min((chunk + 1u) * CHUNK, 2u * references.count);
    var left = sums[index] - lane * references.count;
    var place = chunk * CHUNK;
    for (var passed = 0u; passed < CHUNK && place < end; passed++) {
        let slot = references.list[place / 2u].slot;
        let node = swept(slot, axis, end);
        let lowest = best[slot].price;
        if node.is_open && lowest > 0u && lowest <= lows[index] {
            var found = vec2u(0u);
            for (; place < node.end; place++) {
                let event = events[lane * params.events + place];
                if price_at(node, event, place, left) == lowest {
                    let index = ~((axis << AXIS_SHIFT) | place);
                    let is_flat_left = (event.what & 3u) >= LEAVE;
                    found = max(found, vec2u(index, select(0u, index, is_flat_left)));
                }
                left += event.what & 1u;
            }
            keep(slot, found);
        }
        place = node.end;
        left = node.first + node.count;
    }
}

fn keep(slot: u32, found: vec2u) {
    if found.x > 0u {
        atomicMax(&best[slot].index, found.x);
    }
    if found.y > 0u {
        atomicMax(&best[slot].left_index, found.y);
    }
}
