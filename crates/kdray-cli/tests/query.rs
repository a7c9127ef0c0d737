//! `kdray query`.

mod common;

use std::fs::File;

use common::Bench;
use kdray::{BuildOptions, Hit, Mesh, Ray, Tracer, Tree};
use ndarray::{Array1, Array2, Ix1, Ix2};
use ndarray_npy::{NpzReader, ReadableElement, WritableElement, WriteNpyExt};

fn knot() -> (Mesh, Tracer) {
    let mesh = kdray_mesh::generate::torus_knot([2, 3], 60, 12).mesh().expect("sound");
    let tree = Tree::build(&mesh, &BuildOptions::default()).expect("the options are in range");
    let tracer = Tracer::new(&mesh, &tree);
    (mesh, tracer)
}

/// Rays from a circle around the knot through its middle.
fn rays() -> Vec<Ray> {
    let ray = |index: usize| {
        let (sin, cos) = (0.37 * index as f32).sin_cos();
        let origin = [9.0 * cos, 0.01 * index as f32, 9.0 * sin];
        Ray { t_min: 0.25, t_max: 1.75, ..Ray::new(origin, origin.map(|v| -v)) }
    };
    (0..200).map(ray).collect()
}

/// Half of them between the first and the second hit of a ray, where there are.
fn points(tracer: &Tracer) -> Vec<[f32; 3]> {
    let mut hits = Vec::new();
    let mut point = |(index, ray): (usize, &Ray)| {
        tracer.first_hits(ray, 2, &mut hits);
        match hits[..] {
            [first, second] if index % 2 == 0 => ray.at(0.5 * (first.t + second.t)),
            _ => ray.at(0.7),
        }
    };
    rays().iter().enumerate().map(&mut point).collect()
}

fn write<T: WritableElement, const N: usize>(bench: &Bench, name: &str, rows: Vec<[T; N]>)
where
    Array2<T>: From<Vec<[T; N]>>,
{
    let file = File::create(bench.path(name)).expect("the folder can be written");
    Array2::from(rows).write_npy(file).expect("written");
}

fn columns(ray: &Ray) -> [f32; 8] {
    let Ray { origin: [x, y, z], direction: [dx, dy, dz], t_min, t_max } = *ray;
    [x, y, z, dx, dy, dz, t_min, t_max]
}

fn read<T: ReadableElement + Clone>(bench: &Bench, name: &str) -> Vec<T> {
    let file = File::open(bench.path("out.npz")).expect("it was written");
    let array: Array1<T> =
        NpzReader::new(file).expect("a .npz file").by_name::<_, Ix1>(name).expect(name);
    array.to_vec()
}

