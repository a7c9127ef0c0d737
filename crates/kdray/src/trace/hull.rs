//! The box of a scene, and rays from far away that pass beside it.

use super::eights::by_axis;
use super::prepare::{THICKNESS, greater, largest, reach};
use super::simd::Best;
use crate::geometry::{Aabb, Ray};

/// The box of everything that rays may hit.
///
/// Of a camera's rays most pass beside the scene, each like the one before, and for these making a ray
/// ready and the step at the root are all there is to do. Whether a line passes beside a box takes a few
/// products instead. Rays that start near the scene, or in it, go another way each: there the jump is not
/// foreseen, and costs more than it saves.
pub(super) struct Hull {
    /// A number an axis, and one of no consequence.
    center: [f32; 4],
    /// From the center to the sides, at least.
    half: [f32; 4],
    /// The largest coordinate of the scene.
    pub(super) reach: f32,
    /// Rays are from far away that start farther than this from the center, along any axis.
    far: f32,
}

/// Twice what roundings of the triangle tests can move a hit: enough for the roundings here, too.
const MARGIN: f32 = 2.0 * THICKNESS;

impl Hull {
    pub(super) fn new(bounds: &Aabb) -> Self {
        let Aabb { lower, upper } = bounds;
        let center = by_axis!(|axis| 0.5 * lower[axis] + 0.5 * upper[axis]);
        let [x, y, z] = by_axis!(|axis| {
            greater(upper[axis] - center[axis], center[axis] - lower[axis]).next_up()
        });
        Self {
            center: [center[0], center[1], center[2], 0.0],
            half: [x, y, z, 0.0],
            reach: reach(bounds),
            far: 2.0 * largest(&[x, y, z]),
        }
    }

    /// Whether the ray comes from far away, and its line certainly [misses](Self::is_missed) the box.
    #[inline(always)]
    pub(super) fn is_beside(&self, ray: &Ray) -> bool {
        // Not so, either, if something is not a number.
        by_axis!(|axis| (ray.origin[axis] - self.center[axis]).abs() > self.far).contains(&true)
            && self.is_missed(ray)
    }

    /// Whether the line of the ray certainly misses the box, and so everything in it.
    ///
    /// A line and a box that are apart are so along an axis perpendicular to the line and to an edge of the
    /// box \[GLM96]. Of numbers out of range nothing is certain, and what is lost of the least ones is less
    /// than [`f32::MIN_POSITIVE`].
    #[inline(always)]
    pub(super) fn is_missed(&self, ray: &Ray) -> bool {
        let Ray { origin, direction, .. } = ray;
        let way = by_axis!(|axis| origin[axis] - self.center[axis]);
        let margin = MARGIN * (largest(origin) + self.reach);
        let is_apart = |axis: usize| {
            let next = (axis + 1) % 3;
            let across = way[axis] * direction[next] - way[next] * direction[axis];
            let [half, half_next] = [self.half[axis] + margin, self.half[next] + margin];
            let reached = half * direction[next].abs() + half_next * direction[axis].abs();
            across.abs() > reached + f32::MIN_POSITIVE && across.is_finite()
        };
        (0..3).any(is_apart)
    }

    /// Which of at most 64 rays are valid and do not certainly miss the box, a bit each. No jump depends on
    /// one of them where they are asked eight at a time.
    #[cfg_attr(not(target_arch = "x86_64"), expect(unused_variables, reason = "one way only"))]
    pub(super) fn reached(&self, rays: &[Ray], simd: Best) -> u64 {
        #[cfg(target_arch = "x86_64")]
        if let Some(proof) = simd.avx2() {
            // SAFETY: the processor has AVX2 and FMA.
            return unsafe { self.reached_avx2(proof, rays) };
        }
        let bit = |(index, ray): (usize, &Ray)| {
            u64::from(ray.is_valid() && !self.is_missed(ray)) << index
        };
        rays.iter().enumerate().map(bit).sum()
    }
}

/// The same with all axes at once.
#[cfg(target_arch = "x86_64")]
mod avx {
    use std::arch::x86_64::*;

    use super::{Hull, MARGIN};
    use crate::geometry::{LEAST, MOST, Ray};
    use crate::trace::simd::HasAvx2;
    use crate::trace::step::{halves, is_valid, largest, magnitude, signs};
    use crate::trace::vector::{Arithmetic, Eight, Mask, Vector, by_axis};

    /// Of each axis the next.
    const NEXT: i32 = 0b11_00_10_01;

    impl Hull {
        /// [`Hull::is_beside`], as a part of the loop that asks.
        ///
        /// # Safety
        ///
        /// The processor has AVX2 and FMA.
        #[inline(always)]
        pub(in crate::trace) unsafe fn is_beside_avx2(&self, ray: &Ray) -> bool {
            // SAFETY: the same; there are four numbers.
            unsafe {
                let way = _mm_sub_ps(halves(ray)[0], _mm_loadu_ps(self.center.as_ptr()));
                let is_far = _mm_cmpgt_ps(magnitude(way), _mm_set1_ps(self.far));
                signs(is_far) != 0 && self.is_missed_avx2(ray)
            }
        }

