//! Scenes and solids made by the program itself: no files, any size, the same bits on every machine.
//!
//! Coordinates are computed in `f64` with the basic operations and the `libm` crate alone, which give equal
//! results everywhere, and rounded to `f32` at the end. Random numbers are PCG32. The surfaces
//! said to be closed are watertight by construction: neighbouring triangles share indices, every
//! edge has exactly two triangles, and fronts face outwards.

mod shapes;
mod showcase;
mod solids;
mod surface;
mod vector;

pub use shapes::{grid, slivers, soup};
pub use showcase::showcase;
pub use solids::{cube, sphere, torus_knot};

#[cfg(test)]
mod tests;
