//! Budgets, cancellation and progress.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use kdray::{BuildError, BuildOptions, Builder, Mesh, Tree};
use kdray_mesh::generate::sphere;

const BUILDERS: [Builder; 3] = [Builder::Exact, Builder::Resort, Builder::Naive];

/// Small enough for the naive builder.
fn small() -> Mesh {
    sphere(2).mesh().expect("generated meshes are sound")
}

/// Many small subtrees for the exact builder.
fn large() -> Mesh {
    sphere(6).mesh().expect("generated meshes are sound")
}

#[test]
fn a_budget_that_cannot_hold_is_an_error_that_names_the_stage() {
    for builder in BUILDERS {
        let mesh = small();
        let options =
            BuildOptions { builder, memory_budget: Some(1000), ..BuildOptions::default() };
        let error = Tree::build(&mesh, &options).expect_err("1000 bytes are too few");
        let BuildError::MemoryBudget { stage, needed, budget } = &error else { panic!("{error}") };
        assert!(!stage.is_empty() && *needed > 1000 && *budget == 1000, "{error}");
        assert!(error.to_string().contains("1000 bytes"), "{error}");
    }
}

#[test]
fn the_reported_peak_is_a_budget_that_holds() {
    for builder in BUILDERS {
        for mesh in [small(), large()] {
            if builder == Builder::Naive && mesh.triangles().len() > 1000 {
                continue;
            }
            let options = BuildOptions { builder, threads: 1, ..BuildOptions::default() };
            let (tree, report) = Tree::build_reported(&mesh, &options).expect("no budget");
            let within = |bytes| BuildOptions { memory_budget: Some(bytes), ..options.clone() };
            let held = Tree::build(&mesh, &within(report.peak_bytes)).expect("the peak holds");
            assert_eq!(held, tree);
            let error = Tree::build(&mesh, &within(report.peak_bytes - 1));
            let error = error.expect_err("one byte less than the peak");
            assert!(matches!(error, BuildError::MemoryBudget { .. }), "{error}");
            assert!(report.peak_bytes >= tree.size_bytes() as u64, "the tree is part of the peak");
        }
    }
}

#[test]
fn threads_may_exceed_no_budget_either() {
    let mesh = large();
    let options =
        BuildOptions { threads: 4, memory_budget: Some(2_000_000), ..BuildOptions::default() };
    let error = Tree::build(&mesh, &options).expect_err("25 bytes a triangle are too few");
    assert!(matches!(error, BuildError::MemoryBudget { .. }), "{error}");
}

#[test]
fn a_build_that_was_cancelled_before_it_began_ends_at_once() {
    let cancel = AtomicBool::new(true);
    for builder in BUILDERS {
        let options = BuildOptions { builder, cancel: Some(&cancel), ..BuildOptions::default() };
        assert_eq!(Tree::build(&small(), &options), Err(BuildError::Cancelled));
    }
}

#[test]
fn a_build_can_be_cancelled_while_it_runs() {
    for (builder, threads) in
        [(Builder::Exact, 1), (Builder::Exact, 3), (Builder::Resort, 1), (Builder::Naive, 1)]
    {
        let mesh = if builder == Builder::Exact { large() } else { small() };
        let cancel = AtomicBool::new(false);
        let calls = AtomicUsize::new(0);
        let progress = |_: f32| {
            calls.fetch_add(1, Ordering::Relaxed);
            cancel.store(true, Ordering::Relaxed);
        };
        let options = BuildOptions {
            builder,
            threads,
            cancel: Some(&cancel),
            progress: Some(&progress),
            ..BuildOptions::default()
        };
        assert_eq!(Tree::build(&mesh, &options), Err(BuildError::Cancelled), "{builder:?}");
        let calls = calls.load(Ordering::Relaxed);
        assert!((1..=20).contains(&calls), "{builder:?} went on for {calls} reports");
    }
}

#[test]
fn progress_grows_and_ends_at_one() {
    for (builder, threads) in
        [(Builder::Exact, 1), (Builder::Exact, 3), (Builder::Resort, 1), (Builder::Naive, 1)]
    {
        let mesh = if builder == Builder::Exact { large() } else { small() };
        let seen = Mutex::new(Vec::new());
        let progress = |fraction: f32| seen.lock().expect("no test panics here").push(fraction);
        let options =
            BuildOptions { builder, threads, progress: Some(&progress), ..BuildOptions::default() };
        Tree::build(&mesh, &options).expect("the options are in range");
        let seen = seen.into_inner().expect("no test panics here");
        assert!(seen.is_sorted() && seen[0] > 0.0, "{seen:?}");
        assert_eq!(seen.last(), Some(&1.0), "{builder:?}");
        // More than the end, and not for every node.
        assert!((3..=120).contains(&seen.len()), "{builder:?}: {} reports", seen.len());
    }
}

#[test]
fn options_out_of_range_are_errors() {
    let refused = |options: BuildOptions| {
        let error = Tree::build(&small(), &options).expect_err("out of range");
        assert!(matches!(error, BuildError::Option { .. }), "{error}");
    };
    refused(BuildOptions { max_depth: Some(256), ..BuildOptions::default() });
    for wrong in [0.0, -1.0, f32::NAN, f32::INFINITY, 1e-30] {
        let mut options = BuildOptions::default();
        options.cost.traversal = wrong;
        refused(options);
        let mut options = BuildOptions::default();
        options.cost.intersect = wrong;
        refused(options);
    }
    for wrong in [-0.1, 1.0, f32::NAN] {
        let mut options = BuildOptions::default();
        options.cost.empty_bonus = wrong;
        refused(options);
    }
}
