//! Clusters of triangles, and what they look like from afar.
//!
//! From a point `q`, a piece of surface at `y` with the normal `n` has the solid angle
//! `n · K(y) dA` with `K(y) = (y - q) / |y - q|³`. Around the centre `c` of a cluster, `K` is
//! expanded to first order \[BDS+18]: what is left to know of the cluster are the sum of its
//! `n dA` and that of its `n (y - c) dA`. The rest of the expansion is at most half the largest
//! second derivative of `K` times the sum of `|y - c|² dA`; and because `K` is the gradient of a
//! harmonic function, that derivative is at most `6 / d⁴` at the distance `d`.

use std::f64::consts::PI;
use std::ops::Range;

use rayon::prelude::*;

use super::angle::{Fan, LANES};
use crate::geometry::Mesh;
use crate::geometry::vector::{Vector, cross, dot, minus};

type Triangle = [Vector; 3];

/// Up to eight clusters. The numbers are by child.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug)]
pub(super) struct Cluster {
    center: [[f64; 8]; 3],
    /// The sum of `n dA`.
    area: [[f64; 8]; 3],
    /// The symmetric part of the sum of `n (y - c) dA`: xx, yy, zz, yz, zx, xy, the last three
    /// twice. The rest has no effect.
    moment: [[f64; 8]; 6],
    /// How far the triangles reach from the centre.
    reach: [f64; 8],
    /// The sum of `|y - c|² dA`.
    spread: [f64; 8],
    children: [u32; 8],
}

/// What a cluster is opened into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Child {
    Nothing,
    Fan(usize),
    Cluster(u32),
}

const FAN: u32 = 1 << 31;
const NOTHING: u32 = u32::MAX;

impl Cluster {
    const EMPTY: Self = Self {
        center: [[0.0; 8]; 3],
        area: [[0.0; 8]; 3],
        moment: [[0.0; 8]; 6],
        reach: [f64::INFINITY; 8],
        spread: [0.0; 8],
        children: [NOTHING; 8],
    };

    #[inline(always)]
    pub(super) fn child(&self, place: usize) -> Child {
        match self.children[place] {
            NOTHING => Child::Nothing,
            fan if fan & FAN != 0 => Child::Fan((fan & !FAN) as usize),
            cluster => Child::Cluster(cluster),
        }
    }

    /// The children's winding numbers around `point`, and how wrong they may be: infinitely where
    /// the point is too near, or there is no child.
    #[inline(always)]
    pub(super) fn seen_from(&self, point: Vector) -> ([f64; 8], [f64; 8]) {
        let (mut numbers, mut errors) = ([0.0; 8], [0.0; 8]);
        for child in 0..8 {
            let x = self.center[0][child] - point[0];
            let y = self.center[1][child] - point[1];
            let z = self.center[2][child] - point[2];
            let squared = x * x + y * y + z * z;
            let distance = squared.sqrt();
            let flux = self.area[0][child] * x + self.area[1][child] * y + self.area[2][child] * z;
            let [xx, yy, zz] =
                [self.moment[0][child], self.moment[1][child], self.moment[2][child]];
            let [yz, zx, xy] =
                [self.moment[3][child], self.moment[4][child], self.moment[5][child]];
            let along = x * (xx * x + xy * y) + y * (yy * y + yz * z) + z * (zz * z + zx * x);
            let first = flux + (xx + yy + zz - 3.0 * along / squared);
            numbers[child] = first / (4.0 * PI * squared * distance);
            let gap = distance - self.reach[child];
            let error = 3.0 * self.spread[child] / (4.0 * PI * (gap * gap) * (gap * gap));
            errors[child] = if gap > 0.0 { error } else { f64::INFINITY };
        }
        (numbers, errors)
    }

    fn set(&mut self, place: usize, triangles: &[Triangle], child: u32) {
        let center = center(triangles);
        for axis in 0..3 {
            self.center[axis][place] = center[axis];
        }
        (self.reach[place], self.children[place]) = (0.0, child);
        for triangle in triangles {
            self.include(place, &triangle.map(|corner| minus(corner, center)));
        }
    }

    /// Adds a triangle, given from the centre.
    fn include(&mut self, place: usize, [a, b, c]: &Triangle) {
        let area = cross(minus(*b, *a), minus(*c, *a)).map(|twice| 0.5 * twice);
        let sum = [0, 1, 2].map(|axis| a[axis] + b[axis] + c[axis]);
        for axis in 0..3 {
            let (y, z) = ((axis + 1) % 3, (axis + 2) % 3);
            self.area[axis][place] += area[axis];
            self.moment[axis][place] += area[axis] * sum[axis] / 3.0;
            self.moment[3 + axis][place] += (area[y] * sum[z] + area[z] * sum[y]) / 3.0;
        }
        let squares = dot(*a, *a) + dot(*b, *b) + dot(*c, *c);
        // The mean of |y|² over a triangle.
        let mean = (squares + dot(sum, sum)) / 12.0;
        self.spread[place] += mean * dot(area, area).sqrt();
        let farthest = dot(*a, *a).max(dot(*b, *b)).max(dot(*c, *c)).sqrt();
        self.reach[place] = self.reach[place].max(farthest);
    }
}

/// The centroid of the triangles, around which their spread is least.
fn center(triangles: &[Triangle]) -> Vector {
    let (mut weighted, mut total) = ([0.0; 3], 0.0);
    let (mut plain, count) = ([0.0; 3], 3.0 * triangles.len() as f64);
    for [a, b, c] in triangles {
        let normal = cross(minus(*b, *a), minus(*c, *a));
        let weight = dot(normal, normal).sqrt();
        total += 3.0 * weight;
        for axis in 0..3 {
            let sum = a[axis] + b[axis] + c[axis];
            weighted[axis] += weight * sum;
            plain[axis] += sum;
        }
    }
    if total > 0.0 { weighted.map(|sum| sum / total) } else { plain.map(|sum| sum / count) }
}

