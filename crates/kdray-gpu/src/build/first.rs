//! The first level: one node. And the events of a node that has none, sorted.

use bytemuck::{bytes_of, cast_slice};

use kdray::build::{Limits, ordered};
use kdray::{Aabb, BuildError, BuildOptions, Mesh};

use super::arrays::Array;
use super::data::{Event, HEADER, Node, Part, Reference};
use super::driver::{Driver, Level, words};
use super::executor::Executor;
use super::{ends, flats, join, seed};

/// The triangles below a node, each with one reference there.
#[derive(Clone, Copy)]
pub(crate) struct Start<'a> {
    pub(crate) positions: &'a [[f32; 3]],
    pub(crate) triangles: &'a [[u32; 3]],
    /// Of the node.
    pub(crate) bounds: Aabb,
    pub(crate) depth: u32,
    /// By reference, unless the node is the root: bounds of what is left of its triangle.
    pub(crate) parts: &'a [Part],
    pub(crate) limits: Limits,
}

impl<'a> Start<'a> {
    /// The root of a mesh.
    pub(crate) fn root(mesh: &'a Mesh, options: &BuildOptions) -> Result<Self, BuildError> {
        let (positions, triangles) = (mesh.positions(), mesh.triangles());
        let (bounds, limits) = (mesh.bounds(), Limits::new(mesh, options)?);
        Ok(Self { positions, triangles, bounds, depth: 0, parts: &[], limits })
    }

    /// Bytes of the mesh.
    pub(super) fn mesh_bytes(&self) -> u64 {
        (size_of_val(self.positions) + size_of_val(self.triangles)) as u64
    }
}

/// What the events of an axis are sorted in.
const SORTED: [Array; 4] = [Array::Keys, Array::Values, Array::NextKeys, Array::NextValues];

impl<E: Executor> Driver<'_, E> {
    /// Brings the triangles to the device, and makes their node the level. It has no events yet.
    pub(super) fn first(&mut self, start: &Start) -> Result<Level, E::Error> {
        let (triangles, depth) = (self.params.triangles, start.depth);
        self.device.stage("events", depth);
        self.device.upload(Array::Positions, cast_slice(start.positions))?;
        self.device.upload(Array::Triangles, cast_slice(start.triangles))?;
        if depth > 0 {
            self.device.upload(Array::Bounds, cast_slice(start.parts))?;
        }
        let node = Node {
            lower: start.bounds.lower.map(ordered),
            first: 0,
            upper: start.bounds.upper.map(ordered),
            count: triangles,
            fresh_first: 0,
            fresh_count: triangles,
        };
        self.device.upload(Array::Nodes, cast_slice(bytes_of(&node)))?;
        self.device.reserve(Array::References, HEADER + words::<Reference>(triangles))?;
        self.run(&seed::SEED, triangles.max(1))?;
        Ok(Level { nodes: 1, references: triangles, first_record: 0, depth, is_narrow: true })
    }

    /// Gives a narrow level the events of all axes.
    pub(super) fn widen(&mut self, level: Level) -> Result<Level, E::Error> {
        self.device.stage("events", level.depth);
        self.params.has_bounds = level.has_bounds();
        self.params.base_axis = 0;
        self.device.reserve(Array::Events, words::<Event>(6 * level.references))?;
        for axis in 0..3 {
            self.sort_axis(&level, axis)?;
        }
        self.free_sorted();
        self.device.free(Array::Bounds);
        Ok(Level { is_narrow: false, ..level })
    }

    /// Makes the events of a node along an axis. One axis after the other is sorted, so that they share
    /// the room.
    pub(super) fn sort_axis(&mut self, level: &Level, axis: u32) -> Result<(), E::Error> {
        let references = level.references;
        self.params.events = 2 * references;
        self.params.axis = axis;
        self.device.reserve(Array::Bounds, 0)?;
        self.device.reserve(Array::Sums, references as usize + 1)?;
        self.run(&flats::FLATS, references + 1)?;
        self.device.scan(Array::Sums, references + 1)?;
        let [keys, values, next_keys, next_values] = SORTED;
        for array in [keys, values] {
            self.device.reserve(array, 2 * references.max(1) as usize)?;
        }
        self.run(&ends::ENDS, references.max(1))?;
        self.device.free(Array::Sums);
        for array in [next_keys, next_values] {
            self.device.reserve(array, 2 * references.max(1) as usize)?;
        }
        self.device.sort(SORTED, 2 * references)?;
        [next_keys, next_values].into_iter().for_each(|array| self.device.free(array));
        let axes = axis - self.params.base_axis + 1;
        self.device.reserve(Array::Events, words::<Event>(2 * axes * references))?;
        self.run(&join::JOIN, 2 * references)
    }

    /// Gives back what the events were sorted in.
    pub(super) fn free_sorted(&mut self) {
        SORTED.into_iter().for_each(|array| self.device.free(array));
        self.device.free(Array::Sums);
    }
}
