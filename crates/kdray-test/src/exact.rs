//! One ray and one triangle, in rational numbers.

use kdray::Ray;
use num_rational::BigRational;
use num_traits::{Signed, ToPrimitive, Zero};

/// How the line of a ray meets the plane of a triangle; rounded only when it is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Meeting {
    /// Where on the ray, in units of its direction.
    pub t: BigRational,
    /// Weights of the three corners: all positive inside, one of them zero on an edge. Their sum
    /// is one.
    pub weights: [BigRational; 3],
}

type Vector = [BigRational; 3];

/// Where the line of `ray` meets the plane of the triangle; `None` if they are parallel.
///
/// Nothing is shared with the tests of the tracer, which shear in single precision: this solves
/// the linear system with exact cross products.
///
/// # Panics
///
/// If a coordinate is not finite.
#[must_use]
pub fn meeting(ray: &Ray, corners: &[[f32; 3]; 3]) -> Option<Meeting> {
    let origin = exact(ray.origin);
    let direction = exact(ray.direction);
    let [a, b, c] = corners.map(|corner| minus(&exact(corner), &origin));
    // The weight of a corner is the volume that the ray spans with the edge across from it.
    let volumes = [
        dot(&direction, &cross(&b, &c)),
        dot(&direction, &cross(&c, &a)),
        dot(&direction, &cross(&a, &b)),
    ];
    let sum: BigRational = volumes.iter().sum();
    if sum.is_zero() {
        return None;
    }
    let t = dot(&a, &cross(&b, &c)) / &sum;
    Some(Meeting { t, weights: volumes.map(|volume| volume / &sum) })
}

impl Meeting {
    /// Whether the line passes strictly inside.
    #[must_use]
    pub fn is_inside(&self) -> bool {
        self.weights.iter().all(Signed::is_positive)
    }

    /// Whether the line passes strictly outside.
    #[must_use]
    pub fn is_outside(&self) -> bool {
        self.weights.iter().any(Signed::is_negative)
    }

    /// The smallest weight, rounded: how clear the answer is.
    ///
    /// # Panics
    ///
    /// Never: a ratio of big integers has a nearest f64, or an infinity.
    #[must_use]
    pub fn clearance(&self) -> f64 {
        self.weights.iter().map(rounded).fold(f64::INFINITY, f64::min)
    }
}

/// The nearest f64.
///
/// # Panics
///
/// Never: a ratio of big integers has a nearest f64, or an infinity.
#[must_use]
pub fn rounded(value: &BigRational) -> f64 {
    value.to_f64().expect("ratios of big integers have a nearest f64")
}

fn exact(vector: [f32; 3]) -> Vector {
    vector.map(|value| BigRational::from_float(value).expect("coordinates are finite"))
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    [0, 1, 2].map(|axis| &a[axis] - &b[axis])
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    let component = |i: usize, j: usize| &a[i] * &b[j] - &a[j] * &b[i];
    [component(1, 2), component(2, 0), component(0, 1)]
}

fn dot(a: &Vector, b: &Vector) -> BigRational {
    (0..3).map(|axis| &a[axis] * &b[axis]).sum()
}
