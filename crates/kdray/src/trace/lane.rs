//! Where a ray hits one triangle of a block.

use super::block::{Block, LANES};
use super::block_ray::BlockRay;
use super::located::{Located, located, precisely_sheared};
use super::prepare::Shear;
use super::vector::{Precise, by_axis};
use crate::geometry::{Hit, Ray};

impl Block {
    /// The hit of the triangle in a lane, at any `t`. `surely` says that the line crosses it.
    #[inline(always)]
    pub(super) fn hit_by(
        &self,
        lane: usize,
        surely: bool,
        (ray, block_ray): (&Ray, &BlockRay),
    ) -> Option<Hit> {
        if surely {
            let located = self.located(lane, block_ray);
            if located.is_some() {
                return located;
            }
        }
        // Number by number: read as a whole, from where the call wrote its parts, they would be waited for.
        let Hit { t, triangle, u, v } = unknown_hit(self, lane, surely, ray)?;
        Some(Hit { t, triangle, u, v })
    }

    /// [`locate`](super::intersect::locate) with the same arithmetic, or `None` where the line passes an
    /// edge on the outside by a rounding. The compiler pairs what can be paired; with a corner a lane it took
    /// longer, as lanes had to change places.
    #[inline(always)]
    fn located(&self, lane: usize, ray: &BlockRay) -> Option<Hit> {
        let lane = lane & (LANES - 1);
        let origin = by_axis!(|axis| f64::from(ray.origin[axis]));
        let [slope_x, slope_y, t_per_z, _] = ray.precise;
        let corners = by_axis!(|corner| {
            let way = by_axis!(|axis| {
                // SAFETY: the lane is one of a row.
                f64::from(unsafe { *ray.row(self, corner, axis).add(lane) }) - origin[axis]
            });
            precisely_sheared(way, &[slope_x, slope_y])
        });
        let Located { known, t, u, v } = located(corners, t_per_z);
        let [t, u, v] = [t.rounded(), u.rounded(), v.rounded()];
        (known != 0).then(|| Hit { t, triangle: self.index(lane), u, v })
    }
}

/// The hit in a lane of which [`located`] does not tell.
#[cold]
#[inline(never)]
pub(super) fn unknown_hit(block: &Block, lane: usize, surely: bool, ray: &Ray) -> Option<Hit> {
    block.hit(lane, surely, &Shear::new(ray))
}
