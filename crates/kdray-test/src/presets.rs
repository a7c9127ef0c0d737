//! Option sets that make different trees.

use kdray::{BuildOptions, Cost};

/// Options by name. All build on one thread, since most scenes are small.
#[must_use]
pub fn all() -> Vec<(&'static str, BuildOptions<'static>)> {
    let default = || BuildOptions { threads: 1, ..BuildOptions::default() };
    let priced = |traversal, intersect, empty_bonus| BuildOptions {
        cost: Cost { traversal, intersect, empty_bonus },
        ..default()
    };
    let depth = |depth| BuildOptions { max_depth: Some(depth), ..default() };
    vec![
        ("default", default()),
        ("without clipping", BuildOptions { clip: false, ..default() }),
        ("prices 15 and 20", priced(15.0, 20.0, 0.0)),
        ("prices 1 and 1", priced(1.0, 1.0, 0.5)),
        ("prices 1 and 80", priced(1.0, 80.0, 0.8)),
        ("prices 1 and 80, unclipped", BuildOptions { clip: false, ..priced(1.0, 80.0, 0.2) }),
        ("depth 0", depth(0)),
        ("depth 1", depth(1)),
        ("depth 5", depth(5)),
        ("depth 255", BuildOptions { max_depth: Some(255), ..priced(1.0, 4.0, 0.0) }),
        ("leaves of four", BuildOptions { max_leaf: 4, ..default() }),
    ]
}

/// A few of them that make the most different trees, for tests that take long.
#[must_use]
pub fn few() -> Vec<(&'static str, BuildOptions<'static>)> {
    let wanted = ["default", "without clipping", "prices 1 and 80", "depth 5"];
    all().into_iter().filter(|(name, _)| wanted.contains(name)).collect()
}
