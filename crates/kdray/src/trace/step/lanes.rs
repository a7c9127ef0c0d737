//! The step with all boxes at once.
//!
//! `V` is what a traversal is for, here and in other places with instructions of their own: each
//! traversal has functions of its own, so that the compiler makes them part of its loop.

use std::arch::x86_64::*;

use super::axes::Axes;
use super::nearer_of_two;
use crate::geometry::Ray;
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
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(in crate::trace) fn new(ray: &Ray, reach: f32) -> Self {
        let Axes { inverse, enter, leave, octant } = Axes::new(ray, reach);
        let axes = |v: __m128| {
            [v, _mm_movehdup_ps(v), _mm_movehl_ps(v, v)].map(|axis| _mm256_broadcastss_ps(axis))
        };
        Self { inverse: axes(inverse), enter: axes(enter), leave: axes(leave), octant }
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
struct Passage {
    enter: __m256,
    leave: __m256,
}

/// [`meet`](super::meet) with all boxes at once, but for the comparison. Products and differences are
/// rounded together, so less than planes are thick for.
#[inline]
#[target_feature(enable = "avx2,fma")]
fn pass<V>(wide: &Wide, slabs: &Lanes, [t_min, t_max]: [f32; 2]) -> Passage {
    let bounds = std::ptr::from_ref(&wide.bounds).cast::<u8>();
    // Read last, and on a line of their own.
    _mm_prefetch::<_MM_HINT_T0>(wide.children.as_ptr().cast());
    // SAFETY: an octant is less than eight.
    let rows = unsafe { ROWS.get_unchecked(slabs.octant) };
    // SAFETY: there are six rows; they are eight lanes each, aligned like the node.
    let row = |at: usize| unsafe { _mm256_load_ps(bounds.add(rows[at]).cast()) };
    let near = |axis| _mm256_fmsub_ps(row(axis), slabs.inverse[axis], slabs.enter[axis]);
    let far = |axis| _mm256_fmsub_ps(row(3 + axis), slabs.inverse[axis], slabs.leave[axis]);
    // In pairs: nothing waits for three in a row.
    let enter = _mm256_max_ps(
        _mm256_max_ps(near(0), near(1)),
        _mm256_max_ps(near(2), _mm256_set1_ps(t_min)),
    );
    let leave =
        _mm256_min_ps(_mm256_min_ps(far(0), far(1)), _mm256_min_ps(far(2), _mm256_set1_ps(t_max)));
    Passage { enter, leave }
}

/// [`nearest`](super::nearest), with jumps for one child and for two: a single ray waits for nothing but
/// the result.
#[inline]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
pub(in crate::trace) fn nearest_avx2<V>(
    wide: &Wide,
    slabs: &Lanes,
    interval: [f32; 2],
    stack: &mut Stack,
) -> Option<Child> {
    let Passage { enter, leave } = pass::<V>(wide, slabs, interval);
    let met = _mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave);
    let mask = _mm256_movemask_ps(met) as u32;
    if mask & mask.wrapping_sub(1) == 0 {
        // One child or none, most of the time.
        return (mask != 0).then(|| wide.children[mask.trailing_zeros() as usize & 7]);
    }
    let rest = mask & (mask - 1);
    if rest & (rest - 1) == 0 {
        let mut t_enter = [0.0; 8];
        // SAFETY: eight lanes fit.
        unsafe { _mm256_storeu_ps(t_enter.as_mut_ptr(), enter) };
        return Some(nearer_of_two(wide, mask, &t_enter, stack));
    }
    push_met::<V>(wide, slabs.octant, (met, enter), stack);
    Some(stack.take())
}

/// [`push`](super::push), without a jump: one that takes turns with others has its next step foreseen.
#[inline]
#[target_feature(enable = "avx2,fma,popcnt")]
pub(in crate::trace) fn push_avx2<V>(
    wide: &Wide,
    slabs: &Lanes,
    interval: [f32; 2],
    stack: &mut Stack,
) {
    let Passage { enter, leave } = pass::<V>(wide, slabs, interval);
    push_met::<V>(wide, slabs.octant, (_mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave), enter), stack);
}

