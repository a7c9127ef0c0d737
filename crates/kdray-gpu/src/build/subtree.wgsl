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

var<workgroup> part_lower: array<array<u32, 3>, ROOM>;
var<workgroup> part_upper: array<array<u32, 3>, ROOM>;
var<workgroup> part_triangle: array<u32, ROOM>;
var<workgroup> current: Task;
var<workgroup> waiting: array<Task, WAITING>;
var<workgroup> waiting_count: u32;
var<workgroup> piece: Piece;
var<workgroup> state: u32;

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
fn put_node(task: Task, node: vec2u) -> u32 {
    let place = piece.nodes;
    if place == most_nodes(piece.room) {
        return NONE;
    }
    let word = piece.start + 2u + 2u * place;
    pieces[word] = node.x;
    pieces[word + 1u] = node.y;
    if task.parent != NONE {
        pieces[piece.start + 3u + 2u * task.parent] |= place << 2u;
    }
    piece.nodes++;
    return place;
}
