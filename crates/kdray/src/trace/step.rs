//! One step down: which children of a wide node the ray meets, in which order, and where.

#[cfg(target_arch = "x86_64")]
use super::prepare::{SMALLEST, THICKNESS};
use super::prepare::{Slabs, greater, lesser};
use super::stack::Stack;
use super::wide::{Child, Wide};
#[cfg(target_arch = "x86_64")]
use crate::geometry::Ray;

/// The children that a ray meets, and where it enters them.
#[derive(Clone, Copy)]
pub(super) struct Met {
    pub(super) mask: u32,
    pub(super) t_enter: [f32; 8],
}

/// The children that the ray meets in `t_min..=t_max`. Tests the boxes one after the other.
#[inline(always)]
pub(super) fn meet(wide: &Wide, slabs: &Slabs, interval: [f32; 2]) -> Met {
    meet_by(|position, inverse, offset| position * inverse - offset, wide, slabs, interval)
}

/// The same, with the `t` of a plane by a function.
#[inline(always)]
fn meet_by(
    t: impl Fn(f32, f32, f32) -> f32,
    wide: &Wide,
    slabs: &Slabs,
    [t_min, t_max]: [f32; 2],
) -> Met {
    let mut met = Met { mask: 0, t_enter: [t_min; 8] };
    for child in 0..8 {
        let mut leave = t_max;
        for axis in 0..3 {
            let backward = slabs.backward[axis];
            let [near, far] = [backward, 1 - backward].map(|end| wide.bounds[end][axis][child]);
            let near = t(near, slabs.inverse[axis], slabs.enter[axis]);
            met.t_enter[child] = greater(met.t_enter[child], near);
            leave = lesser(leave, t(far, slabs.inverse[axis], slabs.leave[axis]));
        }
        met.mask |= u32::from(met.t_enter[child] <= leave) << child;
    }
    met
}

/// The nearest of the children that were met; the others go on the stack, the farthest first.
#[inline(always)]
pub(super) fn nearest(wide: &Wide, octant: usize, met: &Met, stack: &mut Stack) -> Option<Child> {
    if met.mask.count_ones() == 2 {
        return Some(nearer_of_two(wide, met.mask, &met.t_enter, stack));
    }
    let mut nearest = None;
    for child in wide.far_to_near(octant).filter(|child| met.mask >> child & 1 == 1) {
        if let Some(farther) = nearest.replace(child) {
            stack.push(wide.children[farther], met.t_enter[farther]);
        }
    }
    nearest.map(|child| wide.children[child])
}

/// Puts the children that were met on the stack, the farthest first.
#[inline(always)]
pub(super) fn push(wide: &Wide, octant: usize, met: &Met, stack: &mut Stack) {
    for child in wide.far_to_near(octant).filter(|child| met.mask >> child & 1 == 1) {
        stack.push(wide.children[child], met.t_enter[child]);
    }
}

/// Of two children that were met, the one that the ray enters first; the other goes on the stack.
/// It is the same by the order of the octant, but takes longer to find out.
#[inline(always)]
pub(super) fn nearer_of_two(
    wide: &Wide,
    mask: u32,
    t_enter: &[f32; 8],
    stack: &mut Stack,
) -> Child {
    let [a, b] = [mask, mask & (mask - 1)].map(|mask| mask.trailing_zeros() as usize & 7);
    let (near, far) = if t_enter[b] < t_enter[a] { (b, a) } else { (a, b) };
    stack.push(wide.children[far], t_enter[far]);
    wide.children[near]
}

#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(super) struct Lanes {
    inverse: [std::arch::x86_64::__m256; 3],
    enter: [std::arch::x86_64::__m256; 3],
    leave: [std::arch::x86_64::__m256; 3],
    pub(super) octant: usize,
}