#[test]
fn rays_are_answered_as_the_library_does() {
    let (bench, (_, tracer), rays) = (Bench::new(), knot(), rays());
    write(&bench, "f32.npy", rays.iter().map(columns).collect());
    write(&bench, "f64.npy", rays.iter().map(|ray| columns(ray).map(f64::from)).collect());
    for file in ["f32", "f64"] {
        let run = |kind: &str| {
            let more = "-o out.npz --threads 2 --repeat 2";
            bench
                .kdray(&format!("query knot.off --rays {file}.npy {kind} {more}"))
                .assert()
                .success();
        };
        let hits: Vec<Option<Hit>> = rays.iter().map(|ray| tracer.closest_hit(ray)).collect();
        assert!(hits.iter().flatten().count() > 50 && hits.contains(&None));
        run("");
        let or_miss = |value: fn(&Hit) -> f32, miss: f32| -> Vec<f32> {
            hits.iter().map(|hit| hit.as_ref().map_or(miss, value)).collect()
        };
        assert_eq!(read::<f32>(&bench, "t"), or_miss(|hit| hit.t, f32::INFINITY));
        assert_eq!(read::<f32>(&bench, "u"), or_miss(|hit| hit.u, 0.0));
        assert_eq!(read::<f32>(&bench, "v"), or_miss(|hit| hit.v, 0.0));
        let triangles = hits.iter().map(|hit| hit.map_or(u32::MAX, |hit| hit.triangle));
        assert_eq!(read::<u32>(&bench, "triangle"), triangles.collect::<Vec<_>>());
        run("--kind any --reorder");
        let any: Vec<bool> = hits.iter().map(Option::is_some).collect();
        assert_eq!(read::<bool>(&bench, "hit"), any);
        run("--kind count");
        let counts: Vec<u32> = rays.iter().map(|ray| tracer.count_hits(ray) as u32).collect();
        assert_eq!(read::<u32>(&bench, "count"), counts);
        run("--kind all");
        let (offsets, t) = (read::<u64>(&bench, "offsets"), read::<f32>(&bench, "t"));
        let triangles = read::<u32>(&bench, "triangle");
        let mut all = Vec::new();
        for (index, ray) in rays.iter().enumerate() {
            tracer.all_hits(ray, &mut all);
            let range = offsets[index] as usize..offsets[index + 1] as usize;
            let found = t[range.clone()].iter().zip(&triangles[range]);
            assert!(found.eq(all.iter().map(|hit| (&hit.t, &hit.triangle))));
        }
        assert_eq!((offsets.len(), *offsets.last().expect("one") as usize), (201, t.len()));
    }
}

#[test]
fn points_are_answered_as_the_library_does() {
    let (bench, (_, tracer)) = (Bench::new(), knot());
    let points = points(&tracer);
    write(&bench, "points.npy", points.clone());
    let run = |kind: &str| {
        let command = format!("query knot.off --points points.npy {kind} -o out.npz");
        bench.kdray(&command).assert().success();
    };
    run("--kind contains");
    let inside: Vec<bool> = points.iter().map(|point| tracer.contains(*point)).collect();
    assert_eq!(read::<bool>(&bench, "inside"), inside);
    assert!(inside.contains(&true) && inside.contains(&false));
    run("--kind contains --sign winding");
    assert_eq!(read::<bool>(&bench, "inside"), inside);
    let closest = |point: &[f32; 3]| tracer.closest_point(*point, f32::INFINITY).expect("one");
    run("--kind signed-distance");
    let signed = points.iter().zip(&inside).map(|(point, inside)| {
        let distance = f64::from(closest(point).distance);
        if *inside { -distance } else { distance }
    });
    assert_eq!(read::<f64>(&bench, "distance"), signed.collect::<Vec<_>>());
    run("");
    let triangles: Vec<u32> = points.iter().map(|point| closest(point).triangle).collect();
    assert_eq!(read::<u32>(&bench, "triangle"), triangles);
    let file = File::open(bench.path("out.npz")).expect("it was written");
    let places: Array2<f64> =
        NpzReader::new(file).expect("a .npz file").by_name::<_, Ix2>("point").expect("there");
    for (place, point) in places.outer_iter().zip(&points) {
        assert_eq!(place.to_vec(), closest(point).point.map(f64::from));
    }
    run("--kind closest-point --radius 0.125");
    let near = |point: &[f32; 3]| tracer.closest_point(*point, 0.125).map(|it| it.distance);
    let distances = points.iter().map(|point| near(point).map_or(f64::INFINITY, f64::from));
    assert_eq!(read::<f64>(&bench, "distance"), distances.collect::<Vec<_>>());
    run("--kind within --radius 0.5");
    let (offsets, triangles) = (read::<u64>(&bench, "offsets"), read::<u32>(&bench, "triangle"));
    let mut within = Vec::new();
    for (index, point) in points.iter().enumerate() {
        tracer.within_sphere(*point, 0.5, &mut within);
        assert_eq!(triangles[offsets[index] as usize..offsets[index + 1] as usize], within);
    }
    assert!(!triangles.is_empty());
}

