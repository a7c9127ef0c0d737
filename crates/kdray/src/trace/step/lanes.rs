//! The step with all boxes at once.
//!
//! Its functions are part of the loop that calls them, always, and so have the instructions that the
//! function around that loop may use. A function with instructions of its own the compiler may leave
//! out of the loop, and a closure is compiled for any processor: there is neither here.

use std::arch::x86_64::*;

use super::axes::Axes;
use super::ready::Ready;
use crate::geometry::Ray;
use crate::trace::eights::by_axis;
use crate::trace::opaque::opaque;
use crate::trace::stack::Stack;
use crate::trace::wide::{Child, Wide};

/// A ray ready for boxes: [`Slabs`](crate::trace::prepare::Slabs) in every lane.
#[derive(Clone, Copy)]
pub(in crate::trace) struct Lanes {
    inverse: [__m256; 3],
    enter: [__m256; 3],
    leave: [__m256; 3],
    octant: usize,
}

impl Lanes {
    /// # Safety
    ///
    /// The processor has AVX2.
    #[inline(always)]
    pub(in crate::trace) unsafe fn new(ray: &Ray, reach: f32) -> Self {
        // SAFETY: the same.
        unsafe {
            let Axes { inverse, enter, leave, octant } = Axes::new(ray, reach);
            Self { inverse: axes(inverse), enter: axes(enter), leave: axes(leave), octant }
        }
    }
}

/// The number of each axis in every lane.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
unsafe fn axes(v: __m128) -> [__m256; 3] {
    // SAFETY: the same.
    unsafe {
        let [y, z] = [_mm_movehdup_ps(v), _mm_movehl_ps(v, v)];
        [_mm256_broadcastss_ps(v), _mm256_broadcastss_ps(y), _mm256_broadcastss_ps(z)]
    }
}

/// Bytes of a row of bounds.
pub(in crate::trace) const ROW: usize = size_of::<[f32; 8]>();

/// By octant: where a node's six rows of bounds start, in bytes: those that come first, by axis, and
/// then those that come last.
pub(in crate::trace) static ROWS: [[usize; 6]; 8] = {
    let mut rows = [[0; 6]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut axis = 0;
        while axis < 3 {
            let backward = octant >> axis & 1;
            rows[octant][axis] = ROW * (3 * backward + axis);
            rows[octant][3 + axis] = ROW * (3 * (1 - backward) + axis);
            axis += 1;
        }
        octant += 1;
    }
    rows
};

/// Where a ray enters the boxes of children, and where it leaves them.
pub(in crate::trace) struct Passage {
    enter: __m256,
    leave: __m256,
}

impl Passage {
    /// Between the planes that come first and those that come last, by axis, in an interval.
    ///
    /// # Safety
    ///
    /// The processor has AVX2.
    #[inline(always)]
    pub(super) unsafe fn new(
        near: [__m256; 3],
        far: [__m256; 3],
        [t_min, t_max]: [f32; 2],
    ) -> Self {
        // SAFETY: the same.
        unsafe {
            // In pairs: nothing waits for three in a row.
            let [enter, leave] = [_mm256_max_ps(near[0], near[1]), _mm256_min_ps(far[0], far[1])];
            let [start, end] = [_mm256_set1_ps(t_min), _mm256_set1_ps(t_max)];
            Self {
                enter: _mm256_max_ps(enter, _mm256_max_ps(near[2], start)),
                leave: _mm256_min_ps(leave, _mm256_min_ps(far[2], end)),
            }
        }
    }

    /// The children that are met, as all ones.
    ///
    /// # Safety
    ///
    /// The processor has AVX2.
    #[inline(always)]
    pub(in crate::trace) unsafe fn met(&self) -> __m256 {
        // SAFETY: the same.
        unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.enter, self.leave) }
    }
}

/// [`meet`](super::meet) with all boxes at once, but for the comparison. Products and differences are
/// rounded together, so less than planes are thick for.
///
/// # Safety
///
/// The processor has AVX2 and FMA.
#[inline(always)]
unsafe fn pass(wide: &Wide, slabs: &Lanes, interval: [f32; 2]) -> Passage {
    let bounds = std::ptr::from_ref(&wide.bounds).cast::<u8>();
    // SAFETY: an octant is less than eight. There are six rows of bounds; they are eight lanes each, aligned
    // like the node.
    unsafe {
        // Read last, and on a line of their own.
        _mm_prefetch::<_MM_HINT_T0>(wide.children.as_ptr().cast());
        let rows = ROWS.get_unchecked(slabs.octant);
        let near = by_axis!(|axis| {
            let row = _mm256_load_ps(bounds.add(rows[axis]).cast());
            _mm256_fmsub_ps(row, slabs.inverse[axis], slabs.enter[axis])
        });
        let far = by_axis!(|axis| {
            let row = _mm256_load_ps(bounds.add(rows[3 + axis]).cast());
            _mm256_fmsub_ps(row, slabs.inverse[axis], slabs.leave[axis])
        });
        Passage::new(near, far, interval)
    }
}

