//! Exact floats: f32 arithmetic with the bits of the processor, on any device.
//!
//! WGSL lets a driver reassociate, fuse, approximate and flush. Kernels that decide something
//! therefore hold floats as their bits and go through `f_add`, `f_sub`, `f_mul` and `f_div` of the
//! part `float`, which has several forms. The few that need more go through the part `double`.

pub mod double;
pub mod probe;
pub mod soft;

use crate::device::Device;
use crate::error::GpuError;

/// The form of the arithmetic in kernels that import `float`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Floats {
    /// The device's own, behind a barrier that the driver cannot see through.
    Hardware,
    /// The same, with quotients in integers.
    SoftDivision,
    /// Integers only.
    Soft,
}

impl Floats {
    /// The parts that `//#import float` stands for.
    #[must_use]
    pub fn parts(self) -> [&'static str; 3] {
        match self {
            Self::Hardware => ["float_pack", "float_hardware", "float_hardware_div"],
            Self::SoftDivision => ["float_pack", "float_hardware", "float_soft_div"],
            Self::Soft => ["float_pack", "float_soft", "float_soft_div"],
        }
    }
}

impl Device {
    /// The fastest form that gives the processor's bits on this device. The first call tries them on
    /// some hundred thousand hard cases.
    ///
    /// # Errors
    ///
    /// If the device fails, or not even its integers are right.
    pub fn floats(&self) -> Result<Floats, GpuError> {
        if let Some(floats) = self.floats.get() {
            return Ok(*floats);
        }
        let floats = probe::choose(self)?;
        Ok(*self.floats.get_or_init(|| floats))
    }

    /// Takes `floats` instead of trying, if that has not been done yet; gives what is taken.
    pub fn assume_floats(&self, floats: Floats) -> Floats {
        *self.floats.get_or_init(|| floats)
    }
}
