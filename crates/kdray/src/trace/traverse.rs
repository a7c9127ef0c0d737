//! Visit the leaves along rays from front to back, with a stack \[PH04].

use super::hull::Hull;
use super::sifted::Wants;
#[cfg(target_arch = "x86_64")]
use super::simd::{Avx2, Avx512};
use super::simd::{Best, Plain, Simd};
use super::walk::visit_below;
use super::wide::{Child, Layout};
use crate::geometry::{Hit, Mesh, Ray};
use crate::tree::Tree;

/// Sees what a ray comes to.
pub(super) trait Visitor {
    /// A hit of a leaf, at any `t`. Gives the `t` up to which there is more to see.
    fn hit(&mut self, hit: Hit) -> f32;

    /// What it wants of the triangles of a block. What it does not want need not be shown.
    const WANTS: Wants = Wants::All;

    /// A triangle of a leaf that is hit in the ray's interval, if that is enough: [`Wants::Whether`]. Gives
    /// what [`Visitor::hit`] gives.
    #[inline(always)]
    fn inside(&mut self, _triangle: u32) -> f32 {
        f32::INFINITY
    }

    /// Whether the hit of the triangle, if there is one, would change nothing.
    #[inline(always)]
    fn knows(&self, _triangle: u32) -> bool {
        false
    }

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

/// What rays are traced through, and how.
pub(super) struct Trip {
    pub(super) layout: Layout,
    pub(super) hull: Hull,
    pub(super) simd: Best,
}

impl Trip {
    pub(super) fn new(mesh: &Mesh, tree: &Tree, simd: Best) -> Self {
        Self { layout: Layout::new(mesh, tree), hull: Hull::new(&tree.bounds()), simd }
    }
}

/// No `t` is as low: the visitor has seen enough.
pub(super) const ENOUGH: f32 = f32::NEG_INFINITY;

/// Shows `visitor` what the ray comes to, leaf by leaf from front to back: nothing if it is not valid.
#[inline]
pub(super) fn traverse<V: Visitor>(trip: &Trip, ray: &Ray, visitor: &mut V) {
    #[cfg(target_arch = "x86_64")]
    if let Some(proof) = trip.simd.avx512() {
        // SAFETY: the processor has AVX-512.
        return unsafe { traverse_avx512(proof.into(), trip, ray, visitor) };
    }
    #[cfg(target_arch = "x86_64")]
    if let Some(proof) = trip.simd.avx2() {
        // SAFETY: the processor has AVX2.
        return unsafe { traverse_avx2(proof.into(), trip, ray, visitor) };
    }
    #[cfg(target_arch = "aarch64")]
    if let Best::Neon(neon) = trip.simd {
        return traverse_apart(neon, trip, ray, visitor);
    }
    traverse_plain(trip, ray, visitor);
}

#[inline(never)]
fn traverse_plain(trip: &Trip, ray: &Ray, visitor: &mut impl Visitor) {
    traverse_apart(Plain, trip, ray, visitor);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
fn traverse_avx2<V: Visitor>(simd: Avx2, trip: &Trip, ray: &Ray, visitor: &mut V) {
    traverse_apart(simd, trip, ray, visitor);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,lzcnt,popcnt")]
fn traverse_avx512<V: Visitor>(simd: Avx512, trip: &Trip, ray: &Ray, visitor: &mut V) {
    traverse_apart(simd, trip, ray, visitor);
}

/// [`traverse_with`], with a function apart for rays that do not pass beside the scene: those that do need no
/// room on the stack.
#[inline(always)]
fn traverse_apart(simd: impl Simd, trip: &Trip, ray: &Ray, visitor: &mut impl Visitor) {
    if !simd.is_beside(ray, &trip.hull) {
        simd.descend(trip, ray, visitor);
    }
}

/// [`traverse`] as part of a function that has the instructions.
#[inline(always)]
pub(super) fn traverse_with(simd: impl Simd, trip: &Trip, ray: &Ray, visitor: &mut impl Visitor) {
    if !simd.is_beside(ray, &trip.hull) {
        descend(simd, trip, ray, visitor);
    }
}

/// Visits the root and everything below it, if the ray is valid.
#[inline(always)]
pub(super) fn descend(simd: impl Simd, trip: &Trip, ray: &Ray, visitor: &mut impl Visitor) {
    if simd.is_valid(ray) {
        let root = (Child(0), ray.t_max);
        visit_below(simd, &trip.layout, (ray, trip.hull.reach), root, visitor);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BuildOptions;

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
    fn every_traversal_shows_what_the_plain_one_shows() {
        let mesh = spiral();
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
        for simd in Best::each() {
            println!("{}", simd.name());
            shows_what_the_plain_one_shows(&Trip::new(&mesh, &tree, simd));
        }
    }

    fn shows_what_the_plain_one_shows(trip: &Trip) {
        let mut shown = 0;
        for index in 0..2000_u32 {
            let (sin, cos) = (1.3 * index as f32).sin_cos();
            let origin = [3.0 * cos, 0.003 * index as f32, 3.0 * sin];
            let ray = Ray::new(origin, [-cos, 0.3 * sin, -sin + 0.2 * cos]);
            let (mut fast, mut plain) = (Everything(Vec::new()), Everything(Vec::new()));
            traverse(trip, &ray, &mut fast);
            traverse_plain(trip, &ray, &mut plain);
            // The fast one takes a block's hits in another order, and leaves out what is behind.
            for shown in [&mut fast.0, &mut plain.0] {
                shown.retain(|(_, t)| f32::from_bits(*t) >= ray.t_min);
                shown.sort_unstable();
            }
            assert_eq!(fast.0, plain.0, "{ray:?}");
            shown += plain.0.len();
        }
        assert!(shown > 2000, "only {shown} hits");
    }
}
