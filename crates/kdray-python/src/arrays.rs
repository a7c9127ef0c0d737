//! Arrays of numpy, used where they are.

use kdray::{Frame, Mesh};
use numpy::ndarray::ArrayView2;
use numpy::{Element, PyReadonlyArray1, PyReadonlyArray2, PyReadonlyArrayDyn};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

use crate::error;

/// Rows of three numbers: what Python hands over.
#[derive(FromPyObject)]
pub(crate) enum Vectors<'py> {
    Single(PyReadonlyArray2<'py, f32>),
    Double(PyReadonlyArray2<'py, f64>),
}

/// One number for all, or one for each: what Python hands over.
#[derive(FromPyObject)]
pub(crate) enum Scalars<'py> {
    One(f32),
    Each(PyReadonlyArray1<'py, f32>),
}

/// Points or directions of the world. The rows may lie anywhere, and apart.
pub(crate) enum Rows<'a> {
    /// One after the other.
    Packed(&'a [[f32; 3]]),
    Single(ArrayView2<'a, f32>),
    Double(ArrayView2<'a, f64>),
}

/// The vertices of a mesh to be.
pub(crate) enum Vertices<'a> {
    Single(&'a [[f32; 3]]),
    Double(&'a [[f64; 3]]),
}

/// One number for all, or one for each.
#[derive(Clone, Copy)]
pub(crate) enum Values<'a> {
    One(f32),
    Each(&'a [f32]),
}

impl Vectors<'_> {
    pub(crate) fn rows(&self) -> PyResult<Rows<'_>> {
        let (rows, columns) = match self {
            Self::Single(array) => match threes(array) {
                Ok(rows) => (Rows::Packed(rows), 3),
                Err(_) => (Rows::Single(array.as_array()), array.as_array().ncols()),
            },
            Self::Double(array) => (Rows::Double(array.as_array()), array.as_array().ncols()),
        };
        if columns == 3 { Ok(rows) } else { Err(not_three()) }
    }

    /// Vertices, which are contiguous.
    pub(crate) fn vertices(&self) -> PyResult<Vertices<'_>> {
        Ok(match self {
            Self::Single(array) => Vertices::Single(threes(array)?),
            Self::Double(array) => Vertices::Double(threes(array)?),
        })
    }
}

impl Vertices<'_> {
    pub(crate) fn mesh(&self, faces: &[[u32; 3]]) -> PyResult<Mesh> {
        let mesh = match self {
            Self::Single(vertices) => Mesh::new(vertices, faces),
            Self::Double(vertices) => Mesh::from_f64(vertices, faces),
        };
        mesh.map_err(|error| error::mesh(&error))
    }
}

impl Scalars<'_> {
    pub(crate) fn values(&self) -> PyResult<Values<'_>> {
        Ok(match self {
            Self::One(value) => Values::One(*value),
            Self::Each(array) => Values::Each(array.as_slice()?),
        })
    }
}

/// The rows of a contiguous array with three columns.
pub(crate) fn threes<'a, T: Element>(array: &'a PyReadonlyArray2<'_, T>) -> PyResult<&'a [[T; 3]]> {
    let view = array.as_array();
    // numpy's own word for contiguous includes columns one after the other.
    match view.to_slice().map(<[T]>::as_chunks) {
        Some((rows, [])) if rows.len() == view.nrows() => Ok(rows),
        _ => Err(error::value("an array without three columns, or whose rows lie apart")),
    }
}

fn not_three() -> PyErr {
    error::value("an array without three columns")
}

impl Rows<'_> {
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Packed(rows) => rows.len(),
            Self::Single(rows) => rows.nrows(),
            Self::Double(rows) => rows.nrows(),
        }
    }

    #[inline]
    pub(crate) fn world(&self, index: usize) -> [f64; 3] {
        match self {
            Self::Packed(rows) => rows[index].map(f64::from),
            Self::Single(rows) => row(rows, index).map(f64::from),
            Self::Double(rows) => row(rows, index),
        }
    }

    /// A point of the world in the coordinates of `frame`.
    #[inline]
    pub(crate) fn local(&self, index: usize, frame: &Frame) -> [f32; 3] {
        match self {
            Self::Packed(rows) if *frame == Frame::IDENTITY => rows[index],
            _ => frame.local_point(self.world(index)),
        }
    }
}

#[inline]
fn row<T: Copy>(rows: &ArrayView2<'_, T>, index: usize) -> [T; 3] {
    [0, 1, 2].map(|column| rows[[index, column]])
}

impl Values<'_> {
    #[inline]
    pub(crate) fn get(&self, index: usize) -> f32 {
        match self {
            Self::One(value) => *value,
            Self::Each(values) => values[index],
        }
    }

    /// Whether there is a value for each of `count`.
    pub(crate) fn fits(&self, count: usize) -> bool {
        match self {
            Self::One(_) => true,
            Self::Each(values) => values.len() == count,
        }
    }
}

/// `count` zeros, or a MemoryError.
pub(crate) fn zeros<T: bytemuck::Zeroable>(count: usize) -> PyResult<Vec<T>> {
    bytemuck::allocation::try_zeroed_vec(count).map_err(|()| {
        let bytes = count.saturating_mul(size_of::<T>());
        PyMemoryError::new_err(format!("no memory for {bytes} bytes of answers"))
    })
}

/// An array of any shape as a flat slice.
pub(crate) fn flat<'a, T: Element>(array: &'a PyReadonlyArrayDyn<'_, T>) -> PyResult<&'a [T]> {
    Ok(array.as_slice()?)
}
