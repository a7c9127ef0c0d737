// What a team knows of the subtree that it works on.
//
// Twin: `subtree.rs`. Whoever imports this has the parameters and the pieces.

//#import piece
//#import prices

const SMALL = 64u; // References of a node whose subtree is finished at once, at most.
const ROOM = 256u; // Parts that there is room for.
const WAITING = 32u; // Right children that can wait.

// How the work stands.
const IDLE = 0u;
const BUSY = 1u;
const DONE = 2u;

// Beside a plane's axis: there is nothing on one side.
const EMPTY_LEFT = 8u;
const EMPTY_RIGHT = 16u;
const EMPTY = EMPTY_LEFT | EMPTY_RIGHT;

// A node: its parts from `first` on, the node whose right child it is, and the levels below it.
struct Task {
    lower: vec3u,
    first: u32,
    upper: vec3u,
    count: u32,
    parent: u32,
    depth: u32,
}

// Where the piece is, what its room depends on, and what it has so far.
struct Piece {
    start: u32,
    room: u32,
    nodes: u32,
    references: u32,
}

// By part and axis, where it starts and ends; behind the parts that there is room for, what was
// clipped, by straddler and side.
var<workgroup> part_bounds: array<u32, 6 * (ROOM + 2 * SMALL)>;
var<workgroup> part_triangle: array<u32, ROOM>;
// A word an invocation.
var<workgroup> waiting: array<u32, TEAM * WAITING>;
var<workgroup> state: u32;

// The same in all invocations of a team, which need not share it then.
var<private> current: Task;
var<private> waiting_count: u32;
var<private> piece: Piece;
var<private> stand: u32;
// Whether what was counted for the node before holds for this one: it has the same parts.
var<private> is_counted: bool;

// Where a part starts or ends, of those from `first` on: two ends each.
fn bound(first: u32, axis: u32, end: u32) -> u32 {
    return part_bounds[6u * (first + end / 2u) + 2u * axis + end % 2u];
}

// Lists the references of a leaf, if there is room.
fn put_references(task: Task, local: u32) {
    if piece.references + task.count > most_references(piece.room) {
        return;
    }
    let start = piece.start + references_at(piece.room) + piece.references;
    for (var index = local; index < task.count; index += TEAM) {
        pieces[start + index] = part_triangle[task.first + index];
    }
}

// Notes a node down, and gives its place; NONE if there is no room.
fn put_node(parent: u32, node: vec2u, local: u32) -> u32 {
    let place = piece.nodes;
    if place == most_nodes(piece.room) {
        return NONE;
    }
    if local == 0u {
        let word = piece.start + 2u + 2u * place;
        pieces[word] = node.x;
        pieces[word + 1u] = node.y;
        if parent != NONE {
            pieces[piece.start + 3u + 2u * parent] |= place << 2u;
        }
    }
    piece.nodes++;
    return place;
}

// Lets a right child wait: every invocation notes a word down.
fn park(task: Task, local: u32) {
    let rest = vec2u(task.parent, (task.depth << 20u) | (task.first << 10u) | task.count);
    let box = select(task.upper[local % 3u], task.lower[local % 3u], local < 3u);
    waiting[TEAM * waiting_count + local] = select(box, rest[local % 2u], local >= 6u);
    waiting_count++;
}

// The last that waits.
fn unpark() -> Task {
    waiting_count--;
    let at = TEAM * waiting_count;
    let lower = vec3u(waiting[at], waiting[at + 1u], waiting[at + 2u]);
    let upper = vec3u(waiting[at + 3u], waiting[at + 4u], waiting[at + 5u]);
    let last = waiting[at + 7u];
    return Task(lower, (last >> 10u) & 0x3ffu, upper, last & 0x3ffu, waiting[at + 6u], last >> 20u);
}
