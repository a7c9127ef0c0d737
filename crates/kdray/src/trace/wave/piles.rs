//! What a wave finds, ray by ray in the end.

use std::arch::x86_64::*;

use super::RAYS;
use crate::geometry::Hit;
use crate::geometry::ordered::ordered;

/// What is kept of a hit.
pub(in crate::trace) trait Kept: Copy {
    /// Whether it is enough to know that a triangle is hit, and not where.
    const ASKS_WHETHER: bool;

    fn of(hit: &Hit) -> Self;

    fn triangle(&self) -> u32;

    /// By which the list of a ray is sorted: equal triangles stand side by side.
    fn key(&self) -> u64;
}

impl Kept for Hit {
    const ASKS_WHETHER: bool = false;

    #[inline(always)]
    fn of(hit: &Hit) -> Self {
        *hit
    }

    #[inline(always)]
    fn triangle(&self) -> u32 {
        self.triangle
    }

    /// By `t`, and then by the triangle. One in several leaves gives the very same hit in each of them.
    #[inline(always)]
    fn key(&self) -> u64 {
        // Zero has one sign.
        u64::from(ordered(self.t + 0.0)) << 32 | u64::from(self.triangle)
    }
}

/// A triangle that is hit.
impl Kept for u32 {
    const ASKS_WHETHER: bool = true;

    #[inline(always)]
    fn of(hit: &Hit) -> Self {
        hit.triangle
    }

    #[inline(always)]
    fn triangle(&self) -> u32 {
        *self
    }

    #[inline(always)]
    fn key(&self) -> u64 {
        u64::from(*self)
    }
}

/// What was found, as it came, and how much of it is of each ray.
pub(super) struct Piles<T> {
    found: Vec<(u32, T)>,
    counts: [u32; RAYS],
    /// The triangles of the last four crossings of a ray.
    last: [[u32; 4]; RAYS],
    /// By ray.
    sorted: Vec<T>,
}

impl<T: Kept> Piles<T> {
    pub(super) fn new() -> Self {
        let (counts, last) = ([0; RAYS], [[u32::MAX; 4]; RAYS]);
        Self { found: Vec::new(), counts, last, sorted: Vec::new() }
    }

    /// Whether it is not known that a ray crosses a triangle: one in several leaves comes again soon.
    /// Without a jump, which nobody could foresee.
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn is_new(&mut self, ray: usize, triangle: u32) -> bool {
        let last = self.last[ray % RAYS].as_mut_ptr().cast();
        let triangle = _mm_set1_epi32(triangle as i32);
        // SAFETY: they are four.
        unsafe {
            let four = _mm_loadu_si128(last);
            _mm_storeu_si128(last, _mm_alignr_epi8::<12>(four, triangle));
            _mm_movemask_epi8(_mm_cmpeq_epi32(four, triangle)) == 0
        }
    }

    /// Adds a hit of a ray.
    #[inline(always)]
    pub(super) fn add(&mut self, ray: usize, hit: T) {
        self.found.push((ray as u32, hit));
        self.counts[ray] += 1;
    }

    /// Gives `end` the list of each of so many rays, in order and each triangle once; then nothing is
    /// left.
    pub(super) fn hand_over(&mut self, rays: usize, mut end: impl FnMut(usize, &[T])) {
        let Self { found, counts, last, sorted } = self;
        let mut next = 0;
        for count in &mut counts[..rays] {
            // Where its list starts, and, when all is there, where it ends.
            (*count, next) = (next, next + *count);
        }
        // So many places; what is in them is written again.
        sorted.clear();
        sorted.extend(found.iter().map(|(_, hit)| *hit));
        for (ray, hit) in found.drain(..) {
            let place = &mut counts[ray as usize];
            sorted[*place as usize] = hit;
            *place += 1;
        }
        let mut start = 0;
        for (ray, stop) in counts[..rays].iter().enumerate() {
            let list = &mut sorted[start..*stop as usize];
            let count = in_order(list);
            end(ray, &list[..count]);
            start = *stop as usize;
        }
        counts[..rays].fill(0);
        last[..rays].fill([u32::MAX; 4]);
    }
}

/// Brings a list in order, each triangle once, and says how long it is then.
#[inline(always)]
fn in_order<T: Kept>(list: &mut [T]) -> usize {
    if list.len() < 2 {
        return list.len();
    }
    list.sort_unstable_by_key(Kept::key);
    let mut count = 1;
    for place in 1..list.len() {
        if list[place].triangle() != list[count - 1].triangle() {
            list[count] = list[place];
            count += 1;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(t: f32, triangle: u32) -> Hit {
        Hit { t, triangle, u: 0.0, v: 0.0 }
    }

    #[test]
    fn lists_come_ray_by_ray_in_order_and_without_repetition() {
        let mut piles = Piles::new();
        for _ in 0..2 {
            let found =
                [(2, 1.0, 7), (0, 3.0, 1), (2, -0.0, 9), (2, 0.0, 8), (2, -5.0, 3), (2, 1.0, 7)];
            found.iter().for_each(|(ray, t, triangle)| piles.add(*ray, hit(*t, *triangle)));
            let mut lists = Vec::new();
            piles.hand_over(4, |ray, list: &[Hit]| {
                lists.push((ray, list.iter().map(|hit| hit.triangle).collect::<Vec<_>>()));
            });
            let expected = [(0, vec![1]), (1, vec![]), (2, vec![3, 8, 9, 7]), (3, vec![])];
            assert_eq!(lists, expected);
        }
    }

    #[test]
    fn the_last_four_triangles_of_a_ray_are_known() {
        if !std::is_x86_feature_detected!("avx2") {
            return println!("this processor has no AVX2: there are no waves");
        }
        let mut piles = Piles::<u32>::new();
        // SAFETY: the processor has AVX2.
        let mut is_new = |ray, triangle| unsafe { piles.is_new(ray, triangle) };
        assert!((0..4).all(|triangle| is_new(0, triangle)));
        assert!(is_new(1, 0) && !is_new(0, 3) && !is_new(0, 2), "rays know nothing of each other");
        assert!(is_new(0, 5) && is_new(0, 0), "it is forgotten after four");
    }
}
