// The room of a subtree that a team finishes, which depends on how many references its root has:
// how many nodes and references it has, the nodes, and the references.
//
// Twin: `piece.rs`.

//#import team

const PIECE = 12u; // Words for each reference of the root.

fn references_at(room: u32) -> u32 {
    return 8u * room;
}

fn most_nodes(room: u32) -> u32 {
    return 4u * room - 1u;
}

fn most_references(room: u32) -> u32 {
    return 4u * room;
}
