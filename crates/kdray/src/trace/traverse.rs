//! Visit the leaves along a ray from front to back, with a stack \[PH04].

use super::block::{Block, Filtered};
use super::prepare::{Shear, Slabs, lesser};
use super::stack::{Stack, Visit};
use super::step::{self, Met};
use super::wide::{Child, Layout, Wide};
use crate::geometry::{Hit, Ray};

/// Sees what a ray comes to.
pub(super) trait Visitor {
    /// A hit of a leaf, at any `t`. Gives the `t` up to which there is more to see.
    fn hit(&mut self, hit: Hit) -> f32;

    /// An inner node.
    #[inline(always)]
    fn step(&mut self) {}

    /// A leaf.
    #[inline(always)]
    fn leaf(&mut self) {}

    /// A block of a leaf.
    #[inline(always)]
    fn test(&mut self) {}
}

/// No `t` is as low: the visitor has seen enough.
pub(super) const ENOUGH: f32 = f32::NEG_INFINITY;

/// Shows `visitor` what the ray comes to, leaf by leaf from front to back.
///
/// Boxes are as thick as [`Slabs`] says, so a ray near a face of one visits it.
pub(super) fn traverse(layout: &Layout, ray: &Ray, slabs: &Slabs, visitor: &mut impl Visitor) {
    let entry = Entry { layout, ray, slabs };
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the processor has AVX2.
        return unsafe { entry.traverse_avx2(visitor) };
    }
    entry.traverse_plain(visitor);
}

/// A ray and what it is traced through.
struct Entry<'a> {
    layout: &'a Layout,
    ray: &'a Ray,
    slabs: &'a Slabs,
}

impl Entry<'_> {
    fn traverse_plain(&self, visitor: &mut impl Visitor) {
        let step = |wide: &Wide, interval: [f32; 2]| step::step(wide, self.slabs, interval);
        self.traverse_with(visitor, step, |block, _| block.unknown());
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,bmi1,lzcnt,popcnt")]
    fn traverse_avx2<V: Visitor>(&self, visitor: &mut V) {
        let step =
            |wide: &Wide, interval: [f32; 2]| step::step_avx2::<V>(wide, self.slabs, interval);
        self.traverse_with(visitor, step, |block, shear| block.filter_avx2::<V>(shear));
    }

    /// The traversal, with a way to step down and one to filter the triangles of a block.
    #[inline(always)]
    fn traverse_with(
        &self,
        visitor: &mut impl Visitor,
        step: impl Fn(&Wide, [f32; 2]) -> Met,
        filter: impl Fn(&Block, &Shear) -> Filtered,
    ) {
        let Ray { t_min, t_max: mut until, .. } = *self.ray;
        let mut shear = None;
        let mut stack = Stack::new();
        let mut next = Some(Child(0));
        loop {
            let child = match next.take() {
                Some(child) => child,
                None => match stack.pop() {
                    Some(visit) if visit.t_min <= until => visit.child,
                    Some(_) => continue,
                    None => return,
                },
            };
            let Some(first) = child.block() else {
                visitor.step();
                // SAFETY: children of a layout are in it.
                let wide = unsafe { self.layout.wides.get_unchecked(child.0 as usize) };
                let met = step(wide, [t_min, until]);
                next = sort(&met, wide, &mut stack);
                continue;
            };
            visitor.leaf();
            let shear = shear.get_or_insert_with(|| Shear::new(self.ray));
            until = test_leaf(&self.layout.blocks[first..], shear, until, visitor, &filter);
            if until == ENOUGH {
                return;
            }
        }
    }
}

/// The nearest of the children that were met; the others go on the stack, the farthest first.
#[inline(always)]
fn sort(met: &Met, wide: &Wide, stack: &mut Stack) -> Option<Child> {
    let mut rest = met.children;
    if rest == 0 {
        return None;
    }
    let visit = |place: usize| {
        let place = place & 7;
        Visit { child: wide.children[place], t_min: met.t_min[place] }
    };
    let mut nearest = visit(rest.trailing_zeros() as usize);
    rest &= rest - 1;
    let mut count = 0;
    while rest != 0 {
        let other = visit(rest.trailing_zeros() as usize);
        rest &= rest - 1;
        let (near, far) =
            if other.t_min < nearest.t_min { (other, nearest) } else { (nearest, other) };
        nearest = near;
        stack.insert(far, count);
        count += 1;
    }
    Some(nearest.child)
}

/// Shows the visitor the hits of a leaf; gives the `t` up to which there is more to see.
#[inline(always)]
fn test_leaf(
    blocks: &[Block],
    shear: &Shear,
    mut until: f32,
    visitor: &mut impl Visitor,
    filter: &impl Fn(&Block, &Shear) -> Filtered,
) -> f32 {
    for block in blocks {
        visitor.test();
        let filtered = filter(block, shear);
        let mut lanes = filtered.maybe;
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            let Some(hit) = block.hit(lane, filtered, shear) else { continue };
            until = lesser(until, visitor.hit(hit));
            if until == ENOUGH {
                return ENOUGH;
            }
        }
        if block.is_last() {
            break;
        }
    }
    until
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mesh;
    use crate::trace::prepare::reach;
    use crate::{BuildOptions, Tree};

    /// Keeps every hit it is shown.
    struct Everything(Vec<(u32, u32)>);

    impl Visitor for Everything {
        fn hit(&mut self, hit: Hit) -> f32 {
            self.0.push((hit.triangle, hit.t.to_bits()));
            f32::INFINITY
        }
    }

    /// Triangles along a spiral, in no plane.
    fn spiral() -> Mesh {
        let point = |index: u32| {
            let (sin, cos) = (0.7 * index as f32).sin_cos();
            let height = 0.01 * index as f32;
            [cos * (1.0 + height), height, sin]
        };
        let positions: Vec<_> = (0..600).map(point).collect();
        let triangles: Vec<_> = (0..598).map(|index| [index, index + 1, index + 2]).collect();
        Mesh::new(&positions, &triangles).expect("sound")
    }

    #[test]
    fn the_plain_traversal_shows_what_the_fast_one_shows() {
        let mesh = spiral();
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
        let layout = Layout::new(&mesh, &tree);
        let mut shown = 0;
        for index in 0..2000_u32 {
            let (sin, cos) = (1.3 * index as f32).sin_cos();
            let origin = [3.0 * cos, 0.003 * index as f32, 3.0 * sin];
            let ray = Ray::new(origin, [-cos, 0.3 * sin, -sin + 0.2 * cos]);
            let slabs = Slabs::new(&ray, reach(&tree.bounds()));
            let (mut fast, mut plain) = (Everything(Vec::new()), Everything(Vec::new()));
            traverse(&layout, &ray, &slabs, &mut fast);
            Entry { layout: &layout, ray: &ray, slabs: &slabs }.traverse_plain(&mut plain);
            assert_eq!(fast.0, plain.0, "{ray:?}");
            shown += plain.0.len();
        }
        assert!(shown > 2000, "only {shown} hits");
    }
}
