//! Polygons into triangles, without losing area or edges.
//!
//! A polygon is seen along the axis on which its normal is greatest. Convex ones become a fan; the
//! others lose one ear after the other. n corners always give n - 2 triangles, and every edge of the
//! polygon stays an edge of one of them, collinear and repeated corners included: neighbours that
//! share the edge still meet there, so closed meshes stay closed. Signs of areas are exact
//! (Shewchuk's predicates).
//!
//! Polygons that cross themselves have no such triangles without overlap. Theirs overlap, but still
//! cover every point that the polygon winds around. An ear clipper of our own, because `earcut` 0.4
//! leaves out parts of such polygons, edges included, and its work on a hostile one has no bound.

use robust::{Coord, orient2d};

/// Corner visits that one file may spend on ears: a few seconds. A polygon of 20,000 corners still fits.
const WORK: u64 = 1 << 29;

/// Makes triangles of polygons, with memory that is reused from one to the next.
pub(crate) struct Triangulator {
    points: Vec<Coord<f64>>,
    next: Vec<usize>,
    previous: Vec<usize>,
    reflex: Vec<bool>,
    work_left: u64,
}

impl Default for Triangulator {
    fn default() -> Self {
        Self {
            points: Vec::new(),
            next: Vec::new(),
            previous: Vec::new(),
            reflex: Vec::new(),
            work_left: WORK,
        }
    }
}

impl Triangulator {
    /// Adds the triangles of a polygon of four corners or more.
    ///
    /// False when it ran out of ears or of work, and the rest became a fan that overlaps itself.
    pub(crate) fn triangulate(
        &mut self,
        corners: &[u32],
        positions: &[[f64; 3]],
        triangles: &mut Vec<[u32; 3]>,
    ) -> bool {
        let mut emit = |[a, b, c]: [usize; 3]| triangles.push([corners[a], corners[b], corners[c]]);
        let has_area = self.project(corners, positions);
        if !has_area || self.is_convex() {
            (2..corners.len()).for_each(|corner| emit([0, corner - 1, corner]));
            return true;
        }
        self.clip_ears(&mut emit)
    }

    /// Puts the polygon into the plane, counter-clockwise; false when it has no area.
    fn project(&mut self, corners: &[u32], positions: &[[f64; 3]]) -> bool {
        let normal = newell_normal(corners, positions);
        let magnitude = normal.map(f64::abs);
        let axis = (0..3).fold(0, |best, k| if magnitude[k] > magnitude[best] { k } else { best });
        if !(magnitude[axis] > 0.0 && normal.iter().all(|n| n.is_finite())) {
            return false;
        }
        let (mut across, mut up) = ((axis + 1) % 3, (axis + 2) % 3);
        if normal[axis] < 0.0 {
            (across, up) = (up, across);
        }
        let point = |&corner: &u32| {
            let position = positions[corner as usize];
            Coord { x: position[across], y: position[up] }
        };
        self.points.clear();
        self.points.extend(corners.iter().map(point));
        true
    }

    /// Whether the polygon only ever turns left, and goes around once.
    fn is_convex(&self) -> bool {
        let count = self.points.len();
        let mut turns_to_the_right_half = 0;
        for corner in 0..count {
            let [a, b, c] = [corner, (corner + 1) % count, (corner + 2) % count];
            let (into, out) = (self.edge(a, b), self.edge(b, c));
            let turn = self.turn(a, b, c);
            let folds_back = turn == 0.0 && into.x * out.x + into.y * out.y < 0.0;
            if turn < 0.0 || folds_back || (out.x == 0.0 && out.y == 0.0) {
                return false;
            }
            turns_to_the_right_half += usize::from(points_left(into) && !points_left(out));
        }
        turns_to_the_right_half == 1
    }

