//! The step of [`super::step`] for all children at once: the same arithmetic, the same order.

use std::arch::x86_64::*;

use super::super::prepare::{Slabs, greater, lesser};
use super::super::stack::{Stack, Visit};
use super::super::wide::{Child, Wide};

/// A ray's [`Slabs`] in registers, once in each half.
#[derive(Clone, Copy)]
pub(in super::super) struct Lanes {
    origin: __m256,
    inverse: __m256,
    thickness: __m256,
}

impl Lanes {
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(in super::super) fn new(slabs: &Slabs) -> Self {
        let both = |[x, y, z]: [f32; 3]| _mm256_setr_ps(x, y, z, 0.0, x, y, z, 0.0);
        Self {
            origin: both(slabs.origin),
            inverse: both(slabs.inverse),
            thickness: both(slabs.thickness),
        }
    }
}

/// As [`super::step`].
///
/// `V` is the visitor of the traversal, so that each traversal has a step of its own and the
/// compiler makes it part of the loop: a call would send every lane through memory.
#[inline]
#[target_feature(enable = "avx2")]
pub(in super::super) fn step<V>(
    wide: &Wide,
    slabs: &Slabs,
    lanes: &Lanes,
    interval: [f32; 2],
    stack: &mut Stack,
) -> Option<Visit> {
    let axis = (wide.axes() >> 6) as usize & 3;
    let top = (wide.planes[3] - slabs.origin[axis]) * slabs.inverse[axis];
    let top = [top - slabs.thickness[axis], top + slabs.thickness[axis]];
    let backward = slabs.backward >> axis & 1;

    let turned = Turned::new::<V>(wide, lanes, backward);
    let [t_min, t_max] = turned.intervals::<V>(interval, top);
    let children = turned.children::<V>();
    take_met::<V>([children, t_min, t_max], stack)
}

/// A wide node as the ray sees it: the near half in the low lanes.
struct Turned {
    /// Where the ray passes the planes, earlier and later by their thickness.
    enter: __m256,
    leave: __m256,
    children: __m256,
    /// All ones where the second level's plane is passed downwards.
    second: __m256i,
    /// Likewise the third level's plane above each child.
    third: __m256i,
    /// Lane, in its half, of the third level's plane above each child.
    third_lane: __m256i,
}

impl Turned {
    #[inline]
    #[target_feature(enable = "avx2")]
    fn new<V>(wide: &Wide, lanes: &Lanes, backward: u32) -> Self {
        let near = 4 * backward as usize;
        // SAFETY: both halves are four of eight lanes.
        let (planes, children) = unsafe {
            let planes = wide.planes.as_ptr();
            let children = wide.children.as_ptr().cast::<f32>();
            (
                _mm256_loadu2_m128(planes.add(4 - near), planes.add(near)),
                _mm256_loadu2_m128(children.add(4 - near), children.add(near)),
            )
        };
        let axes = (wide.axes() | wide.axes() << 16) >> (8 * backward);
        let shifts = _mm256_setr_epi32(0, 2, 4, 6, 8, 10, 12, 14);
        let axes = _mm256_srlv_epi32(_mm256_set1_epi32(axes as i32), shifts);

        let inverse = _mm256_permutevar_ps(lanes.inverse, axes);
        let distance = _mm256_sub_ps(planes, _mm256_permutevar_ps(lanes.origin, axes));
        let t = _mm256_mul_ps(distance, inverse);
        let thickness = _mm256_permutevar_ps(lanes.thickness, axes);

        let signs = _mm256_srai_epi32::<31>(_mm256_castps_si256(inverse));
        let second = _mm256_shuffle_epi32::<0>(signs);
        // Planes 1 and 2 of each half, that of the near quarter first.
        let third_lane = _mm256_xor_si256(
            _mm256_setr_epi32(1, 1, 2, 2, 1, 1, 2, 2),
            _mm256_and_si256(second, _mm256_set1_epi32(3)),
        );
        let third = _mm256_permutevar_ps(_mm256_castsi256_ps(signs), third_lane);
        Self {
            enter: _mm256_sub_ps(t, thickness),
            leave: _mm256_add_ps(t, thickness),
            children,
            second,
            third: _mm256_castps_si256(third),
            third_lane,
        }
    }

