//! Trace rays through a tree.
//!
//! # Watertight, and exactly once
//!
//! What a ray hits is a matter of the mesh alone, not of the tree, the order of the triangles, the
//! query or the processor:
//!
//! * Triangles that share an edge share one answer to the question on which side of it the ray
//!   passes. So a ray through the inside of a surface, through its edges and its vertices, hits one
//!   of the triangles there, and only one.
//! * Hence a whole line, `t` from minus to plus infinity, crosses a closed mesh an even number of
//!   times, whatever edges, vertices and flat faces lie in its way: along the axes, in the planes
//!   of the tree, through slivers. A mesh is closed if every edge, by the positions of its ends,
//!   has an even number of triangles. It may intersect itself and be wound in any way.
//! * [`Tracer::all_hits`] has every crossing once, in order of `t` and then of the triangle, and
//!   each is exactly the hit that [`intersect`](intersect()) gives for its triangle.
//!
//! This is where it ends:
//!
//! * A triangle that is seen edge-on, and one without area, is never hit. Its neighbours are, as if
//!   it were not there.
//! * Triangles that lie on each other are each hit: two coincident faces are two crossings.
//! * At vertices and edges where a surface only touches the line, as at the tip of a cone seen from
//!   the side, there are two crossings or none; either is even.
//! * Positions count as they are in the mesh, in f32. Ends of edges that differ in the last bit are
//!   different ends, and there is a gap between them.
//! * `t` is rounded to f32. Crossings nearer to each other than that may come in the order of their
//!   triangles; and a ray that starts on the surface may count the crossing at its origin or not:
//!   leave its triangle out, by [`Tracer::only`] or [`BatchOptions::except`], to be sure.
//!
//! # Parts
//!
//! `collapse` lays the tree out in the nodes of eight boxes of `wide`; `prepare` makes of a ray
//! what traversal needs, and `hull` knows rays that pass beside everything; `traverse` visits the leaves along it from front to back, `walk`ing `step`
//! by `step`, and `stream` does so for several rays at a time, in turns, for which they are `waiting`, or as a
//! `packet`: their `coherence` says which. `lists` has
//! all hits of many rays, as a `wave` where each goes its own way. `block` holds the triangles of a
//! leaf, eight at a time, and `filter` finds those that a ray hits; `simd` says with which
//! instructions, those of NEON in `neon`; `vector` is arithmetic on eight or sixteen numbers, `sift`
//! says by it which triangles may be hit, which is `sifted`, and `located` where: one, a `lane` of a
//! block, or `several`.
//! `intersect` says for one triangle what a hit is:
//! it is the definition that everything else is tested against. `hits` keeps what the queries want
//! of the hits. `leaves` is the same visit for whoever asks, in strict order. `near` visits the
//! leaves around a point, for the queries of `proximity`: `tilt` has second boxes along the
//! surface, `apart` says how far the triangles of a block are at least and at most, with the
//! arithmetic of `eights`, and `closest` keeps those that may be the closest. `sign` tells inside
//! from outside, `grid` does so cell by cell, and `batch` asks many things at once.

mod apart;
mod batch;
mod block;
#[cfg(target_arch = "x86_64")]
mod block_ray;
mod closest;
mod coherence;
mod collapse;
mod eights;
#[cfg(target_arch = "x86_64")]
mod filter;
mod fullness;
mod grid;
mod hits;
mod hull;
mod intersect;
#[cfg(target_arch = "x86_64")]
mod lane;
mod leaves;
mod lists;
#[cfg(target_arch = "x86_64")]
mod located;
mod near;
#[cfg(target_arch = "aarch64")]
mod neon;
#[cfg(test)]
mod noise;
mod only;
#[cfg(target_arch = "x86_64")]
mod opaque;
#[cfg(target_arch = "x86_64")]
mod packet;
mod pending;
mod prepare;
mod proximity;
#[cfg(target_arch = "x86_64")]
mod several;
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod sift;
mod sifted;
mod sign;
mod simd;
mod stack;
mod step;
mod stream;
mod tilt;
mod tracer;
mod traverse;
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64"))]
mod vector;
mod waiting;
mod walk;
#[cfg(target_arch = "x86_64")]
mod wave;
mod wide;

pub use batch::{Batch, BatchError, BatchOptions, Lists};
pub use intersect::intersect;
pub use leaves::Leaf;
pub use only::Only;
pub use proximity::ClosestPoint;
pub use sign::Sign;
pub use tracer::{Counts, Tracer};
