//! Several rays at a time: in packets, or each a step in turn.
//!
//! A ray waits at almost every step, for memory and for the decision where to go: what it reads next
//! depends on what it read last. Rays that go the same way wait together, as a packet. Where they
//! go their own ways, the others are served while one waits.

use super::coherence::{Sample, go_together, start_apart};
use super::fullness::Fullness;
#[cfg(target_arch = "x86_64")]
use super::packet;
#[cfg(target_arch = "aarch64")]
use super::simd::Best;
#[cfg(target_arch = "x86_64")]
use super::simd::{Avx2, Avx512};
use super::simd::{Plain, Simd};
use super::stack::Stack;
use super::traverse::{Trip, Visitor, traverse, traverse_with};
use super::waiting::Waiting;
use super::walk::Walk;
use super::wide::Child;
use crate::geometry::Ray;

/// Rays on their way at the same time: enough to hide a read from memory, few enough for their
/// state to stay in the nearest cache.
const WALKS: usize = 12;

/// Walks all `rays`. A ray's visitor comes from `begin`; `end` gets it, with the ray's index, when
/// there is nothing more to visit. `begin` may pass over a ray; rays that can hit nothing may be passed
/// over without it.
pub(super) fn trace<V: Visitor>(
    trip: &Trip,
    rays: &[Ray],
    begin: impl FnMut(usize, &Ray) -> Option<V>,
    end: impl FnMut(usize, &mut V),
) {
    if go_together(trip, rays) {
        return in_packets(trip, rays, begin, end);
    }
    apart(trip, rays, start_apart(trip, rays), begin, end);
}

/// Rays that go their own ways: each a step in turn, or one by one. `are_far` says that a ray reads what
/// the one before has not left in the nearest cache.
fn apart<V: Visitor>(
    trip: &Trip,
    rays: &[Ray],
    are_far: bool,
    begin: impl FnMut(usize, &Ray) -> Option<V>,
    end: impl FnMut(usize, &mut V),
) {
    let sample = Sample::new(trip, rays);
    if !sample.is_worth_turns(are_far) {
        return one_by_one(trip, rays, begin, end);
    }
    let rays = Waiting::new(trip, rays);
    #[cfg(target_arch = "x86_64")]
    if let Some(proof) = trip.simd.avx512() {
        // SAFETY: the processor has AVX-512.
        return unsafe { stream_avx512(proof.into(), trip, rays, begin, end) };
    }
    #[cfg(target_arch = "x86_64")]
    if let Some(proof) = trip.simd.avx2() {
        // SAFETY: the processor has AVX2.
        return unsafe { stream_avx2(proof.into(), trip, rays, begin, end) };
    }
    #[cfg(target_arch = "aarch64")]
    if let Best::Neon(neon) = trip.simd {
        return stream_with(neon, trip, rays, begin, end);
    }
    stream_with(Plain, trip, rays, begin, end);
}

/// The most rays of a packet.
const PACKET: usize = 16;

/// Packets after which it is asked whether they are full enough.
const TRIED: usize = 4;

/// In packets where rays go together, one by one where not: each finds what it reads in the nearest
/// cache, where the ray before left it. If the first packets part soon, the others are not made.
pub(super) fn in_packets<V: Visitor>(
    trip: &Trip,
    rays: &[Ray],
    mut begin: impl FnMut(usize, &Ray) -> Option<V>,
    mut end: impl FnMut(usize, &mut V),
) {
    let mut visitors = [const { None }; PACKET];
    let mut fullness = Fullness::default();
    for (index, packet) in rays.chunks(PACKET).enumerate() {
        if index == TRIED && !fullness.is_enough() {
            let first = PACKET * index;
            let begin = |index: usize, ray: &Ray| begin(first + index, ray);
            return apart(trip, &rays[first..], true, begin, |index, it| end(first + index, it));
        }
        for (lane, (visitor, ray)) in visitors.iter_mut().zip(packet).enumerate() {
            *visitor = if ray.is_valid() { begin(PACKET * index + lane, ray) } else { None };
        }
        fullness.add(&sixteen(trip, packet, &mut visitors[..packet.len()]));
        for (lane, visitor) in visitors[..packet.len()].iter_mut().enumerate() {
            if let Some(visitor) = visitor {
                end(PACKET * index + lane, visitor);
            }
        }
    }
}

