//! Arithmetic on eight or sixteen numbers at once.
//!
//! A vector exists only where the processor has instructions for it: the first comes from a proof of
//! that, all others from vectors. So arithmetic on vectors is safe. A single number is a vector, too.

#[cfg(target_arch = "x86_64")]
mod eight;
#[cfg(target_arch = "x86_64")]
mod four;
#[cfg(target_arch = "aarch64")]
mod neon;
#[cfg(target_arch = "x86_64")]
mod one;
#[cfg(target_arch = "x86_64")]
mod sixteen;
#[cfg(test)]
mod tests;

use std::ops::{Add, Div, Mul, Sub};

#[cfg(target_arch = "x86_64")]
use crate::geometry::Ray;
#[cfg(target_arch = "x86_64")]
pub(in crate::trace) use crate::trace::eights::by_axis;

#[cfg(target_arch = "x86_64")]
pub(in crate::trace) use eight::Eight;
#[cfg(target_arch = "x86_64")]
pub(in crate::trace) use four::Four;
#[cfg(target_arch = "aarch64")]
pub(in crate::trace) use neon::Eight;
#[cfg(target_arch = "x86_64")]
pub(in crate::trace) use sixteen::Sixteen;

/// The most lanes that a vector has.
pub(in crate::trace) const MOST: usize = if cfg!(target_arch = "x86_64") { 16 } else { 8 };

/// A number a lane; those beyond the lanes of a vector are of no consequence.
#[repr(align(64))]
#[derive(Clone, Copy)]
pub(in crate::trace) struct Numbers(pub(in crate::trace) [f32; MOST]);

/// Numbers in single precision. What only packets need is where packets are.
pub(in crate::trace) trait Vector: Arithmetic<Number = f32> {
    #[cfg(any(test, target_arch = "x86_64"))]
    const LANES: usize;
    type Proof: Copy;
    #[cfg(target_arch = "x86_64")]
    type Precise: Precise<Rounded = Self>;

    /// Rays, one a lane, as their eight numbers.
    #[cfg(target_arch = "x86_64")]
    fn of_rays(proof: Self::Proof, rays: &[Ray]) -> [Self; 8];
    fn of_numbers(proof: Self::Proof, numbers: &Numbers) -> Self;
    fn numbers(self) -> Numbers;
    fn magnitude(self) -> Self;
    /// The magnitude of these with the signs of those.
    #[cfg(target_arch = "x86_64")]
    fn with_signs_of(self, signs: Self) -> Self;
    /// The least number; any, if one is NaN.
    #[cfg(target_arch = "x86_64")]
    fn least(self) -> f32;
    /// The greatest number; none is NaN.
    #[cfg(target_arch = "x86_64")]
    fn greatest(self) -> f32;
    /// `self * factor + term`, rounded once.
    fn fused(self, factor: Self, term: Self) -> Self;
    /// By lane, one of these where the mask is set and one of those where not.
    fn pick(mask: Self::Mask, these: Self, those: Self) -> Self;
    #[cfg(target_arch = "x86_64")]
    fn precise(self) -> Self::Precise;
}

/// Numbers in double precision.
#[cfg(target_arch = "x86_64")]
pub(in crate::trace) trait Precise: Arithmetic<Number = f64> {
    type Rounded;
    fn rounded(self) -> Self::Rounded;
}

/// What both have.
pub(in crate::trace) trait Arithmetic:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    type Number;
    type Mask: Mask;
    /// A number in every lane.
    fn all(self, number: Self::Number) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn is_less(self, than: Self) -> Self::Mask;
    fn is_at_most(self, most: Self) -> Self::Mask;
}

/// A truth a lane.
pub(in crate::trace) trait Mask: Copy {
    fn and(self, other: Self) -> Self;
    fn or(self, other: Self) -> Self;
    fn and_not(self, other: Self) -> Self;
    /// A bit a lane, the first lowest.
    fn bits(self) -> u32;
}

/// Operators, by the instruction of each.
macro_rules! operators {
    ($vector:ty, |$a:ident, $b:ident| $($operator:ident $name:ident $value:expr;)*) => {$(
        impl $operator for $vector {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                let ($a, $b) = (self.0, other.0);
                // SAFETY: a vector exists, so the processor has the instruction.
                Self(unsafe { $value })
            }
        }
    )*};
}
use operators;