/// [`nearest`](super::nearest), with jumps for one child and to the child: a single ray waits for nothing but
/// the result, and not for that, where it was [foreseen].
///
/// The nearest of several is known from the order and which are met, long before the others are on the
/// stack.
///
/// # Safety
///
/// The processor has AVX2 and FMA.
#[inline(always)]
pub(in crate::trace) unsafe fn nearest_avx2(
    wide: &Wide,
    slabs: &Lanes,
    interval: [f32; 2],
    stack: &mut Stack,
) -> Option<Child> {
    // SAFETY: the same.
    unsafe {
        let passage = pass(wide, slabs, interval);
        let met = passage.met();
        let mask = _mm256_movemask_ps(met) as u32;
        if mask & mask.wrapping_sub(1) == 0 {
            return only(wide, mask);
        }
        let order = *wide.order.get_unchecked(slabs.octant);
        let (places, mask) = ordered(order, met);
        push_places(wide, (places, mask), passage.enter, mask.count_ones() as usize - 1, stack);
        Some(foreseen(wide, nearest_of(order, mask)))
    }
}

/// The child that is met, or none: most of the time.
#[inline(always)]
fn only(wide: &Wide, mask: u32) -> Option<Child> {
    if mask == 0 { None } else { Some(foreseen(wide, mask.trailing_zeros())) }
}

/// The place of the last in an order of those that were met, by their places in it, a bit each.
#[inline(always)]
fn nearest_of(order: u32, met: u32) -> u32 {
    order >> (4 * (31 - met.leading_zeros()))
}

/// The child in a place, of which the lowest three bits count, by a jump.
///
/// A place is known when the boxes have been tested. A jump is foreseen, where the rays before went the same
/// way: then what the child is, and its memory, are there before that. Read by its place, each step would
/// wait for the one before it.
#[inline(always)]
fn foreseen(wide: &Wide, place: u32) -> Child {
    // If the compiler saw through this, it would read by the place.
    match place & 7 {
        0 => *opaque(&wide.children[0]),
        1 => *opaque(&wide.children[1]),
        2 => *opaque(&wide.children[2]),
        3 => *opaque(&wide.children[3]),
        4 => *opaque(&wide.children[4]),
        5 => *opaque(&wide.children[5]),
        6 => *opaque(&wide.children[6]),
        _ => *opaque(&wide.children[7]),
    }
}

/// [`push`](super::push), without a jump: one that takes turns with others has its next step foreseen.
///
/// # Safety
///
/// The processor has AVX2 and FMA.
#[inline(always)]
pub(in crate::trace) unsafe fn push_avx2(
    wide: &Wide,
    ready: &Ready,
    interval: [f32; 2],
    stack: &mut Stack,
) {
    // SAFETY: the same.
    unsafe {
        let passage = ready.pass(wide, interval);
        push_met(wide, ready.octant(), (passage.met(), passage.enter), stack);
    }
}

/// Puts the children that were met, as all ones, on the stack, the farthest first.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
unsafe fn push_met(wide: &Wide, octant: usize, (met, enter): (__m256, __m256), stack: &mut Stack) {
    // SAFETY: the same; an octant is less than eight.
    unsafe {
        let met = ordered(*wide.order.get_unchecked(octant), met);
        push_places(wide, met, enter, met.1.count_ones() as usize, stack);
    }
}

/// Puts children on the stack, as many as `count` of those that [`ordered`] gives, and where the ray enters
/// them.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
unsafe fn push_places(
    wide: &Wide,
    (places, met): (__m256i, u32),
    enter: __m256,
    count: usize,
    stack: &mut Stack,
) {
    // SAFETY: the same; children are eight lanes, aligned like the node.
    unsafe {
        let places = _mm256_permutevar8x32_epi32(places, self::places(met));
        let children = _mm256_load_si256(wide.children.as_ptr().cast());
        let children = _mm256_permutevar8x32_epi32(children, places);
        stack.push_avx2(children, _mm256_permutevar8x32_ps(enter, places), count);
    }
}

