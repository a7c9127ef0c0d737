//! Rays that wait for their turn, but for those that can hit nothing.

use super::traverse::Trip;
use crate::geometry::Ray;

/// How many rays are looked at together.
const GROUP: usize = u64::BITS as usize;

/// Rays in their order, a group at a time, so that no jump depends on which of them can hit something.
pub(super) struct Waiting<'a> {
    trip: &'a Trip,
    rays: &'a [Ray],
    /// Where the next group starts.
    end: usize,
    /// Which of this group still wait, a bit each.
    group: u64,
}

impl<'a> Waiting<'a> {
    pub(super) fn new(trip: &'a Trip, rays: &'a [Ray]) -> Self {
        Self { trip, rays, end: 0, group: 0 }
    }

    /// The next ray and its index.
    #[inline(always)]
    pub(super) fn next(&mut self) -> Option<(usize, &'a Ray)> {
        while self.group == 0 {
            self.next_group()?;
        }
        let index = self.end - GROUP + self.group.trailing_zeros() as usize;
        self.group &= self.group - 1;
        Some((index, &self.rays[index]))
    }

    /// Looks at the next group, if there is one.
    #[inline(never)]
    fn next_group(&mut self) -> Option<()> {
        let rays = self.rays.get(self.end..).filter(|rays| !rays.is_empty())?;
        self.group = self.trip.hull.reached(&rays[..rays.len().min(GROUP)], self.trip.simd);
        self.end += GROUP;
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mesh;
    use crate::trace::simd::Best;
    use crate::{BuildOptions, Tree};

    /// Some rays miss, some are not valid: each of the others is given once, in order.
    #[test]
    fn every_ray_is_given_that_may_hit_something() {
        let corners = [[0.0; 3], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
        let mesh = Mesh::new(&corners, &[[0, 1, 2]]).expect("sound");
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
        let misses = |index: usize| index % 7 < 3 || (64..128).contains(&index);
        let is_valid = |index: usize| index % 5 != 1;
        let ray = |index| {
            let x = if misses(index) { 3.0 } else { 0.2 };
            let z = if is_valid(index) { -1.0 } else { 0.0 };
            Ray::new([x, 0.2, 2.0], [0.0, 0.0, z])
        };
        for (simd, count) in
            Best::each().into_iter().flat_map(|it| [0, 64, 150, 200].map(|count| (it, count)))
        {
            let trip = Trip::new(&mesh, &tree, simd);
            let rays: Vec<_> = (0..count).map(ray).collect();
            let mut waiting = Waiting::new(&trip, &rays);
            let mut given = Vec::new();
            while let Some((index, ray)) = waiting.next() {
                assert_eq!(*ray, rays[index]);
                given.push(index);
            }
            let expected: Vec<_> =
                (0..count).filter(|index| is_valid(*index) && !misses(*index)).collect();
            assert_eq!(given, expected, "{}", simd.name());
        }
    }
}
