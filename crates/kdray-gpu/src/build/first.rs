//! The first level: the root, and the events of all triangles, sorted.

use bytemuck::{bytes_of, cast_slice};

use kdray::Mesh;
use kdray::build::ordered;

use super::arrays::Array;
use super::data::{Event, HEADER, Node, Reference};
use super::driver::{Driver, words};
use super::executor::Executor;
use super::{flats, join, root};

/// What the events of an axis are sorted in.
const SORTED: [Array; 4] = [Array::Keys, Array::Values, Array::NextKeys, Array::NextValues];

impl<E: Executor> Driver<'_, E> {
    /// Makes the root the level. One axis after the other is sorted, so that they share the room.
    pub(super) fn root(&mut self, mesh: &Mesh) -> Result<(), E::Error> {
        let triangles = self.params.triangles;
        self.device.stage("events", 0);
        self.device.upload(Array::Positions, cast_slice(mesh.positions()))?;
        self.device.upload(Array::Triangles, cast_slice(mesh.triangles()))?;
        let bounds = mesh.bounds();
        let root = Node {
            lower: bounds.lower.map(ordered),
            first: 0,
            upper: bounds.upper.map(ordered),
            count: triangles,
            fresh_first: 0,
            fresh_count: triangles,
        };
        self.device.upload(Array::NextNodes, cast_slice(bytes_of(&root)))?;
        self.device.reserve(Array::NextReferences, HEADER + words::<Reference>(triangles))?;
        self.device.reserve(Array::NextEvents, words::<Event>(6 * triangles))?;
        self.device.reserve(Array::Sums, triangles as usize + 1)?;
        for array in SORTED {
            self.device.reserve(array, 2 * triangles as usize)?;
        }
        self.params.next_nodes = 1;
        self.params.next_events = 2 * triangles;
        for axis in 0..3 {
            self.params.axis = axis;
            self.run(&flats::FLATS, triangles + 1)?;
            self.device.scan(Array::Sums, triangles + 1)?;
            self.run(&root::ROOT, triangles.max(1))?;
            self.device.sort(SORTED, 2 * triangles)?;
            self.run(&join::JOIN, 2 * triangles)?;
        }
        SORTED.into_iter().for_each(|array| self.device.free(array));
        self.device.free(Array::Sums);
        self.descend();
        Ok(())
    }
}
