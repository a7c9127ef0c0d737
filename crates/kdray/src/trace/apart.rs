//! How far the triangles of a block are from a point, at least and at most.
//!
//! A plane with all of a triangle beyond it proves a distance, whatever its normal. So the normal
//! may come from single precision: it points to where the nearest point seems to be, and only the
//! projection of the corners on it, with its roundings, has to be right. Wherever that is in the
//! triangle, its nearest point is not farther.

use super::block::Block;
use super::eights::{Eights, by_axis};

/// Bounds of the squared distances of the triangles of a block.
pub(super) struct Apart<E> {
    pub(super) least: E,
    pub(super) most: E,
}

/// Bounds for the triangles of `block` from `point`, which is the same in all lanes; not numbers
/// where lanes are free.
#[inline(always)]
pub(super) fn apart<E: Eights>(block: &Block, point: &[E; 3]) -> Apart<E> {
    let corners = block.corners();
    let a = by_axis!(|axis| point[0].load(&corners[0][axis]));
    let start = by_axis!(|axis| a[axis] - point[axis]);
    let ab = by_axis!(|axis| point[0].load(&corners[1][axis]) - a[axis]);
    let ac = by_axis!(|axis| point[0].load(&corners[2][axis]) - a[axis]);
    let Apart { least, most } = Triangles::new(start, ab, ac).apart();
    // Of free lanes nothing is near: where the other is not a number, the greater is not.
    Apart { least: least.max(a[0] * a[0].all(0.0)), most }
}

/// The corners as seen from the point: `start`, `start + ab` and `start + ac`; and products.
struct Triangles<E> {
    start: [E; 3],
    ab: [E; 3],
    ac: [E; 3],
    start_start: E,
    start_ab: E,
    start_ac: E,
    ab_ab: E,
    ab_ac: E,
    ac_ac: E,
}

/// Half an ulp of one.
const HALF_ULP: f32 = 0.5 * f32::EPSILON;

/// More than the roundings of projections, relative to the product of the lengths: seven half ulps
/// of one are in play.
const ROUNDING: f32 = 10.0 * HALF_ULP;

/// Below these, products could have lost digits: nothing is known then.
const SMALLEST_PROJECTION: f32 = 1e-18;
const SMALLEST_NORMAL: f32 = 1e-30;

/// The way to a point of the triangle is off by less than `20 HALF_ULP` of the largest distance in
/// play, here `reach`: four roundings for each of its three terms, and four for the weights. With a
/// share of the length itself, `(length + off)^2 <= length^2 (1 + SHARE) + off^2 (1 + 1 / SHARE)`.
/// Twice the share leaves room for the roundings of squares.
const SHARE: f32 = 1.0 / 8192.0;
const OFF: f32 = 20.0 * HALF_ULP * 20.0 * HALF_ULP * 1.5 * (1.0 + 1.0 / SHARE);

impl<E: Eights> Triangles<E> {
    #[inline(always)]
    fn new(start: [E; 3], ab: [E; 3], ac: [E; 3]) -> Self {
        let [start_start, start_ab, start_ac] =
            [dot(&start, &start), dot(&start, &ab), dot(&start, &ac)];
        let [ab_ab, ab_ac, ac_ac] = [dot(&ab, &ab), dot(&ab, &ac), dot(&ac, &ac)];
        Self { start, ab, ac, start_start, start_ab, start_ac, ab_ab, ab_ac, ac_ac }
    }

    /// At least the squared distance of the plane through the nearest corner, across the way to
    /// where the nearest point seems to be; zero if other corners are before it. At most that of
    /// where it seems to be.
    #[inline(always)]
    fn apart(&self) -> Apart<E> {
        let [u, v] = self.nearest();
        let normal =
            by_axis!(|axis| u.fused(self.ab[axis], v.fused(self.ac[axis], self.start[axis])));
        let [start, ab, ac] =
            [dot(&normal, &self.start), dot(&normal, &self.ab), dot(&normal, &self.ac)];
        let length = dot(&normal, &normal);
        let all = |number: f32| u.all(number);
        let reach = self.start_start + self.ab_ab.max(self.ac_ac);
        let off = reach.fused(all(OFF), all(f32::MIN_POSITIVE));
        let most = length.fused(all(1.0 + 2.0 * SHARE), off);
        let nearest = start + ab.min(ac).min(all(0.0));
        let sure = nearest - all(ROUNDING) * (length * reach).sqrt();
        let least = sure * sure.over(length) * all(1.0 - ROUNDING);
        // Of numbers out of range nothing is known.
        let least = least.pick(all(f32::INFINITY), least, all(0.0));
        let least = all(SMALLEST_NORMAL).pick(length, least, all(0.0));
        Apart { least: all(SMALLEST_PROJECTION).pick(sure, least, all(0.0)), most }
    }