/// Puts the children that were met, as all ones, on the stack, the farthest first.
#[inline]
#[target_feature(enable = "avx2,popcnt")]
fn push_met<V>(wide: &Wide, octant: usize, (met, enter): (__m256, __m256), stack: &mut Stack) {
    let (places, count) = far_to_near_avx2::<V>(wide, octant, met);
    // SAFETY: eight lanes, aligned like the node.
    let children = unsafe { _mm256_load_si256(wide.children.as_ptr().cast()) };
    let children = _mm256_permutevar8x32_epi32(children, places);
    stack.push_avx2(children, _mm256_permutevar8x32_ps(enter, places), count);
}

/// The places of the children that were met, the farthest first, and how many they are. Of each
/// lane the lowest three bits count.
#[inline]
#[target_feature(enable = "avx2,popcnt")]
#[expect(clippy::extra_unused_type_parameters, reason = "one function a traversal")]
pub(in crate::trace) fn far_to_near_avx2<V>(
    wide: &Wide,
    octant: usize,
    met: __m256,
) -> (__m256i, usize) {
    // SAFETY: an octant is less than eight.
    let places = nibbles(unsafe { *wide.order.get_unchecked(octant) });
    let met = _mm256_permutevar8x32_epi32(_mm256_castps_si256(met), places);
    let met = _mm256_movemask_ps(_mm256_castsi256_ps(met)) as u32;
    let places = _mm256_permutevar8x32_epi32(places, self::places(met));
    (places, met.count_ones() as usize)
}

/// [`nearest_avx2`] with a jump less: two children take no way of their own.
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,lzcnt,popcnt")]
pub(in crate::trace) fn nearest_avx512<V>(
    wide: &Wide,
    slabs: &Lanes,
    interval: [f32; 2],
    stack: &mut Stack,
) -> Option<Child> {
    let passage = pass::<V>(wide, slabs, interval);
    let mask = u32::from(_mm256_cmp_ps_mask::<_CMP_LE_OQ>(passage.enter, passage.leave));
    if mask & mask.wrapping_sub(1) == 0 {
        return (mask != 0).then(|| wide.children[mask.trailing_zeros() as usize & 7]);
    }
    // SAFETY: an octant is less than eight.
    let order = unsafe { *wide.order.get_unchecked(slabs.octant) };
    let met = push_ordered::<V>(wide, order, &passage, 1, stack);
    let nearest = 31 - u32::from(met).leading_zeros();
    Some(wide.children[(order >> (4 * nearest)) as usize & 7])
}

/// [`push_avx2`] in fewer instructions.
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,lzcnt,popcnt")]
pub(in crate::trace) fn push_avx512<V>(
    wide: &Wide,
    slabs: &Lanes,
    interval: [f32; 2],
    stack: &mut Stack,
) {
    let passage = pass::<V>(wide, slabs, interval);
    // SAFETY: an octant is less than eight.
    let order = unsafe { *wide.order.get_unchecked(slabs.octant) };
    push_ordered::<V>(wide, order, &passage, 0, stack);
}

/// Puts the children that are met on the stack, the farthest first, but for so many of the nearest. Gives
/// which are met, in the same order.
#[inline]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,popcnt")]
fn push_ordered<V>(
    wide: &Wide,
    order: u32,
    passage: &Passage,
    but: usize,
    stack: &mut Stack,
) -> __mmask8 {
    let places = nibbles(order);
    let enter = _mm256_permutevar8x32_ps(passage.enter, places);
    let leave = _mm256_permutevar8x32_ps(passage.leave, places);
    let met = _mm256_cmp_ps_mask::<_CMP_LE_OQ>(enter, leave);
    // SAFETY: eight lanes, aligned like the node.
    let children = unsafe { _mm256_load_si256(wide.children.as_ptr().cast()) };
    let children = _mm256_permutevar8x32_epi32(children, places);
    let children = _mm256_maskz_compress_epi32(met, children);
    let count = met.count_ones() as usize - but;
    stack.push_avx2(children, _mm256_maskz_compress_ps(met, enter), count);
    met
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