/// A triangle to be arranged, by its middle.
#[derive(Clone, Copy)]
struct Place {
    middle: [f32; 3],
    triangle: u32,
}

/// Clusters of all triangles, the first of which holds them all, and the fans within them.
pub(super) fn arrange(mesh: &Mesh) -> (Vec<Cluster>, Vec<Fan>) {
    let place = |triangle: usize| {
        let [a, b, c] = mesh.triangle(triangle);
        let middle = [0, 1, 2].map(|axis| (a[axis] + b[axis] + c[axis]) / 3.0);
        Place { middle, triangle: triangle as u32 }
    };
    let mut places: Vec<Place> = (0..mesh.triangles().len()).map(place).collect();
    let mut arrangement = Arrangement { mesh, clusters: Vec::new(), fans: Vec::new() };
    if !places.is_empty() {
        arrangement.cluster(&mut places, 0);
    }
    let Arrangement { clusters: children, fans, .. } = arrangement;
    let mut clusters = vec![Cluster::EMPTY; children.len()];
    clusters.par_iter_mut().zip(children).for_each(|(cluster, children)| {
        for (place, (range, child)) in children.into_iter().enumerate() {
            let corners = |place: &Place| mesh.triangle(place.triangle as usize);
            let precise = |place: &Place| corners(place).map(|corner| corner.map(f64::from));
            let triangles: Vec<Triangle> = places[range].iter().map(precise).collect();
            cluster.set(place, &triangles, child);
        }
    });
    (clusters, fans)
}

/// Who is in which cluster.
struct Arrangement<'a> {
    mesh: &'a Mesh,
    /// By cluster, the children: where their triangles are, and what they are.
    clusters: Vec<Vec<(Range<usize>, u32)>>,
    fans: Vec<Fan>,
}

impl Arrangement<'_> {
    /// Arranges the triangles of a cluster; `start` is where they begin among all.
    fn cluster(&mut self, places: &mut [Place], start: usize) -> u32 {
        let index = self.clusters.len();
        self.clusters.push(Vec::new());
        let mut children = Vec::with_capacity(8);
        for range in in_eight(places) {
            let among_all = start + range.start..start + range.end;
            let child = if range.len() <= LANES {
                let corners = |place: &Place| self.mesh.triangle(place.triangle as usize);
                self.fans.push(Fan::new(places[range].iter().map(corners)));
                FAN | (self.fans.len() - 1) as u32
            } else {
                self.cluster(&mut places[range], among_all.start)
            };
            children.push((among_all, child));
        }
        self.clusters[index] = children;
        index as u32
    }
}

/// Halves the largest part again and again, until there are eight or each is a fan.
fn in_eight(places: &mut [Place]) -> Vec<Range<usize>> {
    let whole = 0..places.len();
    let mut ranges = vec![whole];
    while ranges.len() < 8 {
        let largest = (0..ranges.len()).max_by_key(|index| ranges[*index].len()).unwrap_or(0);
        let Range { start, end } = ranges[largest];
        if end - start <= LANES {
            break;
        }
        let middle = halve(&mut places[start..end]);
        ranges.splice(largest..=largest, [start..start + middle, start + middle..end]);
    }
    ranges
}

/// Orders the places so that those before the number that is returned lie before the others along
/// the axis on which they differ most. That many triangles fill their fans.
fn halve(places: &mut [Place]) -> usize {
    let extent = |axis: usize| {
        let along = || places.iter().map(|place| place.middle[axis]);
        along().fold(f32::NEG_INFINITY, f32::max) - along().fold(f32::INFINITY, f32::min)
    };
    let extents = [extent(0), extent(1), extent(2)];
    let axis = (0..3).max_by(|a, b| extents[*a].total_cmp(&extents[*b])).unwrap_or(0);
    let middle = (places.len() / 2).div_ceil(LANES) * LANES;
    let key = |place: &Place| place.middle[axis];
    let order = |a: &Place, b: &Place| key(a).total_cmp(&key(b)).then(a.triangle.cmp(&b.triangle));
    places.select_nth_unstable_by(middle, order);
    middle
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every triangle is in one fan, and every cluster's number is within its error of the sum.
    #[test]
    fn clusters_look_from_afar_as_their_triangles_do() {
        let point = |index: u32| {
            let (sin, cos) = (0.7 * index as f32).sin_cos();
            [cos, 0.01 * index as f32, sin + 0.3 * cos * cos]
        };
        let positions: Vec<_> = (0..600).map(point).collect();
        let triangles: Vec<_> = (0..598).map(|index| [index, index + 1, index + 2]).collect();
        let mesh = Mesh::new(&positions, &triangles).expect("sound");
        let (clusters, fans) = arrange(&mesh);
        assert_eq!(fans.len(), 598_usize.div_ceil(LANES));
        let mut known = 0;
        for cluster in &clusters {
            for (index, from) in positions.iter().enumerate() {
                let from = from.map(|value| 2.0 * f64::from(value));
                let (numbers, errors) = cluster.seen_from(from);
                for place in 0..8 {
                    let Child::Fan(fan) = cluster.child(place) else { continue };
                    let mut exact = super::super::angle::Turns::default();
                    exact.add(&fans[fan], from);
                    let off = (exact.number() - numbers[place]).abs();
                    assert!(off <= errors[place] + 1e-14, "{index}: {off} {}", errors[place]);
                    known += usize::from(errors[place] < 1e-3);
                }
            }
        }
        assert!(known > 10_000, "only {known} were far");
    }
}
