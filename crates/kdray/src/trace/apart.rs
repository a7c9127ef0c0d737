//! How far the triangles of a block are from a point, at least.
//!
//! A plane with all of a triangle beyond it proves a distance, whatever its normal. So the normal
//! may come from single precision: it points to where the nearest point seems to be, and only the
//! projection of the corners on it, with its roundings, has to be right.

use super::block::{Block, LANES};
use super::prepare::{greater, lesser};

type Lanes = [f32; LANES];
type Vectors = [Lanes; 3];

/// Lower bounds of the squared distances of the triangles from `point`; infinite for free lanes.
#[inline(always)]
pub(super) fn squared_bounds(block: &Block, point: [f32; 3]) -> Lanes {
    let [a, b, c] = block.corners();
    let start = vectors(|axis, lane| a[axis][lane] - point[axis]);
    let ab = vectors(|axis, lane| b[axis][lane] - a[axis][lane]);
    let ac = vectors(|axis, lane| c[axis][lane] - a[axis][lane]);
    let mut bounds = Corners::new(start, ab, ac).squared_bounds();
    for lane in 1..LANES {
        if block.is_free(lane) {
            bounds[lane] = f32::INFINITY;
        }
    }
    bounds
}

/// The corners as seen from the point: `start`, `start + ab` and `start + ac`; and products.
struct Corners {
    start: Vectors,
    ab: Vectors,
    ac: Vectors,
    start_start: Lanes,
    start_ab: Lanes,
    start_ac: Lanes,
    ab_ab: Lanes,
    ab_ac: Lanes,
    ac_ac: Lanes,
}

/// More than the roundings of projections, relative to the product of the lengths: seven half ulps
/// of one are in play.
const ROUNDING: f32 = 10.0 * 0.5 * f32::EPSILON;

/// Below these, products could have lost digits: nothing is known then.
const SMALLEST_PROJECTION: f32 = 1e-18;
const SMALLEST_NORMAL: f32 = 1e-30;

impl Corners {
    #[inline(always)]
    fn new(start: Vectors, ab: Vectors, ac: Vectors) -> Self {
        let [start_start, start_ab, start_ac] =
            [dot(&start, &start), dot(&start, &ab), dot(&start, &ac)];
        let [ab_ab, ab_ac, ac_ac] = [dot(&ab, &ab), dot(&ab, &ac), dot(&ac, &ac)];
        Self { start, ab, ac, start_start, start_ab, start_ac, ab_ab, ab_ac, ac_ac }
    }

    /// The squared distance of the plane through the nearest corner, across the way to where the
    /// nearest point seems to be; zero if other corners are before it.
    #[inline(always)]
    fn squared_bounds(&self) -> Lanes {
        let [u, v] = self.nearest();
        let normal = vectors(|axis, lane| {
            self.start[axis][lane] + (u[lane] * self.ab[axis][lane] + v[lane] * self.ac[axis][lane])
        });
        let [start, ab, ac] =
            [dot(&normal, &self.start), dot(&normal, &self.ab), dot(&normal, &self.ac)];
        let length = dot(&normal, &normal);
        lanes(|lane| {
            let reach = self.start_start[lane] + greater(self.ab_ab[lane], self.ac_ac[lane]);
            let nearest = start[lane] + lesser(lesser(ab[lane], ac[lane]), 0.0);
            let sure = nearest - ROUNDING * (length[lane] * reach).sqrt();
            let bound = sure * (sure / length[lane]) * (1.0 - ROUNDING);
            // Of numbers out of range nothing is known either.
            let is_known = (sure > SMALLEST_PROJECTION)
                & (length[lane] > SMALLEST_NORMAL)
                & (bound < f32::INFINITY);
            if is_known { bound } else { 0.0 }
        })
    }

    /// Weights of `ab` and `ac` at the nearest points, roughly: those of the foot on the plane
    /// where that is inside, else of the nearest point of an edge.
    #[inline(always)]
    fn nearest(&self) -> [Lanes; 2] {
        let (mut u, mut v) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let [ab_ab, ab_ac, ac_ac] = [self.ab_ab[lane], self.ab_ac[lane], self.ac_ac[lane]];
            let [along_ab, along_ac] = [-self.start_ab[lane], -self.start_ac[lane]];
            let on_ab = share(along_ab, ab_ab);
            let on_ac = share(along_ac, ac_ac);
            let on_bc = share(along_ac - along_ab + (ab_ab - ab_ac), ab_ab + ac_ac - 2.0 * ab_ac);
            // Squared distances, less that of the first corner.
            let square = |u: f32, v: f32| {
                u * (u * ab_ab - 2.0 * along_ab)
                    + v * (v * ac_ac - 2.0 * along_ac)
                    + 2.0 * (u * v * ab_ac)
            };
            let (at_ab, at_ac) = (square(on_ab, 0.0), square(0.0, on_ac));
            let at_bc = square(1.0 - on_bc, on_bc);
            let (nearer_u, nearer_v, nearer) =
                if at_ab < at_ac { (on_ab, 0.0, at_ab) } else { (0.0, on_ac, at_ac) };
            let (edge_u, edge_v) =
                if at_bc < nearer { (1.0 - on_bc, on_bc) } else { (nearer_u, nearer_v) };
            let area = ab_ab * ac_ac - ab_ac * ab_ac;
            let foot_u = along_ab * ac_ac - along_ac * ab_ac;
            let foot_v = along_ac * ab_ab - along_ab * ab_ac;
            let inside = (foot_u > 0.0) & (foot_v > 0.0) & (foot_u + foot_v < area);
            u[lane] = if inside { foot_u / area } else { edge_u };
            v[lane] = if inside { foot_v / area } else { edge_v };
        }
        [u, v]
    }
}

/// `part / whole`, but in 0..=1.
#[inline(always)]
fn share(part: f32, whole: f32) -> f32 {
    lesser(greater(part / whole, 0.0), 1.0)
}

#[inline(always)]
fn lanes(value: impl Fn(usize) -> f32) -> Lanes {
    let mut lanes = [0.0; LANES];
    for lane in 0..LANES {
        lanes[lane] = value(lane);
    }
    lanes
}

#[inline(always)]
fn vectors(value: impl Fn(usize, usize) -> f32) -> Vectors {
    let mut vectors = [[0.0; LANES]; 3];
    for axis in 0..3 {
        for lane in 0..LANES {
            vectors[axis][lane] = value(axis, lane);
        }
    }
    vectors
}

#[inline(always)]
fn dot(a: &Vectors, b: &Vectors) -> Lanes {
    lanes(|lane| a[0][lane] * b[0][lane] + a[1][lane] * b[1][lane] + a[2][lane] * b[2][lane])
}