#[cfg(target_arch = "x86_64")]
impl Lanes {
    /// The arithmetic of [`Slabs::new`], on all axes at once.
    #[inline]
    #[target_feature(enable = "avx2")]
    pub(super) fn new(ray: &Ray, reach: f32) -> Self {
        use std::arch::x86_64::*;
        let all = |value: f32| _mm_set1_ps(value);
        let magnitude = |v: __m128| _mm_andnot_ps(all(-0.0), v);
        let largest = |v: __m128| {
            let two = _mm_max_ss(v, _mm_movehdup_ps(v));
            _mm_broadcastss_ps(_mm_max_ss(two, _mm_movehl_ps(v, v)))
        };
        // SAFETY: a ray is eight numbers; the fourth lanes, its limits, are of no consequence.
        let [origin, direction] = unsafe {
            let start = std::ptr::from_ref(ray).cast::<f32>();
            [_mm_loadu_ps(start), _mm_loadu_ps(start.add(4))]
        };
        let smallest = _mm_mul_ps(all(SMALLEST), largest(magnitude(direction)));
        let reach = _mm_add_ps(largest(magnitude(origin)), all(reach));
        let thickness = _mm_mul_ps(all(THICKNESS), reach);
        let small = _mm_cmplt_ps(magnitude(direction), smallest);
        let signed = _mm_or_ps(_mm_and_ps(all(-0.0), direction), smallest);
        let inverse = _mm_div_ps(all(1.0), _mm_blendv_ps(direction, signed, small));
        let offset = _mm_mul_ps(origin, inverse);
        let thick = _mm_mul_ps(thickness, magnitude(inverse));
        let axes = |v: __m128| {
            [v, _mm_movehdup_ps(v), _mm_movehl_ps(v, v)].map(|axis| _mm256_broadcastss_ps(axis))
        };
        Self {
            inverse: axes(inverse),
            enter: axes(_mm_add_ps(offset, thick)),
            leave: axes(_mm_sub_ps(offset, thick)),
            octant: _mm_movemask_ps(inverse) as usize & 7,
        }
    }
}

/// By octant: of a node's six rows of bounds those that come first, by axis, and then those that
/// come last.
#[cfg(target_arch = "x86_64")]
pub(super) static ROWS: [[usize; 6]; 8] = {
    let mut rows = [[0; 6]; 8];
    let mut octant = 0;
    while octant < 8 {
        let mut axis = 0;
        while axis < 3 {
            let backward = octant >> axis & 1;
            rows[octant][axis] = 3 * backward + axis;
            rows[octant][3 + axis] = 3 * (1 - backward) + axis;
            axis += 1;
        }
        octant += 1;
    }
    rows
};

/// The children that a ray meets, as all ones, and where it enters them.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy)]
pub(super) struct MetLanes {
    met: std::arch::x86_64::__m256,
    t_enter: std::arch::x86_64::__m256,
}

/// [`meet`] with all boxes at once. Products and differences are rounded together, so less than planes
/// are thick for.
///
/// `V` is the visitor of the traversal, here and below: each traversal has functions of its own, so
/// that the compiler makes them part of the loop.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx2,fma")]
#[expect(clippy::extra_unused_type_parameters, reason = "one function a traversal")]
pub(super) fn meet_avx2<V>(wide: &Wide, slabs: &Lanes, [t_min, t_max]: [f32; 2]) -> MetLanes {
    use std::arch::x86_64::*;
    let bounds = wide.bounds.as_flattened();
    // SAFETY: an octant is less than eight.
    let rows = unsafe { ROWS.get_unchecked(slabs.octant) };
    // SAFETY: there are six rows; they are eight lanes each, aligned like the node.
    let row = |at: usize| unsafe { _mm256_load_ps(bounds.get_unchecked(rows[at]).as_ptr()) };
    let near = |axis| _mm256_fmsub_ps(row(axis), slabs.inverse[axis], slabs.enter[axis]);
    let far = |axis| _mm256_fmsub_ps(row(3 + axis), slabs.inverse[axis], slabs.leave[axis]);
    // In pairs: nothing waits for three in a row.
    let t_enter = _mm256_max_ps(
        _mm256_max_ps(near(0), near(1)),
        _mm256_max_ps(near(2), _mm256_set1_ps(t_min)),
    );
    let leave =
        _mm256_min_ps(_mm256_min_ps(far(0), far(1)), _mm256_min_ps(far(2), _mm256_set1_ps(t_max)));
    MetLanes { met: _mm256_cmp_ps::<_CMP_LE_OQ>(t_enter, leave), t_enter }
}

