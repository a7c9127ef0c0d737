//! Rays in and out of Embree's packets.

use kdray::Ray;

use super::api::{HitPacket, NO_GEOMETRY, RayHitPacket, RayPacket};
use crate::engine::Hit;

impl<const N: usize> RayPacket<N> {
    /// The first `N` rays or fewer; the lanes left over hold zeros and must be inactive.
    pub(super) fn new(rays: &[Ray]) -> Self {
        let mut packet = RayPacket {
            origin: [[0.0; N]; 3],
            t_near: [0.0; N],
            direction: [[0.0; N]; 3],
            time: [0.0; N],
            t_far: [0.0; N],
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
        };
        for (lane, ray) in rays.iter().take(N).enumerate() {
            for axis in 0..3 {
                packet.origin[axis][lane] = ray.origin[axis];
                packet.direction[axis][lane] = ray.direction[axis];
            }
            packet.t_near[lane] = ray.t_min;
            packet.t_far[lane] = ray.t_max;
        }
        packet
    }
}

impl<const N: usize> RayHitPacket<N> {
    /// Rays that have hit nothing yet.
    pub(super) fn new(rays: &[Ray]) -> Self {
        let hit = HitPacket {
            normal: [[0.0; N]; 3],
            uv: [[0.0; N]; 2],
            triangle: [NO_GEOMETRY; N],
            geometry: [NO_GEOMETRY; N],
            instance: [NO_GEOMETRY; N],
            instance_triangle: [NO_GEOMETRY; N],
        };
        RayHitPacket { ray: RayPacket::new(rays), hit }
    }

    /// What the ray of a lane has hit.
    pub(super) fn hit(&self, lane: usize) -> Hit {
        match self.hit.geometry[lane] {
            NO_GEOMETRY => Hit::MISS,
            _ => Hit { t: self.ray.t_far[lane], triangle: self.hit.triangle[lane] },
        }
    }
}

/// Embree's mask of active lanes: the first `count`.
pub(super) fn active<const N: usize>(count: usize) -> [i32; N] {
    std::array::from_fn(|lane| if lane < count { -1 } else { 0 })
}
