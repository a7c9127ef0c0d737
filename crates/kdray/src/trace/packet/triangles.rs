//! Triangles, for all rays of a packet at once.

use super::Rays;
use crate::trace::block::Block;
use crate::trace::sift::{Sifted, sheared, sift};
use crate::trace::vector::{Arithmetic, Mask, Numbers, Precise, Vector, by_axis};

/// Rays ready for triangles, as [`Shear`](crate::trace::prepare::Shear) is for one.
pub(super) struct Triangles<L: Vector> {
    axes: [usize; 3],
    origin: [L; 3],
    slope: [L; 2],
    precise_slope: [L::Precise; 2],
    t_per_z: L::Precise,
    t_min: L,
}

/// Where the rays cross a triangle, for those in `mask`.
pub(super) struct Located {
    pub(super) mask: u32,
    pub(super) t: Numbers,
    pub(super) u: Numbers,
    pub(super) v: Numbers,
}

impl<L: Vector> Triangles<L> {
    /// All rays have these axes.
    #[inline(always)]
    pub(super) fn new(rays: &Rays<L>, axes: [usize; 3]) -> Self {
        let [x, y, z] = axes;
        let dz = rays.direction[z].precise();
        let t_per_z = dz.all(1.0) / dz;
        let [slope_x, slope_y] =
            [rays.direction[x].precise() * t_per_z, rays.direction[y].precise() * t_per_z];
        Self {
            axes,
            origin: by_axis!(|axis| rays.origin[axes[axis]]),
            slope: [slope_x.rounded(), slope_y.rounded()],
            precise_slope: [slope_x, slope_y],
            t_per_z,
            t_min: rays.t_min,
        }
    }

    /// The rays that may hit the triangle at a place of a block.
    #[inline(always)]
    pub(super) fn sift(&self, block: &Block, place: usize, until: L) -> Sifted<L> {
        let corners = by_axis!(|corner| {
            let corner = &block.corners()[corner];
            let point = by_axis!(|axis| until.all(corner[self.axes[axis]][place]));
            sheared(point, &self.origin, &self.slope)
        });
        sift(&corners, self.t_per_z.rounded(), [self.t_min, until])
    }

    /// [`locate`](crate::trace::intersect::locate) for all rays at once, with the same arithmetic,
    /// but for rays that pass an edge on the outside by a rounding.
    #[inline(always)]
    pub(super) fn locate(&self, block: &Block, place: usize) -> Located {
        let [a, b, c] = by_axis!(|corner| self.precisely_sheared(&block.corners()[corner], place));
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let (lowest, highest) = (u.min(v).min(w), u.max(v).max(w));
        let (sum, zero) = (u + v + w, u.all(0.0));
        // Of these none is inside whose sum is zero.
        let positive = zero.is_at_most(lowest).and(zero.is_less(sum));
        let negative = highest.is_at_most(zero).and(sum.is_less(zero));
        let (v, w) = (v / sum, w / sum);
        let z = a[2] + (v * (b[2] - a[2]) + w * (c[2] - a[2]));
        Located {
            mask: positive.or(negative).bits(),
            t: (z * self.t_per_z).rounded().numbers(),
            u: v.rounded().numbers(),
            v: w.rounded().numbers(),
        }
    }
    /// A corner in ray space.
    #[inline(always)]
    fn precisely_sheared(&self, corner: &[[f32; 8]; 3], place: usize) -> [L::Precise; 3] {
        let slope = self.precise_slope;
        let [x, y, z] = by_axis!(|axis| {
            let corner = slope[0].all(f64::from(corner[self.axes[axis]][place]));
            corner - self.origin[axis].precise()
        });
        [x - slope[0] * z, y - slope[1] * z, z]
    }
}

#[inline(always)]
fn edge<P: Precise>(p: [P; 3], q: [P; 3]) -> P {
    p[0] * q[1] - p[1] * q[0]
}