    /// The part of the ray inside each child, in the order in which the ray comes to them.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn intervals<V>(&self, [t_min, t_max]: [f32; 2], top: [f32; 2]) -> [__m256; 2] {
        let (never, ever) = (_mm256_set1_ps(f32::NEG_INFINITY), _mm256_set1_ps(f32::INFINITY));
        // First level: the near half leaves at the plane, the far half enters there.
        let t_mins = _mm256_set_m128(_mm_set1_ps(greater(t_min, top[0])), _mm_set1_ps(t_min));
        let t_maxs = _mm256_set_m128(_mm_set1_ps(t_max), _mm_set1_ps(lesser(t_max, top[1])));

        // Second level: the near quarters are the even pairs.
        let enter = _mm256_permute_ps::<0>(self.enter);
        let leave = _mm256_permute_ps::<0>(self.leave);
        let t_mins = _mm256_max_ps(t_mins, _mm256_blend_ps::<0b1100_1100>(never, enter));
        let t_maxs = _mm256_min_ps(t_maxs, _mm256_blend_ps::<0b0011_0011>(ever, leave));

        // Third level: the near children are the even ones.
        let enter = _mm256_permutevar_ps(self.enter, self.third_lane);
        let leave = _mm256_permutevar_ps(self.leave, self.third_lane);
        let t_mins = _mm256_max_ps(t_mins, _mm256_blend_ps::<0b1010_1010>(never, enter));
        let t_maxs = _mm256_min_ps(t_maxs, _mm256_blend_ps::<0b0101_0101>(ever, leave));
        [t_mins, t_maxs]
    }

    /// The children, in that order.
    #[inline]
    #[target_feature(enable = "avx2")]
    fn children<V>(&self) -> __m256 {
        let quarter = _mm256_and_si256(self.second, _mm256_set1_epi32(2));
        let eighth = _mm256_and_si256(self.third, _mm256_set1_epi32(1));
        let turned = _mm256_or_si256(quarter, eighth);
        let order = _mm256_xor_si256(_mm256_setr_epi32(0, 1, 2, 3, 0, 1, 2, 3), turned);
        _mm256_permutevar_ps(self.children, order)
    }
}

/// Eight lanes in memory.
#[repr(align(32))]
struct Spilled([f32; 8]);

/// The nearest of the children whose interval is not empty; the others go on the stack.
///
/// The next step waits for the nearest, so it takes the short way: the lanes are in memory before
/// it is known which of them is wanted.
#[inline]
#[target_feature(enable = "avx2")]
fn take_met<V>([children, t_mins, t_maxs]: [__m256; 3], stack: &mut Stack) -> Option<Visit> {
    let met = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(t_mins, t_maxs));
    let nothing = _mm256_set1_epi32(Child::EMPTY.0 as i32);
    let empty = _mm256_cmpeq_epi32(_mm256_castps_si256(children), nothing);
    let met = (met & !_mm256_movemask_ps(_mm256_castsi256_ps(empty))) as usize;
    let mut spilled = [const { Spilled([0.0; 8]) }; 3];
    // SAFETY: each takes eight lanes and is aligned for them.
    unsafe {
        _mm256_store_ps(spilled[0].0.as_mut_ptr(), children);
        _mm256_store_ps(spilled[1].0.as_mut_ptr(), t_mins);
        _mm256_store_ps(spilled[2].0.as_mut_ptr(), t_maxs);
    }
    if met == 0 {
        return None;
    }
    let others = met & (met - 1);
    // SAFETY: a row of the table has eight bytes.
    let order = unsafe { _mm_loadl_epi64(DESCENDING[others].as_ptr().cast()) };
    let order = _mm256_cvtepu8_epi32(order);
    let sorted = |lanes| _mm256_permutevar8x32_ps(lanes, order);
    let visits = [sorted(children), sorted(t_mins), sorted(t_maxs)];
    stack.push_lanes(visits, others.count_ones() as usize);
    let nearest = met.trailing_zeros() as usize & 7;
    Some(Visit {
        child: Child(spilled[0].0[nearest].to_bits()),
        t_min: spilled[1].0[nearest],
        t_max: spilled[2].0[nearest],
    })
}

/// For every set of lanes, the lanes in it from the highest down.
static DESCENDING: [[u8; 8]; 256] = descending();

const fn descending() -> [[u8; 8]; 256] {
    let mut table = [[0; 8]; 256];
    let mut set = 0;
    while set < 256 {
        let (mut lane, mut count) = (8, 0);
        while lane > 0 {
            lane -= 1;
            if set >> lane & 1 == 1 {
                table[set][count] = lane as u8;
                count += 1;
            }
        }
        set += 1;
    }
    table
}