        /// [`Hull::is_missed`].
        ///
        /// # Safety
        ///
        /// The processor has AVX2 and FMA.
        #[inline(always)]
        unsafe fn is_missed_avx2(&self, ray: &Ray) -> bool {
            // SAFETY: the same; there are four numbers.
            unsafe {
                let [origin, direction] = halves(ray);
                let way = _mm_sub_ps(origin, _mm_loadu_ps(self.center.as_ptr()));
                let from_center = _mm_add_ps(largest(magnitude(origin)), _mm_set1_ps(self.reach));
                let margin = _mm_mul_ps(_mm_set1_ps(MARGIN), from_center);
                let half = _mm_add_ps(_mm_loadu_ps(self.half.as_ptr()), margin);
                let [next, way_next] =
                    [_mm_permute_ps::<NEXT>(direction), _mm_permute_ps::<NEXT>(way)];
                let half_next = _mm_permute_ps::<NEXT>(half);
                let across = _mm_fmsub_ps(way, next, _mm_mul_ps(way_next, direction));
                let across = magnitude(across);
                let least = _mm_set1_ps(f32::MIN_POSITIVE);
                let reached = _mm_fmadd_ps(half_next, magnitude(direction), least);
                let reached = _mm_fmadd_ps(half, magnitude(next), reached);
                let is_finite = _mm_cmplt_ps(across, _mm_set1_ps(f32::INFINITY));
                signs(_mm_and_ps(_mm_cmpgt_ps(across, reached), is_finite)) != 0
            }
        }

        /// [`Hull::reached`], without a jump.
        #[target_feature(enable = "avx2,fma")]
        pub(super) fn reached_avx2(&self, proof: HasAvx2, rays: &[Ray]) -> u64 {
            let (mut reached, eights) = (0, rays.chunks_exact(8));
            let first = 8 * eights.len();
            for (index, ray) in eights.remainder().iter().enumerate() {
                // SAFETY: the processor has AVX2 and FMA.
                let is_reached = unsafe { is_valid(ray) && !self.is_missed_avx2(ray) };
                reached |= u64::from(is_reached) << (first + index);
            }
            for (group, rays) in eights.enumerate() {
                reached |= u64::from(self.reached_by(Eight::of_rays(proof, rays))) << (8 * group);
            }
            reached
        }

