//! Visit the leaves along a ray from front to back, with a stack [PH04].

use std::mem::MaybeUninit;

use super::prepare::Slabs;
use crate::build::MAX_DEPTH;
use crate::geometry::Aabb;
use crate::tree::{Kind, Node};

/// A subtree to be visited, and the part of the ray inside it.
#[derive(Clone, Copy)]
struct Later {
    node: usize,
    t_min: f32,
    t_max: f32,
}

/// What a visitor wants after a leaf.
pub(super) enum Next {
    /// Go on up to this `t`.
    Until(f32),
    /// No more leaves.
    Stop,
}

/// Calls `leaf` for the leaves that the ray meets in `t_min..=t_max`, from front to back, with
/// their blocks, and `step` for every inner node.
///
/// Planes are as thick as [`Slabs`] says, so a ray near a plane visits both sides.
#[inline(always)]
pub(super) fn traverse(
    nodes: &[Node],
    bounds: &Aabb,
    slabs: &Slabs,
    [t_min, t_max]: [f32; 2],
    mut step: impl FnMut(),
    mut leaf: impl FnMut(usize, usize) -> Next,
) {
    let (mut t_min, mut t_max) = slabs.clip(bounds, t_min, t_max);
    if t_min > t_max {
        return;
    }
    let mut stack = [const { MaybeUninit::<Later>::uninit() }; MAX_DEPTH as usize + 1];
    let mut height = 0;
    let mut node = 0;
    loop {
        match nodes[node].kind() {
            Kind::Inner { axis, position, right } => {
                step();
                let t = (position - slabs.origin[axis]) * slabs.inverse[axis];
                let thickness = slabs.thickness[axis];
                let forward = slabs.inverse[axis] > 0.0;
                let (near, far) = if forward { (node + 1, right) } else { (right, node + 1) };
                if t_max < t - thickness {
                    node = near;
                } else if t_min > t + thickness {
                    node = far;
                } else {
                    let far = Later { node: far, t_min: t_min.max(t - thickness), t_max };
                    stack[height].write(far);
                    height += 1;
                    t_max = t_max.min(t + thickness);
                    node = near;
                }
            }
            Kind::Leaf { first, count } => {
                let until = match leaf(first, count) {
                    Next::Until(until) => until,
                    Next::Stop => return,
                };
                loop {
                    if height == 0 {
                        return;
                    }
                    height -= 1;
                    // SAFETY: everything below the height was written.
                    let later = unsafe { stack[height].assume_init() };
                    (node, t_min, t_max) = (later.node, later.t_min, later.t_max);
                    if t_min <= until {
                        break;
                    }
                }
            }
        }
    }
}