/// [`nearest`], with jumps for one child and for two: a single ray waits for nothing but the result.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx2,bmi1,lzcnt,popcnt")]
pub(super) fn nearest_avx2<V>(
    wide: &Wide,
    octant: usize,
    lanes: &MetLanes,
    stack: &mut Stack,
) -> Option<Child> {
    use std::arch::x86_64::*;
    let mask = _mm256_movemask_ps(lanes.met) as u32;
    if mask & mask.wrapping_sub(1) == 0 {
        // One child or none, most of the time.
        return (mask != 0).then(|| wide.children[mask.trailing_zeros() as usize & 7]);
    }
    let rest = mask & (mask - 1);
    if rest & (rest - 1) == 0 {
        let mut t_enter = [0.0; 8];
        // SAFETY: eight lanes fit.
        unsafe { _mm256_storeu_ps(t_enter.as_mut_ptr(), lanes.t_enter) };
        return Some(nearer_of_two(wide, mask, &t_enter, stack));
    }
    push_avx2::<V>(wide, octant, lanes, stack);
    Some(stack.take())
}

/// [`push`], without a jump: one that takes turns with others has its next step foreseen.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx2,popcnt")]
pub(super) fn push_avx2<V>(wide: &Wide, octant: usize, lanes: &MetLanes, stack: &mut Stack) {
    use std::arch::x86_64::*;
    let (places, count) = far_to_near_avx2::<V>(wide, octant, lanes.met);
    // SAFETY: eight lanes, aligned like the node.
    let children = unsafe { _mm256_load_si256(wide.children.as_ptr().cast()) };
    let children = _mm256_permutevar8x32_epi32(children, places);
    let t_enter = _mm256_permutevar8x32_ps(lanes.t_enter, places);
    stack.push_avx2(children, t_enter, count);
}

/// The places of the children that were met, the farthest first, and how many they are. Of each
/// lane the lowest three bits count.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx2,popcnt")]
#[expect(clippy::extra_unused_type_parameters, reason = "one function a traversal")]
pub(super) fn far_to_near_avx2<V>(
    wide: &Wide,
    octant: usize,
    met: std::arch::x86_64::__m256,
) -> (std::arch::x86_64::__m256i, usize) {
    use std::arch::x86_64::*;
    // SAFETY: an octant is less than eight.
    let places = nibbles(unsafe { *wide.order.get_unchecked(octant) });
    let met = _mm256_permutevar8x32_epi32(_mm256_castps_si256(met), places);
    let met = _mm256_movemask_ps(_mm256_castsi256_ps(met)) as u32;
    let places = _mm256_permutevar8x32_epi32(places, self::places(met));
    (places, met.count_ones() as usize)
}

/// The places of the bits of a byte, the lowest first.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx2")]
pub(super) fn places(byte: u32) -> std::arch::x86_64::__m256i {
    nibbles(PLACES[byte as usize & 255])
}

/// Eight numbers of four bits, the lowest first; of each lane the lowest three bits count.
#[cfg(target_arch = "x86_64")]
#[inline]
#[target_feature(enable = "avx2")]
fn nibbles(packed: u32) -> std::arch::x86_64::__m256i {
    use std::arch::x86_64::*;
    let shifts = _mm256_setr_epi32(0, 4, 8, 12, 16, 20, 24, 28);
    _mm256_srlv_epi32(_mm256_set1_epi32(packed as i32), shifts)
}

