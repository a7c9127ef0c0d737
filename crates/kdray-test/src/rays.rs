//! Rays that go where ties, roundings and empty sets are.

use std::ops::Range;

use kdray::tree::Kind;
use kdray::{Aabb, Mesh, Ray, Tree};

use crate::Random;

/// Makes rays for one scene: at its vertices, along its edges, in its split planes, past it.
pub struct RayMaker<'a> {
    mesh: &'a Mesh,
    /// The scene's box, grown so that it is never flat.
    around: Aabb,
    planes: Vec<(usize, f32)>,
    random: Random,
}

/// No direction that was not scaled is shorter.
const SHORTEST: f32 = 1e-10;

/// The largest component of the direction.
fn longest(ray: &Ray) -> f32 {
    ray.direction.iter().fold(0.0, |longest, v| v.abs().max(longest))
}

impl<'a> RayMaker<'a> {
    /// Rays for `mesh`, some of them in the planes of `tree`.
    #[must_use]
    pub fn new(mesh: &'a Mesh, tree: &Tree, seed: u64) -> Self {
        let plane = |node: &kdray::Node| match node.kind() {
            Kind::Inner { axis, position, .. } => Some((axis, position)),
            Kind::Leaf { .. } => None,
        };
        let planes = tree.nodes().iter().filter_map(plane).collect();
        let bounds = mesh.bounds();
        let size = bounds.extent().into_iter().fold(0.0, f32::max);
        let margin = if size > 0.0 { 0.25 * size } else { 1.0 };
        let around = Aabb {
            lower: bounds.lower.map(|v| v - margin),
            upper: bounds.upper.map(|v| v + margin),
        };
        Self { mesh, around, planes, random: Random::new(seed) }
    }

    /// The next ray: any origin, any direction, any interval.
    pub fn any(&mut self) -> Ray {
        let mut ray = self.line();
        self.limit(&mut ray);
        if self.random.below(100) == 0 {
            self.spoil(&mut ray);
        }
        ray
    }

    /// A ray whose direction is about ten to one of `exponents` long.
    pub fn scaled(&mut self, exponents: &Range<f64>) -> Ray {
        let mut ray = self.line();
        let longest = longest(&ray);
        let length = 10.0_f64.powf(self.random.between(exponents.start, exponents.end));
        ray.direction = ray.direction.map(|v| (f64::from(v) / f64::from(longest) * length) as f32);
        self.limit(&mut ray);
        ray
    }

    /// A half-line with the distance to its target for direction, through something where possible.
    pub fn line(&mut self) -> Ray {
        let mut origin = self.origin();
        let direction = if self.random.below(3) == 0 {
            self.axis_direction()
        } else {
            let target = self.target();
            [0, 1, 2].map(|axis| target[axis] - origin[axis])
        };
        if self.random.below(4) == 0 && !self.planes.is_empty() {
            let (axis, position) = self.random.pick(&self.planes);
            origin[axis] = position;
        }
        let mut ray = Ray::new(origin, direction);
        if self.random.below(4) == 0 {
            // In a plane across an axis, with a zero of either sign.
            ray.direction[self.random.below(3)] = self.random.pick(&[0.0, -0.0]);
        }
        // Between points that nearly coincide; very short directions have tests of their own.
        if longest(&ray) < SHORTEST {
            ray.direction = self.axis_direction();
        }
        ray
    }

    /// A point on the scene: a vertex, on an edge, inside a triangle; or anywhere.
    pub fn target(&mut self) -> [f32; 3] {
        if self.mesh.triangles().is_empty() || self.random.below(6) == 0 {
            return self.anywhere();
        }
        let triangle = self.random.below(self.mesh.triangles().len());
        let [a, b, c] = self.mesh.triangle(triangle);
        let between = |p: [f32; 3], q: [f32; 3], t: f32| {
            [0, 1, 2].map(|axis| p[axis] + (q[axis] - p[axis]) * t)
        };
        let share = self.random.unit() as f32;
        match self.random.below(4) {
            0 => self.random.pick(&[a, b, c]),
            1 => between(a, b, 0.5),
            2 => between(b, c, share),
            _ => between(a, between(b, c, share), self.random.unit() as f32),
        }
    }

    fn origin(&mut self) -> [f32; 3] {
        match self.random.below(4) {
            0 => self.target(),
            1 => self.anywhere(),
            // Outside, up to far outside.
            choice => {
                let distance = if choice == 2 { 3.0 } else { 1000.0 };
                let (inside, random) = (self.anywhere(), self.random.point());
                let extent = self.around.extent();
                [0, 1, 2].map(|axis| inside[axis] + extent[axis] * (distance * random[axis]) as f32)
            }
        }
    }

    fn anywhere(&mut self) -> [f32; 3] {
        let Aabb { lower, upper } = self.around;
        [0, 1, 2].map(|axis| self.random.between(lower[axis].into(), upper[axis].into()) as f32)
    }

    /// Along an axis, the other components zeros of either sign.
    fn axis_direction(&mut self) -> [f32; 3] {
        let mut direction = [(); 3].map(|()| self.random.pick(&[0.0, -0.0]));
        direction[self.random.below(3)] = self.random.pick(&[1.0, -1.0]);
        direction
    }

    /// Gives some rays an interval, often one that ends at a hit.
    fn limit(&mut self, ray: &mut Ray) {
        let whole = Ray { t_min: f32::NEG_INFINITY, ..*ray };
        if self.random.below(4) != 0 {
            if self.random.below(4) == 0 {
                *ray = whole;
            }
            return;
        }
        let hits: Vec<f32> = crate::oracle::hits(self.mesh, &whole).map(|hit| hit.t).collect();
        if hits.is_empty() {
            return;
        }
        let (low, high) = (self.random.pick(&hits), self.random.pick(&hits));
        match self.random.below(6) {
            0 => ray.t_min = low,
            1 => ray.t_min = low.next_up(),
            2 => ray.t_max = high,
            3 => ray.t_max = high.next_down(),
            4 => (ray.t_min, ray.t_max) = (low.min(high), low.max(high)),
            // Mostly an empty interval.
            _ => (ray.t_min, ray.t_max) = (low, high),
        }
    }

    /// Makes a ray that can hit nothing.
    fn spoil(&mut self, ray: &mut Ray) {
        let axis = self.random.below(3);
        let bad = self.random.pick(&[f32::NAN, f32::INFINITY, f32::NEG_INFINITY]);
        match self.random.below(5) {
            0 => ray.origin[axis] = bad,
            1 => ray.direction[axis] = bad,
            2 => ray.direction = [0.0, -0.0, 0.0],
            3 => ray.t_min = f32::NAN,
            _ => ray.t_max = f32::NAN,
        }
    }
}
