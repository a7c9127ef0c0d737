//! A batch gives, for every query, what the query alone gives, whatever its options.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use kdray::{
    Aabb, BatchError, BatchOptions, BuildOptions, Hit, Lists, Mesh, Ray, Sign, Tracer, Tree,
    Winding,
};
use kdray_test::rays::RayMaker;
use kdray_test::scenes;

/// More than one thread takes at a time, and not a multiple of it.
const COUNT: usize = 5_001;

struct Setup {
    mesh: Mesh,
    tracer: Tracer,
    rays: Vec<Ray>,
    points: Vec<[f32; 3]>,
}

fn setup() -> Setup {
    let mesh = scenes::ordinary().swap_remove(4).mesh;
    let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
    let mut maker = RayMaker::new(&mesh, &tree, 41);
    let rays = (0..COUNT).map(|_| maker.any()).collect();
    let points = (0..COUNT).map(|_| maker.line().origin).collect();
    Setup { tracer: Tracer::new(&mesh, &tree), mesh, rays, points }
}

fn all_options() -> impl Iterator<Item = BatchOptions<'static>> {
    [0, 1, 3].into_iter().flat_map(|threads| {
        [false, true].map(|reorder| BatchOptions { threads, reorder, ..BatchOptions::default() })
    })
}

/// All lists, one after the other, and a check of how they come.
fn collected<T: Copy>(
    ask: impl FnOnce(&mut dyn FnMut(Lists<T>) -> ControlFlow<()>) -> Result<(), BatchError>,
) -> Vec<Vec<T>> {
    let mut all = Vec::new();
    let mut sink = |lists: Lists<T>| {
        assert_eq!(lists.first, all.len());
        assert_eq!(lists.offsets.last(), Some(&lists.items.len()));
        all.extend(lists.lists().map(<[T]>::to_vec));
        ControlFlow::Continue(())
    };
    ask(&mut sink).expect("nobody cancels");
    all
}

#[test]
fn rays_are_answered_as_one_by_one() {
    let Setup { tracer, rays, .. } = setup();
    for options in all_options() {
        let batch = tracer.batch(options).expect("threads");
        let mut closest = vec![None; COUNT];
        batch.closest_hits(&rays, &mut closest).expect("nobody cancels");
        assert!(rays.iter().zip(&closest).all(|(ray, hit)| tracer.closest_hit(ray) == *hit));
        let mut any = vec![false; COUNT];
        batch.any_hits(&rays, &mut any).expect("nobody cancels");
        assert!(rays.iter().zip(&any).all(|(ray, hit)| tracer.any_hit(ray) == *hit));
        let mut counts = vec![0; COUNT];
        batch.count_hits(&rays, &mut counts).expect("nobody cancels");
        assert!(rays.iter().zip(&counts).all(|(ray, n)| tracer.count_hits(ray) == *n as usize));
        assert!(counts.iter().any(|count| *count > 1));
        for limit in [2, usize::MAX] {
            let lists = collected(|sink| batch.first_hits(&rays, limit, sink));
            let mut hits = Vec::new();
            for (ray, list) in rays.iter().zip(&lists) {
                tracer.first_hits(ray, limit, &mut hits);
                assert_eq!(&hits, list);
            }
            assert_eq!(lists.len(), COUNT);
        }
    }
}

#[test]
fn points_are_answered_as_one_by_one() {
    let Setup { mesh, tracer, points, .. } = setup();
    let winding = Winding::new(&mesh);
    for options in all_options() {
        let batch = tracer.batch(options).expect("threads");
        for max_distance in [0.1, f32::INFINITY] {
            let mut closest = vec![None; COUNT];
            batch.closest_points(&points, max_distance, &mut closest).expect("nobody cancels");
            let alone = |point: &[f32; 3]| tracer.closest_point(*point, max_distance);
            assert!(points.iter().zip(&closest).all(|(point, found)| alone(point) == *found));
        }
        for sign in [Sign::Parity, Sign::Winding(&winding)] {
            let (mut distances, mut inside) = (vec![None; COUNT], vec![false; COUNT]);
            batch.signed_distances(&points, sign, &mut distances).expect("nobody cancels");
            batch.contains(&points, sign, &mut inside).expect("nobody cancels");
            for (index, point) in points.iter().enumerate() {
                assert_eq!(tracer.signed_distance(*point, sign), distances[index]);
                let alone = match sign {
                    Sign::Parity => tracer.contains(*point),
                    Sign::Winding(winding) => winding.contains(*point),
                };
                assert_eq!(alone, inside[index]);
            }
        }
        let mut triangles = Vec::new();
        let near = collected(|sink| batch.within_spheres(&points, 0.2, sink));
        for (point, found) in points.iter().zip(&near) {
            tracer.within_sphere(*point, 0.2, &mut triangles);
            assert_eq!(&triangles, found);
        }
        let regions: Vec<Aabb> = points.windows(2).map(Aabb::of_points).collect();
        let within = collected(|sink| batch.within_boxes(&regions, sink));
        for (region, found) in regions.iter().zip(&within) {
            tracer.within_box(region, &mut triangles);
            assert_eq!(&triangles, found);
        }
    }
}