/// The places of children in an order, and which of these were met, a bit each. Of each lane the lowest three
/// bits count.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
unsafe fn ordered(order: u32, met: __m256) -> (__m256i, u32) {
    // SAFETY: the same.
    unsafe {
        let places = nibbles(order);
        let met = _mm256_permutevar8x32_epi32(_mm256_castps_si256(met), places);
        (places, _mm256_movemask_ps(_mm256_castsi256_ps(met)) as u32)
    }
}

/// The places of the children that were met, the farthest first, and how many they are. Of each
/// lane the lowest three bits count.
///
/// # Safety
///
/// The processor has AVX2.
#[inline(always)]
pub(in crate::trace) unsafe fn far_to_near_avx2(
    wide: &Wide,
    octant: usize,
    met: __m256,
) -> (__m256i, usize) {
    // SAFETY: the same; an octant is less than eight.
    unsafe {
        let (places, met) = ordered(*wide.order.get_unchecked(octant), met);
        let places = _mm256_permutevar8x32_epi32(places, self::places(met));
        (places, met.count_ones() as usize)
    }
}

/// [`nearest_avx2`] in fewer instructions.
///
/// # Safety
///
/// The processor has AVX-512 and what comes with it.
#[inline(always)]
pub(in crate::trace) unsafe fn nearest_avx512(
    wide: &Wide,
    slabs: &Lanes,
    interval: [f32; 2],
    stack: &mut Stack,
) -> Option<Child> {
    // SAFETY: the same; an octant is less than eight.
    unsafe {
        let passage = pass(wide, slabs, interval);
        let mask = u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(passage.enter, passage.leave));
        if mask & mask.wrapping_sub(1) == 0 {
            return only(wide, mask);
        }
        let order = *wide.order.get_unchecked(slabs.octant);
        let met = push_passed(wide, order, &passage, stack);
        // Known sooner than it could be read.
        stack.take();
        Some(foreseen(wide, nearest_of(order, met)))
    }
}

/// [`push_avx2`] in fewer instructions.
///
/// # Safety
///
/// The processor has AVX-512 and what comes with it.
#[inline(always)]
pub(in crate::trace) unsafe fn push_avx512(
    wide: &Wide,
    ready: &Ready,
    interval: [f32; 2],
    stack: &mut Stack,
) {
    // SAFETY: the same; an octant is less than eight.
    unsafe {
        let passage = ready.pass(wide, interval);
        let order = *wide.order.get_unchecked(ready.octant());
        push_passed(wide, order, &passage, stack);
    }
}

/// Puts the children that are met on the stack, the farthest first. Gives which they are by their places in
/// the order, a bit each.
///
/// # Safety
///
/// The processor has AVX-512 and what comes with it.
#[inline(always)]
unsafe fn push_passed(wide: &Wide, order: u32, passage: &Passage, stack: &mut Stack) -> u32 {
    // SAFETY: the same; children are eight lanes, aligned like the node.
    unsafe {
        let places = nibbles(order);
        let enter = _mm256_permutevar8x32_ps(passage.enter, places);
        let leave = _mm256_permutevar8x32_ps(passage.leave, places);
        let met = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(enter, leave);
        let children = _mm256_load_si256(wide.children.as_ptr().cast());
        let children = _mm256_permutevar8x32_epi32(children, places);
        let children = _mm256_maskz_compress_epi32(met, children);
        let enter = _mm256_maskz_compress_ps(met, enter);
        stack.push_avx2(children, enter, met.count_ones() as usize);
        u32::from(met)
    }
}

/// The places of the bits of a byte, the lowest first.
#[inline]
#[target_feature(enable = "avx2")]
pub(in crate::trace) fn places(byte: u32) -> __m256i {
    nibbles(PLACES[byte as usize & 255])
}

/// Eight numbers of four bits, the lowest first; of each lane the lowest three bits count.
#[inline]
#[target_feature(enable = "avx2")]
fn nibbles(packed: u32) -> __m256i {
    let shifts = _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28);
    _mm256_srlv_epi32(_mm256_set1_epi32(packed as i32), shifts)
}

/// The places of the bits of a byte, four bits each, the lowest first.
static PLACES: [u32; 256] = {
    let mut places = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let (mut rest, mut count) = (byte as u32, 0);
        while rest != 0 {
            places[byte] |= rest.trailing_zeros() << (4 * count);
            rest &= rest - 1;
            count += 1;
        }
        byte += 1;
    }
    places
};
