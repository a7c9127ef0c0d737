//! Where a reference goes.

use super::arrays::{Array, Arrays};
use super::data::{FINISHED, FLAT_RIGHT, LEAF, Plan, Ranks};
use super::kernel::Params;
use super::mark::{LEFT, RIGHT};

/// Ways to go; the order of the counts in `Sums`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Route {
    Both = 0,
    Left = 1,
    Right = 2,
    Leaf = 3,
    Finished = 4,
}

/// How many ways there are.
pub(crate) const ROUTES: u32 = 5;

/// Bounds that only touch the plane do not cross it.
pub(crate) fn route(plan: &Plan, mark: u32) -> Route {
    match plan.what {
        LEAF => return Route::Leaf,
        FINISHED => return Route::Finished,
        _ => {}
    }
    match mark {
        LEFT => Route::Left,
        RIGHT => Route::Right,
        0 if plan.what & FLAT_RIGHT == 0 => Route::Left,
        0 => Route::Right,
        _ => Route::Both,
    }
}

/// References before a chunk, by way; the counts are scanned.
pub(crate) fn before(arrays: &Arrays, params: &Params, chunk: u32) -> [u32; ROUTES as usize] {
    let chunks = params.reference_chunks();
    [0, 1, 2, 3, 4].map(|way| {
        let at = |chunk: u32| arrays[Array::Sums][(way * chunks + chunk) as usize];
        at(chunk) - at(0)
    })
}

/// The counts of those that go on.
pub(crate) fn ranks([straddlers, left, right, ..]: [u32; ROUTES as usize]) -> Ranks {
    Ranks { straddlers, left, right }
}