#[test]
fn rays_see_what_they_are_let_see() {
    let Setup { mesh, tracer, rays, .. } = setup();
    let visible: Vec<bool> = (0..mesh.triangles().len()).map(|index| index % 3 != 0).collect();
    let mut except = vec![None; COUNT];
    tracer.closest_hits(&rays, &mut except);
    let except: Vec<u32> =
        except.iter().map(|hit| hit.map_or(u32::MAX, |hit| hit.triangle)).collect();
    for reorder in [false, true] {
        let options = BatchOptions {
            reorder,
            visible: Some(&visible),
            except: Some(&except),
            ..BatchOptions::default()
        };
        let batch = tracer.batch(options).expect("no threads are started");
        let (mut closest, mut any) = (vec![None; COUNT], vec![false; COUNT]);
        let mut counts = vec![0; COUNT];
        batch.closest_hits(&rays, &mut closest).expect("nobody cancels");
        batch.any_hits(&rays, &mut any).expect("nobody cancels");
        batch.count_hits(&rays, &mut counts).expect("nobody cancels");
        let lists = collected(|sink| batch.all_hits(&rays, sink));
        let mut hits: Vec<Hit> = Vec::new();
        for (index, ray) in rays.iter().enumerate() {
            tracer.all_hits(ray, &mut hits);
            hits.retain(|hit| visible[hit.triangle as usize] && hit.triangle != except[index]);
            assert_eq!(hits, lists[index], "{ray:?}");
            assert_eq!(hits.first().copied(), closest[index], "{ray:?}");
            assert_eq!((!hits.is_empty(), hits.len()), (any[index], counts[index] as usize));
        }
    }
}

/// Rays through a thousand layers: far more hits than are kept, in the right order still.
#[test]
fn lists_longer_than_what_is_kept_come_whole() {
    let layer = |z: u32| [[-1.0, -1.0], [1.0, -1.0], [0.0, 2.0]].map(|[x, y]| [x, y, z as f32]);
    let positions: Vec<[f32; 3]> = (0..1000).flat_map(layer).collect();
    let triangles: Vec<[u32; 3]> = (0..1000).map(|z| [3 * z, 3 * z + 1, 3 * z + 2]).collect();
    let mesh = Mesh::new(&positions, &triangles).expect("sound");
    let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
    let tracer = Tracer::new(&mesh, &tree);
    let ray = |index: usize| Ray::new([1e-4 * index as f32, 0.0, -1.0], [0.0, 0.0, 1.0]);
    let rays: Vec<Ray> = (0..3000).map(ray).collect();
    let batch = tracer.batch(BatchOptions { threads: 2, ..BatchOptions::default() });
    let (mut most, mut next) = (0, 0);
    let streamed = batch.expect("threads").all_hits(&rays, |lists| {
        assert_eq!(lists.first, next);
        next += lists.lists().count();
        most = most.max(lists.items.len());
        assert!(lists.lists().all(|hits| hits.len() == 1000 && hits.is_sorted_by_key(|h| h.t)));
        ControlFlow::Continue(())
    });
    assert_eq!((streamed, next), (Ok(()), rays.len()));
    assert!(most < 100_000, "{most} items at a time");
}

#[test]
fn a_sink_that_breaks_ends_the_batch() {
    let Setup { tracer, rays, .. } = setup();
    let mut parts = 0;
    let batch = tracer.batch(BatchOptions::default()).expect("no threads are started");
    let ended = batch.all_hits(&rays, |_| {
        parts += 1;
        ControlFlow::Break(())
    });
    assert_eq!((ended, parts), (Ok(()), 1));
}

#[test]
fn progress_reaches_one_and_never_falls() {
    let Setup { tracer, rays, points, .. } = setup();
    for options in all_options() {
        let reports = Mutex::new(Vec::new());
        let report = |fraction| reports.lock().expect("no panic").push(fraction);
        let options = BatchOptions { progress: Some(&report), ..options };
        let batch = tracer.batch(options).expect("threads");
        batch.any_hits(&rays, &mut vec![false; COUNT]).expect("nobody cancels");
        batch.all_hits(&rays, |_| ControlFlow::Continue(())).expect("nobody cancels");
        batch.contains(&points, Sign::Parity, &mut vec![false; COUNT]).expect("nobody cancels");
        let reports = reports.lock().expect("no panic");
        assert_eq!(reports.iter().filter(|fraction| **fraction == 1.0).count(), 3);
        assert!(reports.iter().all(|fraction| (0.0..=1.0).contains(fraction)));
    }
}

#[test]
fn a_cancelled_batch_ends_soon() {
    let Setup { tracer, rays, .. } = setup();
    for options in all_options() {
        let (cancel, reports) = (AtomicBool::new(false), AtomicUsize::new(0));
        let report = |_: f32| {
            reports.fetch_add(1, Ordering::Relaxed);
            cancel.store(true, Ordering::Relaxed);
        };
        let options = BatchOptions { progress: Some(&report), cancel: Some(&cancel), ..options };
        let batch = tracer.batch(options).expect("threads");
        let ended = batch.closest_hits(&rays, &mut vec![None; COUNT]);
        assert_eq!(ended, Err(BatchError::Cancelled));
        assert!(reports.load(Ordering::Relaxed) <= 3, "no more than were under way");
        let ended = batch.all_hits(&rays, |_| panic!("it was cancelled before"));
        assert_eq!(ended, Err(BatchError::Cancelled));
    }
}

#[test]
fn no_queries_have_no_answers() {
    let Setup { tracer, .. } = setup();
    for options in all_options() {
        let batch = tracer.batch(options).expect("threads");
        assert_eq!(batch.closest_hits(&[], &mut []), Ok(()));
        assert_eq!(batch.all_hits(&[], |_| panic!("there are none")), Ok(()));
    }
}
