//! One step down: which children of a wide node the ray meets, in which order, and where.

#[cfg(target_arch = "x86_64")]
mod axes;
#[cfg(target_arch = "x86_64")]
mod lanes;
#[cfg(target_arch = "x86_64")]
mod ready;

use super::prepare::{Slabs, greater, lesser};
use super::stack::Stack;
use super::wide::{Child, Wide};
#[cfg(target_arch = "x86_64")]
pub(super) use axes::{halves, is_valid, largest, magnitude, signs};
#[cfg(target_arch = "x86_64")]
pub(super) use lanes::{
    Lanes, ROW, ROWS, far_to_near_avx2, nearest_avx2, nearest_avx512, places, push_avx2,
    push_avx512,
};
#[cfg(target_arch = "x86_64")]
pub(super) use ready::Ready;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Ray};
    use crate::trace::noise::noise;
    #[cfg(target_arch = "x86_64")]
    use crate::trace::simd::{Avx2, Avx512};
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

    /// The steps of `simd` beside those of the definition, with the roundings of `t`. Some have no way of
    /// their own for two children.
    fn steps_like_the_plain_step(simd: impl Simd, t: fn(f32, f32, f32) -> f32, has_two: bool) {
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
            let plain = if has_two {
                nearest(&wide, slabs.octant(), &met, a)
            } else {
                push(&wide, slabs.octant(), &met, a);
                a.pop(f32::INFINITY)
            };
            push(&wide, slabs.octant(), &met, b);
            let lanes = simd.slabs(&ray, 1.0);
            let fast = simd.nearest(&wide, &lanes, interval, c);
            simd.push(&wide, &simd.ready(&ray, 1.0), interval, d);
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
        match Best::detect() {
            #[cfg(target_arch = "x86_64")]
            Best::Avx2(proof) => {
                println!("this processor has no AVX-512: its steps were not tested");
                steps_like_the_plain_step(Avx2::from(proof), fused, false);
            }
            #[cfg(target_arch = "x86_64")]
            Best::Avx512(proof) => {
                steps_like_the_plain_step(Avx2::from(proof.avx2()), fused, false);
                steps_like_the_plain_step(Avx512::from(proof), fused, false);
            }
            #[cfg(target_arch = "aarch64")]
            Best::Neon(neon) => steps_like_the_plain_step(neon, |p, i, o| p * i - o, true),
            Best::Plain => println!("this processor has no fast path: none was tested"),
        }
    }
}
