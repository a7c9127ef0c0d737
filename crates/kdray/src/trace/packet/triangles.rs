//! Triangles, for all rays of a packet at once.

use super::Rays;
use crate::trace::block::Block;
use crate::trace::located::{Located, located, precisely_sheared};
use crate::trace::sift::{sheared, sift};
use crate::trace::sifted::Sifted;
use crate::trace::vector::{Arithmetic, Numbers, Precise, Vector, by_axis};

/// Rays ready for triangles, as [`Shear`](crate::trace::prepare::Shear) is for one.
pub(super) struct Triangles<L: Vector> {
    axes: [usize; 3],
    origin: [L; 3],
    slope: [L; 2],
    precise_slope: [L::Precise; 2],
    t_per_z: L::Precise,
    t_min: L,
}

/// Where the rays cross a triangle, for those of which it is known.
pub(super) struct Where {
    pub(super) known: u32,
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
    pub(super) fn sift(&self, block: &Block, place: usize, until: L) -> Sifted {
        let corners = by_axis!(|corner| {
            let corner = &block.corners()[corner];
            let point = by_axis!(|axis| until.all(corner[self.axes[axis]][place]));
            sheared(point, &self.origin, &self.slope)
        });
        sift(&corners, self.t_per_z.rounded(), [self.t_min, until])
    }

    /// Where all rays cross the triangle.
    #[inline(always)]
    pub(super) fn locate(&self, block: &Block, place: usize) -> Where {
        let corners = by_axis!(|corner| self.precisely_sheared(&block.corners()[corner], place));
        let Located { known, t, u, v } = located(corners, self.t_per_z);
        let [t, u, v] = by_axis!(|column| [t, u, v][column].rounded().numbers());
        Where { known, t, u, v }
    }

    /// A corner in ray space.
    #[inline(always)]
    fn precisely_sheared(&self, corner: &[[f32; 8]; 3], place: usize) -> [L::Precise; 3] {
        let corner = by_axis!(|axis| {
            let corner = self.t_per_z.all(f64::from(corner[self.axes[axis]][place]));
            corner - self.origin[axis].precise()
        });
        precisely_sheared(corner, &self.precise_slope)
    }
}