/// At most sixteen rays. Gives how full they were as packets, as far as they were.
#[inline(always)]
fn sixteen<V: Visitor>(trip: &Trip, rays: &[Ray], visitors: &mut [Option<V>]) -> Fullness {
    #[cfg(target_arch = "x86_64")]
    if let Some(proof) = trip.simd.avx512()
        && rays.len() == 16
        // SAFETY: the processor has AVX-512.
        && let Some(packet) = unsafe { packet::traverse_avx512(proof, trip, rays, visitors) }
    {
        return packet;
    }
    let mut fullness = Fullness::default();
    for (rays, visitors) in rays.chunks(8).zip(visitors.chunks_mut(8)) {
        fullness.add(&eight(trip, rays, visitors));
    }
    fullness
}

/// At most eight rays.
#[inline(always)]
fn eight<V: Visitor>(trip: &Trip, rays: &[Ray], visitors: &mut [Option<V>]) -> Fullness {
    #[cfg(target_arch = "x86_64")]
    if let Some(proof) = trip.simd.avx2()
        && rays.len() == 8
        // SAFETY: the processor has AVX2.
        && let Some(packet) = unsafe { packet::traverse_avx2(proof, trip, rays, visitors) }
    {
        return packet;
    }
    for (ray, visitor) in rays.iter().zip(visitors) {
        if let Some(visitor) = visitor {
            traverse(trip, ray, visitor);
        }
    }
    Fullness::default()
}

