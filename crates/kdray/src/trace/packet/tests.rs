use super::*;
use crate::geometry::Mesh;
use crate::trace::hits::{Closest, FirstHits};
use crate::trace::noise::noise;
use crate::trace::simd::Best;
use crate::{BuildOptions, Tree};

/// What packets are traced through, if this processor has them.
fn trip(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Option<Trip> {
    let simd = Best::detect();
    if simd.avx2().is_none() {
        println!("this processor has no AVX2: packets were not tested");
        return None;
    }
    let mesh = Mesh::new(positions, triangles).expect("sound");
    let tree = Tree::build(&mesh, &BuildOptions::default()).expect("sound options");
    Some(Trip::new(&mesh, &tree, simd))
}

/// Rays of the largest packet.
fn most(trip: &Trip) -> usize {
    if trip.simd.avx512().is_some() { 16 } else { 8 }
}

/// Whether the rays were a packet.
fn together<V: Visitor>(trip: &Trip, rays: &[Ray], visitors: &mut [Option<V>]) -> bool {
    let avx2 = trip.simd.avx2().expect("asked for before");
    let packet = match trip.simd.avx512() {
        // SAFETY: the processor has it. The same below.
        Some(proof) if rays.len() == 16 => unsafe { traverse_avx512(proof, trip, rays, visitors) },
        // SAFETY: as above.
        _ => unsafe { traverse_avx2(avx2, trip, rays, visitors) },
    };
    packet.is_some()
}

/// The hits of rays along these directions, of which one stays away, if they were a packet.
fn traced(trip: &Trip, direction: impl Fn(usize) -> [f32; 3]) -> Option<Vec<Option<Hit>>> {
    let rays = (0..most(trip)).map(|index| Ray::new([0.5, 0.5, 5.0], direction(index)));
    let rays: Vec<Ray> = rays.collect();
    let visitor = |ray: &Ray| Some(Closest::new(ray, |_| true));
    let mut visitors: Vec<_> = rays.iter().map(visitor).collect();
    visitors[3] = None;
    together(trip, &rays, &mut visitors)
        .then(|| visitors.into_iter().map(|visitor| visitor?.hit).collect())
}

#[test]
fn rays_go_together_where_their_largest_axes_agree() {
    let square = [[0.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 9.0, 0.0]];
    let Some(trip) = trip(&square, &[[0, 1, 2]]) else { return };
    let are_hits = |hits: Vec<Option<Hit>>| {
        assert!((0..hits.len()).all(|lane| hits[lane].is_some() == (lane != 3)), "{hits:?}");
    };
    let fan = |spread: f32| move |index: usize| [spread * (index as f32 + 0.5), 0.1, -1.0];
    are_hits(traced(&trip, fan(0.01)).expect("these go together"));
    assert!(traced(&trip, fan(0.2)).is_none(), "the last ones are largest in x");
    let torn = |index: usize| [0.01, if index == 5 { -0.05 } else { 0.05 }, -1.0];
    are_hits(traced(&trip, torn).expect("one goes down in y"));
    let opposite = |index: usize| [0.01, 0.1, if index == 5 { 1.0 } else { -1.0 }];
    assert!(traced(&trip, opposite).is_none(), "one goes away");
}

/// Rays about an axis, on which side of it each chooses.
fn bundle(state: &mut u32, count: usize) -> Vec<Ray> {
    let axis = (3.0 * noise(state)) as usize % 3;
    let forward = if noise(state) < 0.5 { -1.0 } else { 1.0 };
    let spread = [0.0, 0.02, 0.3][(3.0 * noise(state)) as usize % 3];
    let start = [(); 3].map(|()| 3.0 * noise(state) - 1.0);
    let is_line = noise(state) < 0.3;
    let ray = |_| {
        let mut direction = [(); 3].map(|()| spread * (noise(state) - 0.5));
        direction[axis] = forward * (0.5 + noise(state));
        let origin = start.map(|at| at + 0.1 * (noise(state) - 0.5));
        let t_max = if noise(state) < 0.2 { noise(state) } else { f32::INFINITY };
        let t_min = if is_line { f32::NEG_INFINITY } else { 0.0 };
        Ray { t_min, t_max, ..Ray::new(origin, direction) }
    };
    (0..count).map(ray).collect()
}

#[test]
fn a_packet_sees_what_each_of_its_rays_sees() {
    let mut state = 11;
    let positions: Vec<[f32; 3]> = (0..900).map(|_| [(); 3].map(|()| noise(&mut state))).collect();
    let triangles: Vec<[u32; 3]> = (0..800).map(|at| [at, at + 1, at + 100]).collect();
    let Some(trip) = trip(&positions, &triangles) else { return };
    let (mut packets, mut seen) = (0, 0);
    for round in 0..2000 {
        let rays = bundle(&mut state, if round % 2 == 0 { 8 } else { most(&trip) });
        let begin = |ray: &Ray| FirstHits::new(ray, usize::MAX, |_| true, Vec::new());
        let mut visitors: Vec<_> = rays.iter().map(|ray| Some(begin(ray))).collect();
        if !together(&trip, &rays, &mut visitors) {
            continue;
        }
        packets += 1;
        for (ray, visitor) in rays.iter().zip(visitors) {
            let mut alone = begin(ray);
            crate::trace::traverse::traverse(&trip, ray, &mut alone);
            assert_eq!(visitor.map(|it| it.hits), Some(alone.hits.clone()), "{ray:?}");
            seen += alone.hits.len();
        }
    }
    assert!(packets > 1500 && seen > 10_000, "only {packets} packets with {seen} hits");
}