    /// Weights of `ab` and `ac` at the nearest points, roughly: those of the foot on the plane
    /// where that is inside, else of the nearest point of an edge.
    #[inline(always)]
    fn nearest(&self) -> [E; 2] {
        let Self { ab_ab, ab_ac, ac_ac, .. } = *self;
        let (zero, one) = (ab_ab.all(0.0), ab_ab.all(1.0));
        let share = |part: E, whole: E| part.roughly_over(whole).max(zero).min(one);
        let [along_ab, along_ac] = [zero - self.start_ab, zero - self.start_ac];
        let on_ab = share(along_ab, ab_ab);
        let on_ac = share(along_ac, ac_ac);
        let across = ab_ab - ab_ac;
        let on_bc = share(along_ac - along_ab + across, across + (ac_ac - ab_ac));
        // Squared distances, less that of the first corner.
        let at_ab = on_ab * on_ab.fused(ab_ab, self.start_ab + self.start_ab);
        let at_ac = on_ac * on_ac.fused(ac_ac, self.start_ac + self.start_ac);
        let off_bc = one - on_bc;
        let half = off_bc.fused(ab_ab, self.start_ab + self.start_ab);
        let other = on_bc.fused(ac_ac, self.start_ac + self.start_ac);
        let twice = off_bc * ab_ac;
        let at_bc = off_bc.fused(half, on_bc * (other + twice + twice));
        let nearer = at_ab.min(at_ac);
        let u = at_bc.pick(nearer, off_bc, at_ab.pick(at_ac, on_ab, zero));
        let v = at_bc.pick(nearer, on_bc, at_ab.pick(at_ac, zero, on_ac));
        let area = ab_ab * ac_ac - ab_ac * ab_ac;
        let foot_u = along_ab * ac_ac - along_ac * ab_ac;
        let foot_v = along_ac * ab_ab - along_ab * ab_ac;
        // Inside if all three are positive.
        let least = foot_u.min(foot_v).min(area - foot_u - foot_v);
        let one_over = one.over(area);
        [zero.pick(least, foot_u * one_over, u), zero.pick(least, foot_v * one_over, v)]
    }
}

#[inline(always)]
fn dot<E: Eights>(a: &[E; 3], b: &[E; 3]) -> E {
    a[0].fused(b[0], a[1].fused(b[1], a[2] * b[2]))
}

#[cfg(test)]
mod tests {
    use super::super::eights::Array;
    use super::*;
    use crate::geometry::nearest::nearest_on_triangle;
    use crate::trace::noise::noise;
    #[cfg(target_arch = "x86_64")]
    use crate::trace::vector::Eight;

    type Corners = [[f32; 3]; 3];

    /// Triangles of all shapes, slivers, segments and points among them, and places near and far,
    /// some of them on the triangle.
    fn cases(count: usize) -> Vec<([f32; 3], Vec<Corners>)> {
        let mut state = 5;
        let mut case = || {
            let mut any = || 2.0 * noise(&mut state) - 1.0;
            let base = [any(), any(), any()].map(|v| v * 10.0);
            let size = 10.0_f32.powf(2.0 * any());
            let corner = |any: &mut dyn FnMut() -> f32| base.map(|v| v + size * any());
            let triangles: Vec<Corners> = (0..8)
                .map(|kind| {
                    let [a, b, c] = [(); 3].map(|()| corner(&mut any));
                    let along = |t: f32| [0, 1, 2].map(|axis| a[axis] + t * (b[axis] - a[axis]));
                    match kind {
                        0 => [a; 3],
                        1 => [a, b, along(any())],
                        2 => [a, b, along(any()).map(|v| v + 1e-5 * size * any())],
                        _ => [a, b, c],
                    }
                })
                .collect();
            let [a, b, c] = triangles[7];
            let reach = size * 10.0_f32.powf(2.0 * any());
            let point = match (4.0 * noise(&mut state)) as u32 {
                0 => [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0),
                1 => b,
                _ => base.map(|v| v + reach * (2.0 * noise(&mut state) - 1.0)),
            };
            (point, triangles)
        };
        (0..count).map(|_| case()).collect()
    }

    /// How many bounds are close.
    fn check<E: Eights>(zero: E) -> usize {
        let mut close = 0;
        for (point, triangles) in cases(20_000) {
            let block =
                Block::new(&[0, 1, 2, 3, 4, 5, 6, 7], true, |index| triangles[index as usize]);
            let Apart { least, most } = apart(&block, &point.map(|number| zero.all(number)));
            for (lane, corners) in triangles.iter().enumerate() {
                let nearest = nearest_on_triangle(point, corners).squared_distance;
                let [least, most] = [least, most].map(|it| f64::from(it.numbers()[lane]));
                let is_right = least <= nearest && nearest <= most;
                assert!(is_right, "{least} {nearest} {most}: {point:?} {corners:?}");
                close += usize::from(most - least < 1e-3 * nearest);
            }
        }
        close
    }

    #[test]
    fn nothing_is_near_in_free_lanes() {
        let corners = [[1.0, 2.0, 3.0], [4.0, 5.0, 7.0], [7.0, -2.0, 1.0]];
        let block = Block::new(&[0, 1, 2], true, |_| corners);
        let point = [0.5, 0.5, 0.5].map(|number| Array([number; 8]));
        let Apart { least, .. } = apart(&block, &point);
        assert_eq!(least.is_at_most(Array([f32::INFINITY; 8])), 0b111);
    }

    #[test]
    fn distances_are_between_their_bounds() {
        let close = check(Array([0.0; 8]));
        assert!(close > 100_000, "only {close} bounds are close");
    }

    #[cfg(target_arch = "x86_64")]
    #[test]
    fn distances_are_between_their_bounds_with_avx2() {
        #[target_feature(enable = "avx2,fma")]
        fn check_avx2() -> usize {
            check(Eight(std::arch::x86_64::_mm256_setzero_ps()))
        }
        let has_all = std::arch::is_x86_feature_detected!("avx2")
            && std::arch::is_x86_feature_detected!("fma");
        if !has_all {
            println!("this processor has no AVX2: its path was not tested");
            return;
        }
        // SAFETY: the processor has both.
        let close = unsafe { check_avx2() };
        assert!(close > 100_000, "only {close} bounds are close");
    }
}
