//! Lists of hits of many rays, and how many hits there are.

use std::cell::Cell;

#[cfg(target_arch = "x86_64")]
use super::coherence::go_together;
use super::hits::{Crossings, FirstHits};
#[cfg(target_arch = "x86_64")]
use super::simd::HasAvx2;
use super::stream::trace;
use super::traverse::Trip;
#[cfg(target_arch = "x86_64")]
use super::wave;
use crate::geometry::{Hit, Ray};

/// Gives `end` the first `limit` hits of each ray that it sees, in the order of the rays: those of which
/// `accept`, by the index of the ray, holds. Without a limit it is `usize::MAX`. `room` is used and left
/// for the next time.
pub(super) fn first_hits<F: Fn(u32) -> bool>(
    trip: &Trip,
    rays: &[Ray],
    limit: usize,
    accept: impl Fn(usize) -> F,
    room: &mut Vec<Vec<Hit>>,
    mut end: impl FnMut(usize, &[Hit]),
) {
    #[cfg(target_arch = "x86_64")]
    if limit == usize::MAX
        && let Some(proof) = as_wave(trip, rays)
    {
        // SAFETY: the processor has AVX2.
        return unsafe { wave::trace_avx2(proof, trip, rays, accept, end) };
    }
    if room.len() < rays.len() {
        room.resize_with(rays.len(), Vec::new);
    }
    room[..rays.len()].iter_mut().for_each(Vec::clear);
    let lists = Cell::from_mut(&mut room[..rays.len()]).as_slice_of_cells();
    let begin = |index: usize, ray: &Ray| {
        (limit > 0).then(|| FirstHits::new(ray, limit, accept(index), lists[index].take()))
    };
    trace(trip, rays, begin, |index, first| lists[index].set(std::mem::take(&mut first.hits)));
    room[..rays.len()].iter().enumerate().for_each(|(index, list)| end(index, list));
}

/// Gives `end` how many triangles each ray hits of those that it sees; not of rays that can hit nothing.
pub(super) fn count_hits<F: Fn(u32) -> bool>(
    trip: &Trip,
    rays: &[Ray],
    accept: impl Fn(usize) -> F,
    mut end: impl FnMut(usize, usize),
) {
    #[cfg(target_arch = "x86_64")]
    if let Some(proof) = as_wave(trip, rays) {
        let end = |index: usize, triangles: &[u32]| end(index, triangles.len());
        // SAFETY: the processor has AVX2.
        return unsafe { wave::trace_avx2(proof, trip, rays, accept, end) };
    }
    let begin = |index: usize, ray: &Ray| Some(Crossings::new(ray, accept(index)));
    trace(trip, rays, begin, |index, crossings| end(index, crossings.count()));
}

/// Says so if it is best that everything along these rays is found as a wave.
#[cfg(target_arch = "x86_64")]
fn as_wave(trip: &Trip, rays: &[Ray]) -> Option<HasAvx2> {
    if go_together(trip, rays) { None } else { trip.simd.avx2() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::coherence::{Sample, start_apart};
    use crate::trace::noise::{rays_through, small_triangles};
    use crate::trace::simd::Best;
    use crate::trace::traverse::traverse;

    /// Rays in turns that can hit nothing are passed over: what another ray found in their place before is not
    /// theirs.
    #[test]
    fn lists_that_are_used_again_are_those_of_their_rays() {
        let mut state = 3;
        let (mesh, tree) = small_triangles(&mut state);
        let hitting = rays_through(&mut state, 300);
        let mut some = rays_through(&mut state, 300);
        some.iter_mut().skip(1).step_by(3).for_each(|ray| ray.origin[0] += 1e3);
        some.iter_mut().skip(2).step_by(3).for_each(|ray| ray.direction = [0.0; 3]);
        for simd in Best::each() {
            let trip = Trip::new(&mesh, &tree, simd);
            let mut room = Vec::new();
            for rays in [&hitting, &some, &hitting] {
                assert!(start_apart(&trip, rays) && Sample::new(&trip, rays).is_worth_turns(true));
                let one_by_one = |ray: &Ray| {
                    let mut first = FirstHits::new(ray, 3, |_| true, Vec::new());
                    traverse(&trip, ray, &mut first);
                    first.hits
                };
                let expected: Vec<_> = rays.iter().map(one_by_one).collect();
                assert!(expected.iter().filter(|hits| !hits.is_empty()).count() > 50);
                let mut found = Vec::new();
                let accept = |_: usize| |_: u32| true;
                first_hits(&trip, rays, 3, accept, &mut room, |_, hits| found.push(hits.to_vec()));
                assert_eq!(found, expected, "{}", simd.name());
            }
        }
    }
}
