//! One step down: which children of a wide node the ray meets, and where.

#[cfg(target_arch = "x86_64")]
pub(super) mod avx2;

use super::prepare::{Slabs, greater, lesser};
use super::stack::{Stack, Visit};
use super::wide::{Child, Wide};

/// The nearest of the children that the ray meets in the interval; the others go on the stack, the
/// nearest of them on top.
#[inline(always)]
pub(super) fn step(
    wide: &Wide,
    slabs: &Slabs,
    interval: [f32; 2],
    stack: &mut Stack,
) -> Option<Visit> {
    let mut planes = [[0.0; 2]; 7];
    for lane in 0..7 {
        let axis = (wide.axes() >> (2 * lane)) as usize & 3;
        let t = (wide.planes[lane] - slabs.origin[axis]) * slabs.inverse[axis];
        planes[lane] = [t - slabs.thickness[axis], t + slabs.thickness[axis]];
    }
    let backward = |lane: usize| (slabs.backward >> ((wide.axes() >> (2 * lane)) & 3)) as usize & 1;
    let mut nearest = None;
    for rank in (0..8).rev() {
        let (mut t_min, mut t_max) = (interval[0], interval[1]);
        let mut pass = |lane: usize, far: usize| {
            let [enter, leave] = planes[lane];
            if far == 1 { t_min = greater(t_min, enter) } else { t_max = lesser(t_max, leave) }
        };
        // By level: whether the child is beyond the plane.
        let far = [rank >> 2, rank >> 1 & 1, rank & 1];
        let half = far[0] ^ backward(3);
        pass(3, far[0]);
        let quarter = far[1] ^ backward(4 * half);
        pass(4 * half, far[1]);
        let lane = 4 * half + 1 + quarter;
        pass(lane, far[2]);
        let child = wide.children[4 * half + 2 * quarter + (far[2] ^ backward(lane))];
        if t_min > t_max || child == Child::EMPTY {
            continue;
        }
        if let Some(farther) = nearest.replace(Visit { child, t_min, t_max }) {
            stack.push(farther);
        }
    }
    nearest
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::geometry::Ray;

    /// Numbers without a pattern, in 0..1.
    fn noise(state: &mut u32) -> f32 {
        *state = state.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (*state >> 8) as f32 / (1 << 24) as f32
    }

    fn random_wide(state: &mut u32) -> Wide {
        let mut axes = 0;
        let planes = [0, 1, 2, 3, 4, 5, 6, 7].map(|lane: u32| {
            axes |= ((noise(state) * 3.0) as u32) << (2 * lane);
            if noise(state) < 0.1 { f32::INFINITY } else { noise(state) }
        });
        let mut wide = Wide {
            planes,
            children: [0, 1, 2, 3, 4, 5, 6, 7]
                .map(|child| if noise(state) < 0.2 { Child::EMPTY } else { Child(child) }),
        };
        wide.planes[7] = f32::from_bits(axes & 0x3fff);
        wide
    }

    fn visits(nearest: Option<Visit>, mut stack: Stack) -> Vec<Visit> {
        nearest.into_iter().chain(std::iter::from_fn(|| stack.pop())).collect()
    }

    #[test]
    fn avx2_steps_like_the_plain_step() {
        if !std::arch::is_x86_feature_detected!("avx2") {
            println!("this processor has no AVX2: its path was not tested");
            return;
        }
        let mut state = 7;
        let mut met = 0;
        for _ in 0..100_000 {
            let wide = random_wide(&mut state);
            let mut component = || {
                if noise(&mut state) < 0.1 { 0.0 } else { 2.0 * noise(&mut state) - 1.0 }
            };
            let (origin, direction) =
                ([component(), component(), component()], [component(), component(), 0.5]);
            let slabs = Slabs::new(&Ray::new(origin, direction), 1.0);
            let interval = [0.2 * noise(&mut state), 2.0 * noise(&mut state)];
            let (mut plain, mut lanes) = (Stack::new(), Stack::new());
            let nearest = step(&wide, &slabs, interval, &mut plain);
            let plain = visits(nearest, plain);
            // SAFETY: the processor has AVX2.
            let nearest = unsafe {
                avx2::step::<()>(&wide, &slabs, &avx2::Lanes::new(&slabs), interval, &mut lanes)
            };
            met += plain.len();
            assert_eq!(plain, visits(nearest, lanes), "{wide:?} {slabs:?} {interval:?}");
        }
        assert!(met > 100_000, "only {met} children were met");
    }
}
