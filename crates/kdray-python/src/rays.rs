//! Rays as Python hands them over, and in the core's form.

use std::ops::Range;

use kdray::{Frame, Mesh, Ray};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Rows, Scalars, Values, Vectors};

/// What a query with rays is asked, as a tuple: origins, directions, the least and the largest `t`,
/// by ray a triangle that does not count, by triangle whether it counts at all, and threads.
#[derive(FromPyObject)]
pub(crate) struct Arguments<'py>(
    Vectors<'py>,
    Vectors<'py>,
    Scalars<'py>,
    Scalars<'py>,
    Option<PyReadonlyArray1<'py, i32>>,
    Option<PyReadonlyArray1<'py, bool>>,
    pub(crate) usize,
);

/// [`Arguments`] that fit together.
pub(crate) struct Rays<'a> {
    origins: Rows<'a>,
    directions: Rows<'a>,
    t_min: Values<'a>,
    t_max: Values<'a>,
    exclude: Option<&'a [i32]>,
    pub(crate) mask: Option<&'a [bool]>,
    frame: Frame,
}

impl Arguments<'_> {
    /// The rays, over `mesh`.
    pub(crate) fn over(&self, mesh: &Mesh) -> PyResult<Rays<'_>> {
        let Self(origins, directions, t_min, t_max, exclude, mask, _) = self;
        let rays = Rays {
            origins: origins.rows()?,
            directions: directions.rows()?,
            t_min: t_min.values()?,
            t_max: t_max.values()?,
            exclude: exclude.as_ref().map(|array| array.as_slice()).transpose()?,
            mask: mask.as_ref().map(|array| array.as_slice()).transpose()?,
            frame: mesh.frame(),
        };
        let count = rays.len();
        let fits = rays.directions.len() == count
            && rays.t_min.fits(count)
            && rays.t_max.fits(count)
            && rays.exclude.is_none_or(|exclude| exclude.len() == count);
        if !fits {
            return Err(PyValueError::new_err("arrays of different lengths"));
        }
        let triangles = mesh.triangles().len();
        match rays.mask {
            Some(mask) if mask.len() != triangles => {
                let found = mask.len();
                let message = format!("mask has {found} values for {triangles} triangles");
                Err(PyValueError::new_err(message))
            }
            _ => Ok(rays),
        }
    }
}

impl Rays<'_> {
    pub(crate) fn len(&self) -> usize {
        self.origins.len()
    }

    /// A ray in the core's form.
    #[inline(always)]
    pub(crate) fn get(&self, index: usize) -> Ray {
        let (t_min, t_max) = (self.t_min.get(index), self.t_max.get(index));
        match (&self.origins, &self.directions) {
            (Rows::Packed(origins), Rows::Packed(directions)) if self.frame == Frame::IDENTITY => {
                Ray { origin: origins[index], t_min, direction: directions[index], t_max }
            }
            (origins, directions) => {
                self.frame.local_ray(origins.world(index), directions.world(index), t_min, t_max)
            }
        }
    }

    /// Writes some of the rays to `local`.
    pub(crate) fn copy(&self, range: Range<usize>, local: &mut [Ray]) {
        for (index, local) in range.zip(local) {
            *local = self.get(index);
        }
    }

    /// The triangles that do not count for some of the rays.
    pub(crate) fn except(&self, range: Range<usize>) -> Option<&[u32]> {
        self.exclude.map(|exclude| bytemuck::cast_slice(&exclude[range]))
    }
}

/// The numbers below `count`, at most `size` at a time.
pub(crate) fn blocks(count: usize, size: usize) -> impl Iterator<Item = Range<usize>> {
    (0..count).step_by(size).map(move |start| start..count.min(start + size))
}