/// Each ray to its end before the next one starts.
fn one_by_one<V: Visitor>(
    trip: &Trip,
    rays: &[Ray],
    begin: impl FnMut(usize, &Ray) -> Option<V>,
    end: impl FnMut(usize, &mut V),
) {
    #[cfg(target_arch = "x86_64")]
    if let Some(proof) = trip.simd.avx512() {
        // SAFETY: the processor has AVX-512.
        return unsafe { one_by_one_avx512(proof.into(), trip, rays, begin, end) };
    }
    #[cfg(target_arch = "x86_64")]
    if let Some(proof) = trip.simd.avx2() {
        // SAFETY: the processor has AVX2.
        return unsafe { one_by_one_avx2(proof.into(), trip, rays, begin, end) };
    }
    #[cfg(target_arch = "aarch64")]
    if let Best::Neon(neon) = trip.simd {
        return one_by_one_with(neon, trip, rays, begin, end);
    }
    one_by_one_with(Plain, trip, rays, begin, end);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
fn one_by_one_avx2<V: Visitor>(
    simd: Avx2,
    trip: &Trip,
    rays: &[Ray],
    begin: impl FnMut(usize, &Ray) -> Option<V>,
    end: impl FnMut(usize, &mut V),
) {
    one_by_one_with(simd, trip, rays, begin, end);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,lzcnt,popcnt")]
fn one_by_one_avx512<V: Visitor>(
    simd: Avx512,
    trip: &Trip,
    rays: &[Ray],
    begin: impl FnMut(usize, &Ray) -> Option<V>,
    end: impl FnMut(usize, &mut V),
) {
    one_by_one_with(simd, trip, rays, begin, end);
}

/// The traversal is part of the loop: bounces off sponza take a sixteenth fewer instructions so.
#[inline(always)]
fn one_by_one_with<V: Visitor>(
    simd: impl Simd,
    trip: &Trip,
    rays: &[Ray],
    mut begin: impl FnMut(usize, &Ray) -> Option<V>,
    mut end: impl FnMut(usize, &mut V),
) {
    for (index, ray) in rays.iter().enumerate() {
        if let Some(mut visitor) = begin(index, ray) {
            traverse_with(simd, trip, ray, &mut visitor);
            end(index, &mut visitor);
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,bmi1,lzcnt,popcnt")]
fn stream_avx2<V: Visitor>(
    simd: Avx2,
    trip: &Trip,
    rays: Waiting,
    begin: impl FnMut(usize, &Ray) -> Option<V>,
    end: impl FnMut(usize, &mut V),
) {
    stream_with(simd, trip, rays, begin, end);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2,fma,bmi1,lzcnt,popcnt")]
fn stream_avx512<V: Visitor>(
    simd: Avx512,
    trip: &Trip,
    rays: Waiting,
    begin: impl FnMut(usize, &Ray) -> Option<V>,
    end: impl FnMut(usize, &mut V),
) {
    stream_with(simd, trip, rays, begin, end);
}

#[inline(always)]
fn stream_with<V: Visitor>(
    simd: impl Simd,
    trip: &Trip,
    mut rays: Waiting,
    mut begin: impl FnMut(usize, &Ray) -> Option<V>,
    mut end: impl FnMut(usize, &mut V),
) {
    let Trip { layout, hull, .. } = trip;
    let mut stacks: Vec<Stack> = std::iter::repeat_with(Stack::new).take(WALKS).collect();
    let mut walks = Vec::with_capacity(WALKS);
    let mut next = || loop {
        let (index, ray) = rays.next()?;
        if let Some(visitor) = begin(index, ray) {
            return Some((index, ray, visitor));
        }
    };
    for stack in &mut stacks {
        let Some((index, ray, visitor)) = next() else { break };
        walks.push((index, visitor, Walk::new(simd, ray, hull.reach, stack), Child(0)));
    }
    while !walks.is_empty() {
        let mut are_done = false;
        for (index, visitor, walk, child) in &mut walks {
            let below = if child.block().is_some() {
                walk.leaf(layout, *child, visitor)
            } else {
                walk.step(layout, *child, visitor)
            };
            if let Some(below) = below {
                *child = below;
                continue;
            }
            end(*index, visitor);
            if let Some((other, ray, begun)) = next() {
                walk.restart(ray, hull.reach);
                (*index, *visitor, *child) = (other, begun, Child(0));
            } else {
                (*child, are_done) = (Child::NONE, true);
            }
        }
        if are_done {
            walks.retain(|(.., child)| *child != Child::NONE);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Mesh;
    use crate::trace::hits::Closest;
    use crate::trace::noise::{noise, rays_through, small_triangles};
    use crate::trace::simd::Best;
    use crate::{BuildOptions, Tree};

    /// Asks for the closest hits of rays, all at once and one by one.
    fn finds_what_single_rays_find(trip: &Trip, rays: &[Ray]) {
        let single = |ray: &Ray| {
            let mut closest = Closest::new(ray, |_| true);
            traverse(trip, ray, &mut closest);
            closest.hit
        };
        let mut found = vec![None; rays.len()];
        let begin = |_: usize, ray: &Ray| Some(Closest::new(ray, |_| true));
        trace(trip, rays, begin, |index, closest| found[index] = closest.hit);
        let expected: Vec<_> = rays.iter().map(single).collect();
        assert!(expected.iter().flatten().count() > 100);
        assert_eq!(found, expected, "{}", trip.simd.name());
    }

    #[test]
    fn rays_that_take_turns_find_what_single_rays_find() {
        let mut state = 11;
        let (mesh, tree) = small_triangles(&mut state);
        let rays = rays_through(&mut state, 1000);
        for simd in Best::each() {
            let trip = Trip::new(&mesh, &tree, simd);
            assert!(Sample::new(&trip, &rays).is_worth_turns(true) && !go_together(&trip, &rays));
            finds_what_single_rays_find(&trip, &rays);
        }
    }

    #[test]
    fn rays_that_go_short_ways_find_what_single_rays_find() {
        let corners = [[0.0, 0.0, 0.4], [1.0, 0.1, 0.5], [0.2, 1.0, 0.6], [0.9, 0.9, 0.3]];
        let mesh = Mesh::new(&corners, &[[0, 1, 2], [1, 3, 2]]).expect("sound");
        let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
        let rays = rays_through(&mut 13, 1000);
        for simd in Best::each() {
            let trip = Trip::new(&mesh, &tree, simd);
            assert!(!Sample::new(&trip, &rays).is_worth_turns(true) && !go_together(&trip, &rays));
            finds_what_single_rays_find(&trip, &rays);
        }
    }

    #[test]
    fn rays_that_part_soon_find_what_single_rays_find() {
        let mut state = 17;
        let (mesh, tree) = small_triangles(&mut state);
        // From one place, in any order, so that neighbours are not beside each other.
        let mut ray = |spread: f32| {
            let [x, y, z] = [(); 3].map(|()| spread * (noise(&mut state) - 0.5));
            Ray::new([0.5, 0.4, -2.0], [x, y + 0.02, 2.5 + z])
        };
        let parting: Vec<_> = (0..1000).map(|_| ray(0.7)).collect();
        let beside: Vec<_> = (0..1000).map(|_| ray(0.01)).collect();
        for simd in Best::each() {
            let trip = Trip::new(&mesh, &tree, simd);
            let is_enough = |rays: &[Ray]| {
                assert!(go_together(&trip, rays));
                let mut fullness = Fullness::default();
                for rays in rays.chunks(PACKET).take(TRIED) {
                    let mut visitors =
                        [(); PACKET].map(|()| Some(Closest::new(&rays[0], |_| true)));
                    fullness.add(&sixteen(&trip, rays, &mut visitors));
                }
                fullness.is_enough()
            };
            // Other processors have no packets.
            let has_packets = cfg!(target_arch = "x86_64") && trip.simd.name() != "none";
            assert_eq!(is_enough(&parting), !has_packets);
            assert!(is_enough(&beside));
            finds_what_single_rays_find(&trip, &parting);
            finds_what_single_rays_find(&trip, &beside);
        }
    }
}
