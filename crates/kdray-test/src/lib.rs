//! Scenes, oracles and helpers for the tests of kdray.
//!
//! [`scenes`] and [`degenerate`] make the meshes, [`rays`] the rays that go where ties are, and
//! [`presets`] the options. [`oracle`] answers queries by trying every triangle, [`sieve`] does
//! so for millions of rays, [`exact`] tests one
//! triangle in rational numbers, [`definition`] checks a tree plane by plane against what the
//! tree is defined to be, and [`tree_file`] damages trees on purpose.

pub mod definition;
pub mod degenerate;
pub mod exact;
pub mod oracle;
pub mod presets;
pub mod random;
pub mod rays;
pub mod scenes;
pub mod shared;
pub mod sieve;
pub mod tree_file;
pub mod vulkan;

pub use random::Random;
pub use scenes::Scene;
