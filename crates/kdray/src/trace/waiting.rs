//! Rays that wait for their turn, and those among them that have nothing to visit.

use super::traverse::Trip;
use crate::geometry::Ray;

/// How many rays are looked at together.
const GROUP: usize = u64::BITS as usize;

/// Rays in their order, a group at a time.
pub(super) struct Waiting<'a> {
    trip: &'a Trip,
    /// Whether many of them pass beside everything, so that it is worth asking all.
    often_miss: bool,
    rays: &'a [Ray],
    /// Where the next group starts.
    end: usize,
    /// Which of this group still wait, a bit each.
    group: u64,
}

impl<'a> Waiting<'a> {
    pub(super) fn new(trip: &'a Trip, rays: &'a [Ray], often_miss: bool) -> Self {
        Self { trip, often_miss, rays, end: 0, group: 0 }
    }

    /// The next ray that `begin` has a visitor for, but of those that miss the hull: they are done with, a
    /// group at a time, so that no jump depends on which of them do.
    #[inline(always)]
    pub(super) fn next<V>(
        &mut self,
        begin: &mut impl FnMut(usize, &Ray) -> Option<V>,
        end: &mut impl FnMut(usize, V),
    ) -> Option<(usize, &'a Ray, V)> {
        loop {
            if self.group == 0 {
                self.next_group(begin, end)?;
            } else {
                let index = self.end - GROUP + self.group.trailing_zeros() as usize;
                self.group &= self.group - 1;
                if let Some(visitor) = begin(index, &self.rays[index]) {
                    return Some((index, &self.rays[index], visitor));
                }
            }
        }
    }

    /// Looks at the next group, if there is one.
    #[inline(never)]
    fn next_group<V>(
        &mut self,
        begin: &mut impl FnMut(usize, &Ray) -> Option<V>,
        end: &mut impl FnMut(usize, V),
    ) -> Option<()> {
        let start = self.end;
        let rays = self.rays.get(start..).filter(|rays| !rays.is_empty())?;
        let rays = &rays[..rays.len().min(GROUP)];
        let all = u64::MAX >> (GROUP - rays.len());
        self.end += GROUP;
        self.group =
            if self.often_miss { self.trip.hull.reached(rays, self.trip.simd) } else { all };
        let mut missed = all & !self.group;
        while missed != 0 {
            let place = missed.trailing_zeros() as usize;
            missed &= missed - 1;
            if let Some(visitor) = begin(start + place, &rays[place]) {
                end(start + place, visitor);
            }
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mesh;
    use crate::trace::simd::Best;
    use crate::{BuildOptions, Tree};

    /// Some rays miss, some have no visitor: each of the others is given once, in order, or done with.
    #[test]
    fn every_ray_is_given_or_done_with() {
        let corners = [[0.0; 3], [1.0, 0.0, 1.0], [0.0, 1.0, 0.0]];
        let mesh = Mesh::new(&corners, &[[0, 1, 2]]).expect("sound");
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
        let misses = |index: usize| index % 7 < 3;
        let has_visitor = |index: usize| index % 5 != 1;
        let ray =
            |index| Ray::new([if misses(index) { 3.0 } else { 0.2 }, 0.2, 2.0], [0.0, 0.0, -1.0]);
        for (simd, count) in Best::each().into_iter().flat_map(|it| [(it, 0), (it, 64), (it, 150)])
        {
            let trip = Trip::new(&mesh, &tree, simd);
            let rays: Vec<_> = (0..count).map(ray).collect();
            for often_miss in [false, true] {
                let mut waiting = Waiting::new(&trip, &rays, often_miss);
                let (mut given, mut done) = (Vec::new(), Vec::new());
                let mut begin = |index: usize, _: &Ray| has_visitor(index).then_some(index);
                let mut end = |index: usize, visitor: usize| {
                    assert_eq!(index, visitor);
                    done.push(index);
                };
                while let Some((index, ray, visitor)) = waiting.next(&mut begin, &mut end) {
                    assert_eq!((visitor, ray.origin), (index, rays[index].origin));
                    given.push(index);
                }
                let is_done = |index: &usize| often_miss && misses(*index);
                let (of_done, of_given): (Vec<_>, Vec<_>) =
                    (0..count).filter(|index| has_visitor(*index)).partition(is_done);
                assert_eq!((given, done), (of_given, of_done), "{}", simd.name());
            }
        }
    }
}
