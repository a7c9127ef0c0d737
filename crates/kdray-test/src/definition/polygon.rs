//! Clipping in double precision, and boxes of what is left.

use kdray::Aabb;

/// A box in double precision.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) lower: [f64; 3],
    pub(super) upper: [f64; 3],
}

impl Bounds {
    pub(super) fn of(aabb: &Aabb) -> Self {
        Self { lower: aabb.lower.map(f64::from), upper: aabb.upper.map(f64::from) }
    }

    pub(super) fn of_points(points: &[[f64; 3]]) -> Self {
        let fold = |axis: usize, pick: fn(f64, f64) -> f64, start| {
            points.iter().map(|point| point[axis]).fold(start, pick)
        };
        Self {
            lower: [0, 1, 2].map(|axis| fold(axis, f64::min, f64::INFINITY)),
            upper: [0, 1, 2].map(|axis| fold(axis, f64::max, f64::NEG_INFINITY)),
        }
    }

    pub(super) fn grown(&self, margin: f64) -> Self {
        Self { lower: self.lower.map(|v| v - margin), upper: self.upper.map(|v| v + margin) }
    }

    /// What both have in common.
    pub(super) fn and(&self, other: &Self) -> Self {
        Self {
            lower: [0, 1, 2].map(|axis| self.lower[axis].max(other.lower[axis])),
            upper: [0, 1, 2].map(|axis| self.upper[axis].min(other.upper[axis])),
        }
    }

    pub(super) fn half_area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| self.upper[axis] - self.lower[axis]);
        x * y + y * z + z * x
    }
}

/// Bounds of the part of a triangle inside a box, or `None` if there is none.
pub(super) fn clip(corners: &[[f32; 3]; 3], bounds: &Bounds) -> Option<Bounds> {
    let mut polygon: Vec<[f64; 3]> = corners.iter().map(|corner| corner.map(f64::from)).collect();
    for axis in 0..3 {
        polygon = cut(&polygon, axis, bounds.lower[axis], 1.0);
        polygon = cut(&polygon, axis, bounds.upper[axis], -1.0);
    }
    (!polygon.is_empty()).then(|| Bounds::of_points(&polygon).and(bounds))
}

/// The part of `polygon` where `side * (coordinate - plane) >= 0`.
fn cut(polygon: &[[f64; 3]], axis: usize, plane: f64, side: f64) -> Vec<[f64; 3]> {
    let height = |corner: &[f64; 3]| side * (corner[axis] - plane);
    let mut kept = Vec::new();
    for (index, here) in polygon.iter().enumerate() {
        let next = &polygon[(index + 1) % polygon.len()];
        let (from, to) = (height(here), height(next));
        if from >= 0.0 {
            kept.push(*here);
        }
        if (from >= 0.0) != (to >= 0.0) {
            let t = from / (from - to);
            let mut crossing = [0, 1, 2].map(|other| here[other] + (next[other] - here[other]) * t);
            crossing[axis] = plane;
            kept.push(crossing);
        }
    }
    kept
}
