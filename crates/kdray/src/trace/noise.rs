//! Numbers and scenes without a pattern, for tests.

use crate::geometry::{Mesh, Ray};
use crate::{BuildOptions, Tree};

/// A number without a pattern, in 0..1.
pub(super) fn noise(state: &mut u32) -> f32 {
    *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    (*state >> 8) as f32 / (1 << 24) as f32
}

/// Small triangles, so that rays go a long way between them.
pub(super) fn small_triangles(state: &mut u32) -> (Mesh, Tree) {
    let mut point = |from: f32, to: f32| [(); 3].map(|()| from + (to - from) * noise(state));
    let corners = |_| {
        let (middle, size) = (point(0.0, 1.0), 0.1);
        [(); 3].map(|()| {
            let way = point(-size, size);
            [0, 1, 2].map(|axis| middle[axis] + way[axis])
        })
    };
    let positions: Vec<_> = (0..900).flat_map(corners).collect();
    let triangles: Vec<_> = (0..900).map(|at| [3 * at, 3 * at + 1, 3 * at + 2]).collect();
    let mesh = Mesh::new(&positions, &triangles).expect("sound");
    let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
    (mesh, tree)
}

/// Rays from all around them, through them.
pub(super) fn rays_through(state: &mut u32, count: usize) -> Vec<Ray> {
    let mut point = |from: f32, to: f32| [(); 3].map(|()| from + (to - from) * noise(state));
    let ray = |_| {
        let (origin, target) = (point(-0.5, 1.5), point(0.2, 0.8));
        Ray::new(origin, [0, 1, 2].map(|axis| target[axis] - origin[axis]))
    };
    (0..count).map(ray).collect()
}
