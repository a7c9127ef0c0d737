// Whole subtrees of nodes with few references, each by one team, depth first.
//
// Twin: `finish.rs`. A finished subtree is a piece of the tree, packed: see `Array::Finished`.

//#import offer
//#import advance

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> positions: array<u32>;
@group(0) @binding(2) var<storage> triangles: array<u32>;
@group(0) @binding(3) var<storage> references: References;
@group(0) @binding(4) var<storage> events: array<Event>;
@group(0) @binding(5) var<storage> nodes: array<Node>;
@group(0) @binding(6) var<storage, read_write> inner: array<u32>;
@group(0) @binding(7) var<storage, read_write> pieces: array<u32>;
@group(0) @binding(8) var<storage, read_write> moved: Moved;

// Words that all teams read and wrote.
struct Moved {
    read: atomic<u32>,
    written: atomic<u32>,
}

const PART_WORDS = 14u; // Its triangle, its node, and six events.
const CORNER_WORDS = 12u; // Vertices of a triangle and their coordinates.

var<private> words_read: u32;

@compute @workgroup_size(TEAM)
fn finish(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let slot = team(group, groups);
    if slot < params.count {
        begin(slot, local);
    }
    for (var step = 0u; step < 4u * SMALL; step++) {
        if local == 0u {
            state = stand;
        }
        if workgroupUniformLoad(&state) != BUSY {
            break;
        }
        let task = current;
        clear_masks(local);
        offers[local] = offer(task, local);
        workgroupBarrier();
        let plan = choice(task);
        let is_cut = plan.what != LEAF && (plan.what & EMPTY) == 0u;
        if plan.what == LEAF {
            put_references(task, local);
        } else if is_cut {
            route_parts(task, plan, local);
        }
        workgroupBarrier();
        if is_cut {
            clip_straddlers(task, plan, local);
        }
        workgroupBarrier();
        if is_cut {
            share_parts(task, local);
            words_read += 2u * CORNER_WORDS * size(mask(MASK_BOTH));
        }
        advance(task, plan, local);
    }
    if slot < params.count && local == 0u {
        end(slot);
    }
}

// Loads the parts of a node, if there are few and it may be cut.
fn begin(slot: u32, local: u32) {
    let node = nodes[slot];
    let lower = vec3u(node.lower[0], node.lower[1], node.lower[2]);
    let upper = vec3u(node.upper[0], node.upper[1], node.upper[2]);
    let prices = prices_of(lower, upper, 0u);
    if node.count > SMALL || !is_open(prices, node.count) {
        return;
    }
    for (var index = local; index < 2u * node.count; index += TEAM) {
        for (var axis = 0u; axis < 3u; axis++) {
            let event = events[axis * params.events + 2u * node.first + index];
            let part = (event.what >> 2u) - node.first;
            part_bounds[6u * part + 2u * axis + 1u - (event.what & 1u)] = event.position;
        }
    }
    for (var part = local; part < node.count; part += TEAM) {
        part_triangle[part] = references.list[node.first + part].triangle;
    }
    piece = Piece(PIECE * node.first, node.count, 0u, 0u);
    current = Task(lower, 0u, upper, node.count, NONE, params.depth_left);
    stand = BUSY;
    words_read = PART_WORDS * node.count;
}

// Says how large the piece is, and what it took.
fn end(slot: u32) {
    var words = 0u;
    var words_written = 2u * piece.nodes + piece.references;
    if stand == DONE && piece.nodes == 1u {
        words = NONE;
    } else if stand == DONE {
        words_written += 2u;
        words = words_written;
        pieces[piece.start] = piece.nodes;
        pieces[piece.start + 1u] = piece.references;
    }
    inner[params.nodes + slot] = words;
    if words_read > 0u {
        atomicAdd(&moved.read, words_read);
        atomicAdd(&moved.written, words_written);
    }
}
