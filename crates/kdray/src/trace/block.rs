//! Eight triangles that are tested together.

use super::intersect::{Crossing, tied_crossing};
use super::prepare::Shear;
use crate::geometry::Hit;

/// Triangles in a block.
pub(super) const LANES: usize = 8;

type Lanes = [f32; LANES];

/// Corners and indices of up to eight triangles. Free lanes repeat the first triangle.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(super) struct Block {
    /// By corner and axis.
    corners: [[Lanes; 3]; 3],
    triangles: [u32; LANES],
}

impl Block {
    /// A block of `triangles`, which are not empty and at most eight.
    pub(super) fn new(triangles: &[u32], corners_of: impl Fn(u32) -> [[f32; 3]; 3]) -> Self {
        let mut block: Self = bytemuck::Zeroable::zeroed();
        for lane in 0..LANES {
            let triangle = triangles.get(lane).copied().unwrap_or(triangles[0]);
            let corners = corners_of(triangle);
            for corner in 0..3 {
                for axis in 0..3 {
                    block.corners[corner][axis][lane] = corners[corner][axis];
                }
            }
            block.triangles[lane] = triangle;
        }
        block
    }

    /// Hands every hit of the block with `t_min <= t <= t_max` to `found`.
    ///
    /// The arithmetic is that of [`intersect`](super::intersect()), lane by lane.
    #[inline(always)]
    pub(super) fn intersect(
        &self,
        shear: &Shear,
        [t_min, t_max]: [f32; 2],
        mut found: impl FnMut(Hit),
    ) {
        let points = [0, 1, 2].map(|corner| self.points(shear, corner));
        let edges =
            [edges(&points[2], &points[1]), edges(&points[0], &points[2]), edges(&points[1], &points[0])];
        let mut inside = inside(&edges);
        while inside != 0 {
            let lane = inside.trailing_zeros() as usize;
            inside &= inside - 1;
            let Some(Crossing { t, u, v }) = crossing(shear, &points, &edges, lane) else { continue };
            if t_min <= t && t <= t_max {
                found(Hit { t, triangle: self.triangles[lane], u, v });
            }
        }
    }

    /// A corner of all triangles in ray space, as [`Shear::point`] gives it.
    #[inline(always)]
    fn points(&self, shear: &Shear, corner: usize) -> [Lanes; 3] {
        let mut points = [[0.0; LANES]; 3];
        let [x, y, z] = shear.axes.map(|axis| &self.corners[corner][axis]);
        for lane in 0..LANES {
            let point = shear.point([x[lane], y[lane], z[lane]]);
            points[0][lane] = point[0];
            points[1][lane] = point[1];
            points[2][lane] = point[2];
        }
        points
    }
}

#[inline(always)]
fn edges(p: &[Lanes; 3], q: &[Lanes; 3]) -> Lanes {
    let mut edges = [0.0; LANES];
    for lane in 0..LANES {
        edges[lane] = p[0][lane] * q[1][lane] - p[1][lane] * q[0][lane];
    }
    edges
}

/// A bit for every lane whose edge functions do not differ in sign; zeros have any.
#[inline(always)]
fn inside(edges: &[Lanes; 3]) -> u32 {
    let mut inside = [0_u32; LANES];
    for lane in 0..LANES {
        let [u, v, w] = [edges[0][lane], edges[1][lane], edges[2][lane]];
        let positive = (u >= 0.0) & (v >= 0.0) & (w >= 0.0);
        let negative = (u <= 0.0) & (v <= 0.0) & (w <= 0.0);
        inside[lane] = u32::from(positive | negative) << lane;
    }
    inside.iter().fold(0, |bits, bit| bits | bit)
}

/// Where one lane is crossed, if it is.
#[inline(always)]
fn crossing(shear: &Shear, points: &[[Lanes; 3]; 3], edges: &[Lanes; 3], lane: usize) -> Option<Crossing> {
    let [u, v, w] = [edges[0][lane], edges[1][lane], edges[2][lane]];
    if u == 0.0 || v == 0.0 || w == 0.0 {
        let point = |corner: usize| [0, 1, 2].map(|axis| points[corner][axis][lane]);
        return tied_crossing(shear, [point(0), point(1), point(2)]);
    }
    let determinant = u + v + w;
    let height = (u * points[0][2][lane] + v * points[1][2][lane]) + w * points[2][2][lane];
    Some(Crossing { t: height / determinant, u: v / determinant, v: w / determinant })
}
