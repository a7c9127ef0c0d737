//! The arithmetic of a traversal with NEON: boxes and triangles eight at once.

use super::block::Block;
use super::prepare::{Shear, Slabs};
use super::sift::{filtered, sheared};
use super::sifted::{Sifted, Wants};
use super::simd::{Neon, Simd};
use super::stack::Stack;
use super::step::{Met, nearer_of_two};
use super::vector::{Arithmetic, Eight, Mask, Numbers, Vector};
use super::wide::{Child, Wide};
use crate::geometry::{Hit, Ray};

/// A ray ready for boxes, in every lane.
pub(super) struct SlabLanes {
    inverse: [Eight; 3],
    enter: [Eight; 3],
    leave: [Eight; 3],
    backward: [usize; 3],
    octant: usize,
}

/// A ray ready for triangles, in every lane.
pub(super) struct ShearLanes {
    shear: Shear,
    origin: [Eight; 3],
    slope: [Eight; 2],
    t_per_z: Eight,
}

impl Neon {
    /// A number in every lane.
    #[inline(always)]
    fn all(self, number: f32) -> Eight {
        self.load(&[number; 8])
    }

    #[inline(always)]
    fn load(self, numbers: &[f32; 8]) -> Eight {
        Eight::of_numbers(self, &Numbers(*numbers))
    }

    /// [`meet`](super::step::meet) with all boxes at once: the same arithmetic.
    #[inline(always)]
    fn meet(self, wide: &Wide, slabs: &SlabLanes, [t_min, t_max]: [f32; 2]) -> Met {
        let mut enter = self.all(t_min);
        let mut leave = self.all(t_max);
        for axis in 0..3 {
            let backward = slabs.backward[axis];
            let near = self.load(&wide.bounds[backward][axis]) * slabs.inverse[axis];
            let far = self.load(&wide.bounds[1 - backward][axis]) * slabs.inverse[axis];
            enter = enter.max(near - slabs.enter[axis]);
            leave = leave.min(far - slabs.leave[axis]);
        }
        Met { mask: enter.is_at_most(leave).bits(), t_enter: enter.numbers().0 }
    }
}

/// [`nearest`](super::step::nearest), with jumps for one child and for two.
#[inline(always)]
fn nearest(wide: &Wide, octant: usize, met: &Met, stack: &mut Stack) -> Option<Child> {
    let mask = met.mask;
    let rest = mask & mask.wrapping_sub(1);
    if rest == 0 {
        return (mask != 0).then(|| wide.children[mask.trailing_zeros() as usize & 7]);
    }
    if rest & (rest - 1) == 0 {
        return Some(nearer_of_two(wide, mask, &met.t_enter, stack));
    }
    push(wide, octant, met, stack);
    Some(stack.take())
}

/// [`push`](super::step::push), without a jump: the next child is written over one that was not met.
#[inline(always)]
fn push(wide: &Wide, octant: usize, met: &Met, stack: &mut Stack) {
    let (mut children, mut t_enter, mut count) = ([Child::NONE; 8], [0.0; 8], 0);
    for child in wide.far_to_near(octant) {
        children[count & 7] = wide.children[child];
        t_enter[count & 7] = met.t_enter[child];
        count += (met.mask >> child & 1) as usize;
    }
    stack.push_eight(children, t_enter, count);
}

impl Simd for Neon {
    type Slabs = SlabLanes;
    type Ready = SlabLanes;
    type Shear = ShearLanes;

    #[inline(always)]
    fn slabs(self, ray: &Ray, reach: f32) -> SlabLanes {
        let slabs = Slabs::new(ray, reach);
        let all = |numbers: [f32; 3]| numbers.map(|number| self.all(number));
        SlabLanes {
            inverse: all(slabs.inverse),
            enter: all(slabs.enter),
            leave: all(slabs.leave),
            backward: slabs.backward,
            octant: slabs.octant(),
        }
    }

    #[inline(always)]
    fn ready(self, ray: &Ray, reach: f32) -> SlabLanes {
        self.slabs(ray, reach)
    }

    #[inline(always)]
    fn shear(self, ray: &Ray) -> ShearLanes {
        let shear = Shear::new(ray);
        let all = |number: f32| self.all(number);
        let (origin, slope) = (shear.origin.map(all), shear.shear.map(all));
        ShearLanes { origin, slope, t_per_z: all(shear.t_per_z as f32), shear }
    }

    #[inline(always)]
    fn nearest(
        self,
        wide: &Wide,
        slabs: &SlabLanes,
        interval: [f32; 2],
        stack: &mut Stack,
    ) -> Option<Child> {
        nearest(wide, slabs.octant, &self.meet(wide, slabs, interval), stack)
    }

    #[inline(always)]
    fn push(self, wide: &Wide, ready: &SlabLanes, interval: [f32; 2], stack: &mut Stack) {
        push(wide, ready.octant, &self.meet(wide, ready, interval), stack);
    }

    #[inline(always)]
    fn filter(
        self,
        block: &Block,
        ray: &ShearLanes,
        [t_min, t_max]: [f32; 2],
        wants: Wants,
    ) -> Option<Sifted> {
        let corners = block.corners().each_ref().map(|rows| {
            let corner = ray.shear.axes.map(|axis| self.load(&rows[axis]));
            sheared(corner, &ray.origin, &ray.slope)
        });
        filtered(&corners, ray.t_per_z, [self.all(t_min), self.all(t_max)], wants)
    }

    #[inline(always)]
    fn hit(
        self,
        block: &Block,
        lane: usize,
        surely: bool,
        (_, ray): (&Ray, &ShearLanes),
    ) -> Option<Hit> {
        block.hit(lane, surely, &ray.shear)
    }
}