    /// Cuts ears until three corners are left; false when there was none to cut, and a fan took over.
    fn clip_ears(&mut self, emit: &mut impl FnMut([usize; 3])) -> bool {
        self.link();
        let (mut left, mut corner) = (self.points.len(), 0);
        let (mut misses, mut allow_flat) = (0, false);
        while left > 3 && (misses <= left || !allow_flat) && self.work_left > 0 {
            if misses > left {
                (misses, allow_flat) = (0, true);
            }
            let (before, after) = (self.previous[corner], self.next[corner]);
            if self.is_ear(corner, allow_flat) {
                emit([before, corner, after]);
                self.unlink(corner);
                left -= 1;
                (misses, allow_flat) = (0, false);
                corner = self.next[after];
            } else {
                misses += 1;
                corner = after;
            }
        }
        self.fan_out(corner, left, emit);
        left == 3
    }

    /// The last corners as a fan around `apex`.
    fn fan_out(&self, apex: usize, left: usize, emit: &mut impl FnMut([usize; 3])) {
        let mut corner = self.next[apex];
        for _ in 2..left {
            emit([apex, corner, self.next[corner]]);
            corner = self.next[corner];
        }
    }

    /// Whether the corner and its neighbours span a triangle with no other corner in it.
    fn is_ear(&mut self, corner: usize, allow_flat: bool) -> bool {
        let (before, after) = (self.previous[corner], self.next[corner]);
        let turn = self.turn(before, corner, after);
        if turn <= 0.0 {
            return allow_flat && turn == 0.0;
        }
        let mut other = self.next[after];
        while other != before {
            self.work_left = self.work_left.saturating_sub(1);
            if self.reflex[other] && self.is_inside(other, [before, corner, after]) {
                return false;
            }
            other = self.next[other];
        }
        true
    }

    /// Whether the point is in the triangle or on its border, but is not one of its corners.
    fn is_inside(&self, point: usize, triangle: [usize; 3]) -> bool {
        let [a, b, c] = triangle;
        let is_corner = triangle.iter().any(|&k| self.points[k] == self.points[point]);
        !is_corner
            && self.turn(a, b, point) >= 0.0
            && self.turn(b, c, point) >= 0.0
            && self.turn(c, a, point) >= 0.0
    }

    /// Makes the ring of all corners.
    fn link(&mut self) {
        let count = self.points.len();
        self.next.clear();
        self.next.extend((0..count).map(|corner| (corner + 1) % count));
        self.previous.clear();
        self.previous.extend((0..count).map(|corner| (corner + count - 1) % count));
        self.reflex.clear();
        self.reflex.resize(count, false);
        (0..count).for_each(|corner| self.update_reflex(corner));
    }

    fn unlink(&mut self, corner: usize) {
        let (before, after) = (self.previous[corner], self.next[corner]);
        self.next[before] = after;
        self.previous[after] = before;
        self.update_reflex(before);
        self.update_reflex(after);
    }

    fn update_reflex(&mut self, corner: usize) {
        self.reflex[corner] = self.turn(self.previous[corner], corner, self.next[corner]) <= 0.0;
    }

    fn edge(&self, from: usize, to: usize) -> Coord<f64> {
        let (from, to) = (self.points[from], self.points[to]);
        Coord { x: to.x - from.x, y: to.y - from.y }
    }

    /// Twice the area of a triangle, positive when it turns left; its sign is exact.
    fn turn(&self, a: usize, b: usize, c: usize) -> f64 {
        orient2d(self.points[a], self.points[b], self.points[c])
    }
}

/// Whether a direction is in the half turn from straight left to just before straight right.
fn points_left(direction: Coord<f64>) -> bool {
    direction.y < 0.0 || (direction.y == 0.0 && direction.x < 0.0)
}

/// Twice the area of a polygon as seen along each axis (Newell's method), around its first corner.
fn newell_normal(corners: &[u32], positions: &[[f64; 3]]) -> [f64; 3] {
    let origin = positions[corners[0] as usize];
    let local = |corner: u32| {
        let position = positions[corner as usize];
        [0, 1, 2].map(|axis| position[axis] - origin[axis])
    };
    let mut normal = [0.0; 3];
    for pair in corners.windows(2) {
        let (a, b) = (local(pair[0]), local(pair[1]));
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            normal[axis] += a[u] * b[v] - a[v] * b[u];
        }
    }
    normal
}

#[cfg(test)]
mod tests;