/// The places of the bits of a byte, four bits each, the lowest first.
#[cfg(target_arch = "x86_64")]
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Ray};
    use crate::trace::noise::noise;
    #[cfg(target_arch = "x86_64")]
    use crate::trace::simd::Avx2;
    use crate::trace::simd::{Best, Simd};

    fn random_wide(state: &mut u32) -> Wide {
        let mut wide = Wide::EMPTY;
        for place in 0..(8.9 * noise(state)) as usize {
            let mut corner = || [noise(state), noise(state), noise(state)];
            let bounds = Aabb::of_points(&[corner(), corner()]);
            wide.set(place, &bounds, Child(place as u32));
        }
        let order = [(); 8].map(|()| {
            let mut places = [0, 1, 2, 3, 4, 5, 6, 7];
            for last in (1..8).rev() {
                places.swap(last, ((last + 1) as f32 * noise(state)) as usize);
            }
            places.iter().fold(0, |order, place| order << 4 | place)
        });
        wide.set_order(order, 8);
        wide
    }

    /// The nearest child and then what is on the stack.
    fn popped(nearest: Option<Child>, mut stack: Stack) -> Vec<Child> {
        let rest = std::iter::from_fn(|| stack.pop(f32::INFINITY));
        nearest.into_iter().chain(rest).collect()
    }

    /// The steps of `simd` beside those of the definition, with the roundings of `t`.
    fn steps_like_the_plain_step(simd: impl Simd, t: fn(f32, f32, f32) -> f32) {
        let mut state = 7;
        let mut count = 0;
        for _ in 0..200_000 {
            let wide = random_wide(&mut state);
            let mut component =
                || if noise(&mut state) < 0.1 { 0.0 } else { 2.0 * noise(&mut state) - 1.0 };
            let origin = [0.5 + 0.5 * component(), 0.5 + 0.5 * component(), component()];
            let direction = [0.3 * component(), 0.3 * component(), 0.5 * component()];
            let ray = Ray::new(origin, direction);
            if !ray.is_valid() {
                continue;
            }
            let slabs = Slabs::new(&ray, 1.0);
            let interval = [0.2 * noise(&mut state), 20.0 * noise(&mut state)];
            let mut stacks = [(); 4].map(|()| Stack::new());
            let [a, b, c, d] = &mut stacks;
            let met = meet_by(t, &wide, &slabs, interval);
            let plain = nearest(&wide, slabs.octant(), &met, a);
            push(&wide, slabs.octant(), &met, b);
            let lanes = simd.slabs(&ray, 1.0);
            let fast = simd.nearest(&wide, &lanes, interval, c);
            simd.push(&wide, &lanes, interval, d);
            let [a, b, c, d] = stacks;
            let (plain, fast) = (popped(plain, a), popped(fast, c));
            assert_eq!(plain, fast, "{wide:?} {slabs:?} {interval:?}");
            assert_eq!(popped(None, b), popped(None, d), "{wide:?} {slabs:?} {interval:?}");
            count += plain.len();
        }
        assert!(count > 40_000, "only {count} children were met");
    }

    #[test]
    #[cfg_attr(
        target_arch = "x86_64",
        expect(clippy::disallowed_methods, reason = "what the instruction does")
    )]
    fn fast_steps_are_like_the_plain_step() {
        #[cfg(target_arch = "x86_64")]
        let fused = |position: f32, inverse: f32, offset: f32| position.mul_add(inverse, -offset);
        #[cfg(target_arch = "x86_64")]
        let with_avx2 = |proof| steps_like_the_plain_step(Avx2::<()>::from(proof), fused);
        match Best::detect() {
            #[cfg(target_arch = "x86_64")]
            Best::Avx2(proof) => with_avx2(proof),
            #[cfg(target_arch = "x86_64")]
            Best::Avx512(proof) => with_avx2(proof.avx2()),
            #[cfg(target_arch = "aarch64")]
            Best::Neon(neon) => steps_like_the_plain_step(neon, |p, i, o| p * i - o),
            Best::Plain => println!("this processor has no fast path: none was tested"),
        }
    }
}