#[test]
fn doubles_far_from_the_origin_are_not_rounded() {
    let bench = Bench::new();
    let far = 5e8;
    let off = format!("OFF\n3 1 0\n{far} 0 0\n{} 0 0\n{far} 1 0\n3 0 1 2\n", far + 1.0);
    bench.write("far.off", &off);
    write(&bench, "rays.npy", vec![[far + 0.25, 0.25, 2.0, 0.0, 0.0, -1.0]]);
    bench.kdray("query far.off --rays rays.npy -o out.npz").assert().success();
    assert_eq!((read::<f32>(&bench, "t"), read::<f32>(&bench, "u")), (vec![2.0], vec![0.25]));
    write(&bench, "points.npy", vec![[far + 0.25, 0.25, 2.0]]);
    bench.kdray("query far.off --points points.npy -o out.npz").assert().success();
    let file = File::open(bench.path("out.npz")).expect("it was written");
    let places: Array2<f64> =
        NpzReader::new(file).expect("a .npz file").by_name::<_, Ix2>("point").expect("there");
    assert_eq!(places, ndarray::array![[far + 0.25, 0.25, 0.0]]);
}

#[test]
fn the_times_are_one_object() {
    let bench = Bench::new();
    write(&bench, "rays.npy", rays().iter().map(columns).collect());
    let report = bench.json("query knot.off --rays rays.npy --repeat 3 --json");
    let keys: Vec<&str> = report.as_object().expect("an object").keys().map(|key| &**key).collect();
    assert_eq!(keys, ["build_s", "queries", "query_s", "query_s_median", "simd"]);
    assert_eq!((&report["queries"], &report["simd"]), (&200.into(), &Tracer::simd().into()));
    let seconds = |key: &str| report[key].as_f64().expect(key);
    assert!(0.0 < seconds("query_s") && seconds("query_s") <= seconds("query_s_median"));
    assert!(seconds("build_s") > 0.0);
    assert_eq!(bench.files(), ["cube.off", "knot.off", "rays.npy"], "no -o, no file");
}

#[test]
fn no_queries_have_no_answers() {
    let bench = Bench::new();
    write::<f32, 6>(&bench, "rays.npy", Vec::new());
    bench.kdray("query knot.off --rays rays.npy --kind all -o out.npz").assert().success();
    assert_eq!(read::<u64>(&bench, "offsets"), [0]);
    assert!(read::<f32>(&bench, "t").is_empty());
}

#[test]
fn what_cannot_be_asked_is_refused() {
    let bench = Bench::new();
    write(&bench, "rays.npy", rays().iter().map(columns).collect());
    write(&bench, "points.npy", points(&knot().1));
    let error = bench.error("query knot.off --rays rays.npy --kind contains");
    assert!(error.contains("Contains is not asked of rays: it needs --points"), "{error}");
    let error = bench.error("query knot.off --points points.npy --kind all");
    assert!(error.contains("All is not asked of points: it needs --rays"), "{error}");
    let error = bench.error("query knot.off --points points.npy --kind within");
    assert!(error.contains("within needs --radius"), "{error}");
    let error = bench.error("query knot.off --rays points.npy");
    assert!(
        error.contains("points.npy: its shape is (200, 3) instead of (n, 6) or (n, 8)"),
        "{error}"
    );
    let error = bench.error("query knot.off --points knot.off");
    assert!(error.contains("knot.off: it does not begin like a .npy file"), "{error}");
    let error = bench.error("query knot.off --points nothing.npy");
    assert!(error.contains("nothing.npy: "), "{error}");
    bench.kdray("query knot.off --rays rays.npy --points points.npy").assert().code(2);
    bench.kdray("query knot.off").assert().code(2);
    bench.kdray("query knot.off --points points.npy --radius -1").assert().code(2);
    bench.kdray("query knot.off --points points.npy --repeat 0").assert().code(2);
}
