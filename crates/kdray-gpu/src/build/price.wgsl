// The lowest price of each node's planes, and of each chunk's.
//
// Twin: `price.rs`. Prices are inverted, so that the lowest is the greatest.

//#import sweep

struct Best {
    price: atomic<u32>,
    index: u32,
    left_index: u32,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> references: References;
@group(0) @binding(2) var<storage> nodes: array<Node>;
@group(0) @binding(3) var<storage> events: array<Event>;
@group(0) @binding(4) var<storage> sums: array<u32>;
@group(0) @binding(5) var<storage> inner: array<u32>;
@group(0) @binding(6) var<storage, read_write> best: array<Best>;
@group(0) @binding(7) var<storage, read_write> lows: array<u32>;

@compute @workgroup_size(256)
fn price(
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
    var lowest_of_all = 0u;
    var place = chunk * CHUNK;
    for (var passed = 0u; passed < CHUNK && place < end; passed++) {
        let slot = references.list[place / 2u].slot;
        let node = swept(slot, axis, end);
        if node.is_open {
            var lowest = 0u;
            for (; place < node.end; place++) {
                let event = events[lane * params.events + place];
                lowest = max(lowest, price_at(node, event, place, left));
                left += event.what & 1u;
            }
            keep(slot, lowest);
            lowest_of_all = max(lowest_of_all, lowest);
        }
        place = node.end;
        left = node.first + node.count;
    }
    lows[index] = lowest_of_all;
}

fn keep(slot: u32, price: u32) {
    if price > 0u {
        atomicMax(&best[slot].price, price);
    }
}
