//! Where a ray crosses a triangle, as a list of steps in double precision.
//!
//! Drivers put every call of a function in line, and an f64 operation is a hundred instructions
//! there. So the shader has each of them once, and is told with its parameters which cells to use
//! them on: `cells.wgsl`. Step by step they are the operations of `locate` in kdray's
//! `trace/intersect.rs`.

pub(crate) const ADD: u32 = 0;
pub(crate) const SUB: u32 = 1;
pub(crate) const MUL: u32 = 2;
pub(crate) const DIV: u32 = 3;

// Cells of constants.
pub(crate) const ONE: u32 = 0;
pub(crate) const MINUS_ONE: u32 = 1;
// Of the ray: axes are in the order of ray space.
pub(crate) const DIRECTION: u32 = 2;
pub(crate) const ORIGIN: u32 = 5;
pub(crate) const T_PER_Z: u32 = 8;
pub(crate) const SHEAR: u32 = 9;
// Of the triangle: three a corner, two an end of an edge, and one an edge.
pub(crate) const CORNERS: u32 = 11;
pub(crate) const ENDS: u32 = 20;
pub(crate) const EDGES: u32 = 24;
// Of the point of an edge that is nearest to the ray.
pub(crate) const SHARE: u32 = 27;
pub(crate) const DISTANCE: u32 = 28;
pub(crate) const RESULT: u32 = 29;
const ALONG: [u32; 2] = [30, 31];
const SPARE: u32 = 32;
#[cfg(test)]
pub(crate) const CELLS: u32 = 33;

const P: [u32; 2] = [ENDS, ENDS + 1];
const Q: [u32; 2] = [ENDS + 2, ENDS + 3];
const A: [u32; 3] = [CORNERS, CORNERS + 1, CORNERS + 2];
const B: [u32; 3] = [CORNERS + 3, CORNERS + 4, CORNERS + 5];
const C: [u32; 3] = [CORNERS + 6, CORNERS + 7, CORNERS + 8];
const U: u32 = EDGES;
const V: u32 = EDGES + 1;
const W: u32 = EDGES + 2;

/// An operation, where its result goes, and its operands.
type Step = [u32; 4];

const STEPS: [Step; 56] = [
    // The shear of the ray.
    [DIV, T_PER_Z, ONE, DIRECTION + 2],
    [MUL, SHEAR, DIRECTION, T_PER_Z],
    [MUL, SHEAR + 1, DIRECTION + 1, T_PER_Z],
    // The corners in ray space.
    [SUB, A[0], A[0], ORIGIN],
    [SUB, A[1], A[1], ORIGIN + 1],
    [SUB, A[2], A[2], ORIGIN + 2],
    [MUL, SPARE, SHEAR, A[2]],
    [SUB, A[0], A[0], SPARE],
    [MUL, SPARE, SHEAR + 1, A[2]],
    [SUB, A[1], A[1], SPARE],
    [SUB, B[0], B[0], ORIGIN],
    [SUB, B[1], B[1], ORIGIN + 1],
    [SUB, B[2], B[2], ORIGIN + 2],
    [MUL, SPARE, SHEAR, B[2]],
    [SUB, B[0], B[0], SPARE],
    [MUL, SPARE, SHEAR + 1, B[2]],
    [SUB, B[1], B[1], SPARE],
    [SUB, C[0], C[0], ORIGIN],
    [SUB, C[1], C[1], ORIGIN + 1],
    [SUB, C[2], C[2], ORIGIN + 2],
    [MUL, SPARE, SHEAR, C[2]],
    [SUB, C[0], C[0], SPARE],
    [MUL, SPARE, SHEAR + 1, C[2]],
    [SUB, C[1], C[1], SPARE],
    // The edge function of the ends.
    [MUL, RESULT, P[0], Q[1]],
    [MUL, SPARE, P[1], Q[0]],
    [SUB, RESULT, RESULT, SPARE],
    // The weights of the second and third corner, in place of the edge functions, and their sum.
    [ADD, RESULT, U, V],
    [ADD, RESULT, RESULT, W],
    [DIV, V, V, RESULT],
    [DIV, W, W, RESULT],
    // The point of the edge that is nearest to the ray, as a share of the edge; its length last.
    [SUB, ALONG[0], Q[0], P[0]],
    [SUB, ALONG[1], Q[1], P[1]],
    [MUL, DISTANCE, ALONG[0], ALONG[0]],
    [MUL, SPARE, ALONG[1], ALONG[1]],
    [ADD, DISTANCE, DISTANCE, SPARE],
    [MUL, RESULT, P[0], ALONG[0]],
    [MUL, SPARE, P[1], ALONG[1]],
    [ADD, RESULT, RESULT, SPARE],
    [MUL, RESULT, RESULT, MINUS_ONE],
    [DIV, SHARE, RESULT, DISTANCE],
    // Its squared distance, and the rest of the edge.
    [MUL, ALONG[0], SHARE, ALONG[0]],
    [MUL, ALONG[1], SHARE, ALONG[1]],
    [ADD, ALONG[0], P[0], ALONG[0]],
    [ADD, ALONG[1], P[1], ALONG[1]],
    [MUL, DISTANCE, ALONG[0], ALONG[0]],
    [MUL, SPARE, ALONG[1], ALONG[1]],
    [ADD, DISTANCE, DISTANCE, SPARE],
    [SUB, RESULT, ONE, SHARE],
    // `t`, by the weights.
    [SUB, B[2], B[2], A[2]],
    [SUB, C[2], C[2], A[2]],
    [MUL, B[2], V, B[2]],
    [MUL, C[2], W, C[2]],
    [ADD, RESULT, B[2], C[2]],
    [ADD, RESULT, A[2], RESULT],
    [MUL, RESULT, RESULT, T_PER_Z],
];

// The parts of the list.
pub(crate) const SLOPES_END: u32 = 3;
pub(crate) const POINTS_END: u32 = SLOPES_END + 21;
pub(crate) const EDGE_END: u32 = POINTS_END + 3;
pub(crate) const WEIGHTS_END: u32 = EDGE_END + 4;
pub(crate) const NEAREST_END: u32 = WEIGHTS_END + 10;
pub(crate) const FOOT_END: u32 = NEAREST_END + 8;
pub(crate) const STEPS_END: u32 = FOOT_END + 7;

/// The steps in words, as the shader reads them.
pub(crate) const WORDS: [[u32; 4]; STEPS.len() / 4] = {
    let mut words = [[0; 4]; STEPS.len() / 4];
    let mut index = 0;
    while index < STEPS.len() {
        let [operation, to, one, other] = STEPS[index];
        words[index / 4][index % 4] = operation << 24 | to << 16 | one << 8 | other;
        index += 1;
    }
    words
};

const _: () =
    assert!(STEPS.len().is_multiple_of(4) && STEPS_END as usize == STEPS.len(), "all are told");
