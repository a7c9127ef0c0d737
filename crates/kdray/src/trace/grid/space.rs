//! How the box of a mesh is cut into cells.

use crate::geometry::Aabb;

/// Cells a triangle, about. Twice as many leave fewer points to rays, and take twice the memory.
const CELLS_PER_TRIANGLE: f64 = 16.0;

/// The most cells along an axis, on either side of the middle.
const MOST: f64 = 2048.0;

/// How many of the smallest steps of a coordinate a cell is wide at least. Roundings are some of
/// these steps, and fewer than a [margin](super::MARGIN) has.
const STEPS: f64 = 512.0;

/// Columns of cells along the axis of the ways out, [halved](Self::cell) in the middle of the box.
///
/// Places in the box are given by two coordinates across the columns and one along them, from the
/// lower corner on and in units of a cell.
#[derive(Clone, Copy)]
pub(super) struct Space {
    bounds: Aabb,
    /// Those across, and the one along the columns.
    axes: [usize; 3],
    cells_per_unit: [f32; 3],
    /// Cells across, and of a column on either side of the middle.
    pub(super) counts: [usize; 3],
}

impl Space {
    /// Cells for a box with so many triangles in it. `None` for a box without size, or of a size
    /// that numbers are not made for.
    pub(super) fn new(bounds: Aabb, along: usize, triangles: usize) -> Option<Self> {
        let cells = CELLS_PER_TRIANGLE * triangles as f64;
        let axes = [(along + 1) % 3, (along + 2) % 3, along];
        let extents = axes.map(|axis| f64::from(bounds.upper[axis] - bounds.lower[axis]));
        let longest = extents.into_iter().fold(0.0, f64::max);
        // A flat box has the cells of a thin one.
        let volume: f64 = extents.into_iter().map(|extent| extent.max(1e-3 * longest)).product();
        Self::of_cells(bounds, axes, (volume / cells).cbrt())
    }

    /// Cells twice as wide.
    pub(super) fn coarser(&self) -> Option<Self> {
        let widest = self.cells_per_unit.into_iter().fold(0.0, f32::max);
        Self::of_cells(self.bounds, self.axes, 2.0 / f64::from(widest))
    }

    fn of_cells(bounds: Aabb, axes: [usize; 3], side: f64) -> Option<Self> {
        let reach =
            bounds.lower.iter().chain(&bounds.upper).fold(0.0, |most: f32, x| most.max(x.abs()));
        let step = f64::from(reach) * f64::from(f32::EPSILON);
        let (mut counts, mut cells_per_unit) = ([1; 3], [0.0; 3]);
        for place in 0..3 {
            let whole = f64::from(bounds.upper[axes[place]] - bounds.lower[axes[place]]);
            let extent = if place == 2 { 0.5 * whole } else { whole };
            if extent > 0.0 {
                let most = (extent / (STEPS * step)).clamp(1.0, MOST);
                let count = (extent / side).ceil().clamp(1.0, most).floor();
                (counts[place], cells_per_unit[place]) = (count as usize, (count / extent) as f32);
            }
        }
        let is_sound = side > 0.0 && cells_per_unit.iter().all(|number| number.is_finite());
        is_sound.then_some(Self { bounds, axes, cells_per_unit, counts })
    }

    /// How many cells there are.
    pub(super) fn len(&self) -> usize {
        2 * self.counts.into_iter().product::<usize>()
    }

    /// The first cell of the half of a column that is below the middle, or above it.
    pub(super) fn column(&self, [x, y]: [usize; 2], is_above: bool) -> usize {
        (2 * (x * self.counts[1] + y) + usize::from(is_above)) * self.counts[2]
    }

    /// The cell that a point of the box is in. Along a column cells are counted from the nearer
    /// end, the one where the [way out](crate::Tracer::way_out) ends.
    #[inline]
    pub(super) fn cell(&self, point: &[f32; 3]) -> usize {
        let Aabb { lower, upper } = &self.bounds;
        let [across, other, along] = self.axes;
        let at = |place: usize, distance: f32| {
            ((distance * self.cells_per_unit[place]) as usize).min(self.counts[place] - 1)
        };
        let below = point[along] - lower[along];
        let above = upper[along] - point[along];
        let is_above = above <= below;
        let x = at(0, point[across] - lower[across]);
        let y = at(1, point[other] - lower[other]);
        self.column([x, y], is_above) + at(2, if is_above { above } else { below })
    }

    /// A point in units of cells.
    pub(super) fn place(&self, point: &[f32; 3]) -> [f64; 3] {
        [0, 1, 2].map(|place| {
            let axis = self.axes[place];
            let distance = f64::from(point[axis]) - f64::from(self.bounds.lower[axis]);
            distance * f64::from(self.cells_per_unit[place])
        })
    }

    /// How high the box is, in units of cells.
    pub(super) fn height(&self) -> f64 {
        self.place(&self.bounds.upper)[2]
    }

    /// A point at the foot of a column, in its middle; and the axis along which it rises.
    pub(super) fn foot(&self, column: [usize; 2]) -> ([f32; 3], usize) {
        let mut foot = self.bounds.lower;
        for place in 0..2 {
            if self.cells_per_unit[place] > 0.0 {
                foot[self.axes[place]] += (column[place] as f32 + 0.5) / self.cells_per_unit[place];
            }
        }
        (foot, self.axes[2])
    }

    /// A length along a column, in units of cells.
    pub(super) fn rise(&self, length: f32) -> f64 {
        f64::from(length) * f64::from(self.cells_per_unit[2])
    }
}