        /// Which of eight rays, by their numbers, are [valid](Ray::is_valid) and do not certainly
        /// [miss](Hull::is_missed) the box, a bit each.
        #[inline(always)]
        fn reached_by(&self, [ox, oy, oz, t_min, dx, dy, dz, t_max]: [Eight; 8]) -> u32 {
            let (origin, direction) = ([ox, oy, oz], [dx, dy, dz]);
            let far = by_axis!(|axis| origin[axis].magnitude());
            let [x, y, z] = far;
            let margin = (x.max(y).max(z) + x.all(self.reach)) * x.all(MARGIN);
            let way = by_axis!(|axis| origin[axis] - x.all(self.center[axis]));
            let half = by_axis!(|axis| margin + x.all(self.half[axis]));
            let length = by_axis!(|axis| direction[axis].magnitude());
            let in_range = by_axis!(|axis| {
                // Not so if they are not numbers.
                let is_near = far[axis].is_at_most(x.all(f32::MAX));
                is_near.and(length[axis].is_at_most(x.all(MOST)))
            });
            let longest = length[0].max(length[1]).max(length[2]);
            let is_valid = x.all(LEAST).is_at_most(longest).and(t_min.is_at_most(t_max));
            let is_valid = is_valid.and(in_range[0]).and(in_range[1]).and(in_range[2]);
            let is_apart = by_axis!(|axis| {
                let next = (axis + 1) % 3;
                let across = way[axis] * direction[next] - way[next] * direction[axis];
                let across = across.magnitude();
                let reached = half[next].fused(length[axis], x.all(f32::MIN_POSITIVE));
                let reached = half[axis].fused(length[next], reached);
                reached.is_less(across).and(across.is_less(x.all(f32::INFINITY)))
            });
            is_valid.and_not(is_apart[0].or(is_apart[1]).or(is_apart[2])).bits()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{LEAST, MOST};
    use crate::trace::intersect::crossing;
    use crate::trace::noise::noise;
    use crate::trace::prepare::Shear;
    #[cfg(target_arch = "x86_64")]
    use crate::trace::simd::{Avx2, Simd};

    /// Whether nothing is hit for certain, as every way says that there is on this processor, of one ray and
    /// of several.
    fn said(hull: &Hull, ray: &Ray) -> Vec<bool> {
        let nothing = |simd: Best| {
            let bits = hull.reached(&[*ray; 19], simd);
            [0, 8, 18].map(|place| bits >> place & 1 == 0)
        };
        Best::each().into_iter().flat_map(nothing).collect()
    }

    /// Rays to the corners, edges and insides of triangles as large as their boxes, and past them; from the
    /// ends of what is valid, too.
    #[test]
    fn no_ray_misses_what_it_hits() {
        let mut state = 23;
        let [mut hits, mut misses] = [0; 2];
        for round in 0..300_000 {
            let size = [1.0, 1e-20, 1e9, 1e-3, 3.0][round % 5];
            let away = [0.0, 0.0, 1.0, 1e3][round % 4] * size;
            let mut any = || 2.0 * noise(&mut state) - 1.0;
            let mut point = |size: f32| [(); 3].map(|()| size * any());
            let middle = point(away);
            let mut corners = [(); 3].map(|()| {
                let corner = point(size);
                by_axis!(|axis| middle[axis] + corner[axis])
            });
            if round % 3 == 0 {
                // Flat, in a side of the box.
                corners[1][0] = corners[0][0];
                corners[2][0] = corners[0][0];
            }
            let hull = Hull::new(&Aabb::of_points(&corners));
            let distance = size * 10.0_f32.powf(2.0 + [0.0, 2.0, 9.0][round % 7 % 3] * any());
            let start = [(); 3].map(|()| distance * any());
            let origin = by_axis!(|axis| middle[axis] + start[axis]);
            let mut weights = [[1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.3, 0.3, 0.4]][round % 11 % 3];
            if round % 2 == 0 {
                weights[1] += 4.0 * any();
            }
            let target =
                by_axis!(|axis| (0..3).map(|at| weights[at] * corners[at][axis]).sum::<f32>());
            let way = by_axis!(|axis| target[axis] - origin[axis]);
            let length = [1.0, 1e-18, 1e18][round % 13 % 3] / largest(&way);
            let ray = Ray::new(origin, way.map(|way| (way * length).clamp(-MOST, MOST)));
            if !ray.is_valid() {
                continue;
            }
            let is_hit = crossing(Shear::new(&ray), &corners).is_some();
            let said = said(&hull, &ray);
            assert!(!is_hit || !said.contains(&true), "{said:?}: {ray:?} hits {corners:?}");
            hits += u32::from(is_hit);
            misses += u32::from(!said.contains(&false));
        }
        assert!(hits > 50_000 && misses > 50_000, "{hits} hits, {misses} misses");
    }

    /// From and to the ends of what is valid, and beyond, along the diagonal through the middle.
    #[test]
    fn of_what_is_out_of_range_nothing_is_certain_if_it_is_valid() {
        let hull = Hull::new(&Aabb { lower: [-1.0; 3], upper: [1.0; 3] });
        for origin in [f32::MAX, -f32::MAX, f32::INFINITY, f32::NAN, 1e20] {
            for direction in [LEAST, 1.0, -1.0, MOST, f32::INFINITY, f32::NAN] {
                let ray = Ray::new([origin; 3], [direction; 3]);
                let said = said(&hull, &ray);
                assert!(said.iter().all(|said| *said != ray.is_valid()), "{said:?}: {ray:?}");
            }
        }
    }

    /// In a box that no ray misses, with the ends of what is valid, and what is beyond, on every axis.
    #[test]
    fn rays_that_are_not_valid_hit_nothing() {
        let hull = Hull::new(&Aabb { lower: [-1e38; 3], upper: [1e38; 3] });
        let far = [0.0, -f32::MAX, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, -f32::NAN];
        let [below, above] = [LEAST.next_down(), MOST.next_up()];
        let long = [0.0, -0.0, LEAST, -LEAST, below, 1.0, -MOST, above, -above, f32::NAN];
        let ends = [0.0, 1.0, -1.0, f32::INFINITY, f32::NEG_INFINITY, f32::NAN];
        let (mut state, mut valid) = (41, 0);
        for _ in 0..60_000 {
            let mut pick = |from: &[f32]| from[(from.len() as f32 * noise(&mut state)) as usize];
            // Most origins are sound, or few rays would be.
            let origin =
                [(); 3].map(|()| if pick(&[0.0, 0.0, 1.0]) > 0.0 { pick(&far) } else { 2.0 });
            let direction = [(); 3].map(|()| pick(&long));
            let [t_min, t_max] = [(); 2].map(|()| pick(&ends));
            let ray = Ray { origin, t_min, direction, t_max };
            let said = said(&hull, &ray);
            assert!(said.iter().all(|said| *said != ray.is_valid()), "{said:?}: {ray:?}");
            valid += u32::from(ray.is_valid());
        }
        assert!((2_000..40_000).contains(&valid), "{valid} were valid");
    }

    #[test]
    fn rays_that_start_near_are_not_beside() {
        let hull = Hull::new(&Aabb { lower: [0.0; 3], upper: [2.0, 4.0, 6.0] });
        // Far is twice three from the middle.
        for (x, is_far) in [(6.9, false), (7.1, true)] {
            let ray = Ray::new([x, 2.0, 3.0], [0.0, 1.0, 0.0]);
            assert!(!said(&hull, &ray).contains(&false), "{ray:?} misses");
            assert_eq!(hull.is_beside(&ray), is_far);
            #[cfg(target_arch = "x86_64")]
            if let Some(proof) = Best::detect().avx2() {
                assert_eq!(Avx2::from(proof).is_beside(&ray, &hull), is_far);
            }
        }
    }
}
