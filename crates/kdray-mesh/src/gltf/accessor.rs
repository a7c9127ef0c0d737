//! Accessors: positions and indices out of buffers, with every offset checked before it is used.

use super::buffers::{Buffers, slice};
use super::schema::{Accessor, Root, Sparse};
use crate::error::{LoadError, Place};

/// A component type of glTF.
#[derive(Clone, Copy, PartialEq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn new(code: u32) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The value in the first bytes of `bytes`, which hold it.
    fn value(self, bytes: &[u8]) -> f64 {
        match self {
            Self::I8 => f64::from(bytes[0] as i8),
            Self::U8 => f64::from(bytes[0]),
            Self::I16 => f64::from(i16::from_le_bytes([bytes[0], bytes[1]])),
            Self::U16 => f64::from(u16::from_le_bytes([bytes[0], bytes[1]])),
            Self::U32 => f64::from(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
            Self::F32 => f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])),
        }
    }

    /// A normalised integer as the number it stands for.
    fn normalise(self, value: f64) -> f64 {
        match self {
            Self::I8 => (value / 127.0).max(-1.0),
            Self::U8 => value / 255.0,
            Self::I16 => (value / 32_767.0).max(-1.0),
            Self::U16 => value / 65_535.0,
            Self::U32 | Self::F32 => value,
        }
    }
}

/// Elements of `N` components, somewhere in a buffer view.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    component: Component,
}

impl<'a> Elements<'a> {
    /// `count` elements from `offset` on, all of which the view must hold.
    fn new<const N: usize>(
        (view, stride): (&'a [u8], Option<u64>),
        offset: u64,
        component: Component,
        count: u64,
    ) -> Option<Self> {
        let size = (N * component.size()) as u64;
        let stride = stride.unwrap_or(size);
        let length = match count {
            0 => 0,
            _ => stride.checked_mul(count - 1)?.checked_add(size)?,
        };
        let bytes = slice(view, offset, length)?;
        let stride = usize::try_from(stride).ok().filter(|&stride| stride as u64 >= size)?;
        Some(Self { bytes, stride, component })
    }

    fn read<const N: usize>(&self) -> impl Iterator<Item = [f64; N]> + '_ {
        let size = self.component.size();
        self.bytes
            .chunks(self.stride)
            .map(move |element| std::array::from_fn(|k| self.component.value(&element[k * size..])))
    }
}

/// Reads accessors of one document.
pub(super) struct Accessors<'a> {
    pub(super) root: &'a Root,
    pub(super) buffers: &'a Buffers<'a>,
}

impl Accessors<'_> {
    /// The positions in an accessor.
    pub(super) fn positions(&self, index: usize) -> Result<Vec<[f64; 3]>, LoadError> {
        self.numbers(index, "VEC3")
    }

    /// The numbers in an accessor of that shape, which has `N` components.
    pub(super) fn numbers<const N: usize>(
        &self,
        index: usize,
        shape: &str,
    ) -> Result<Vec<[f64; N]>, LoadError> {
        let accessor = self.get(index, shape)?;
        let component = component(accessor.component_type, index)?;
        if component == Component::U32 {
            let reason = "numbers like these cannot be 32-bit integers";
            return Err(LoadError::malformed(place(index), reason));
        }
        let mut numbers: Vec<[f64; N]> = self.values(accessor, index, component)?;
        if accessor.normalized {
            for value in numbers.as_flattened_mut() {
                *value = component.normalise(*value);
            }
        }
        Ok(numbers)
    }

    /// The indices in an accessor.
    pub(super) fn indices(&self, index: usize) -> Result<Vec<u32>, LoadError> {
        let accessor = self.get(index, "SCALAR")?;
        let component = component(accessor.component_type, index)?;
        if !matches!(component, Component::U8 | Component::U16 | Component::U32) {
            return Err(LoadError::malformed(place(index), "indices must be unsigned integers"));
        }
        let values: Vec<[f64; 1]> = self.values(accessor, index, component)?;
        Ok(values.into_iter().map(|[value]| value as u32).collect())
    }

    fn get(&self, index: usize, shape: &str) -> Result<&Accessor, LoadError> {
        let Some(accessor) = self.root.accessors.get(index) else {
            return Err(LoadError::malformed(place(index), "there is no such accessor"));
        };
        if accessor.shape != shape {
            let reason = format!("its type is {}, not {shape}", accessor.shape);
            return Err(LoadError::malformed(place(index), reason));
        }
        Ok(accessor)
    }

    fn values<const N: usize>(
        &self,
        accessor: &Accessor,
        index: usize,
        component: Component,
    ) -> Result<Vec<[f64; N]>, LoadError> {
        let count = accessor.count;
        let mut values = match accessor.buffer_view {
            Some(view) => {
                let view = self.buffers.view(view)?;
                let elements = Elements::new::<N>(view, accessor.byte_offset, component, count);
                elements.ok_or_else(|| too_long(index, count))?.read().collect()
            }
            None if self.buffers.spend_zeros(count) => vec![[0.0; N]; count as usize],
            None => {
                let reason = format!("{count} elements are announced, without a buffer view");
                return Err(LoadError::malformed(place(index), reason));
            }
        };
        if let Some(sparse) = &accessor.sparse {
            self.replace(&mut values, sparse, index, component)?;
        }
        Ok(values)
    }

    /// Puts the values of a sparse accessor over the others.
    fn replace<const N: usize>(
        &self,
        values: &mut [[f64; N]],
        sparse: &Sparse,
        index: usize,
        component: Component,
    ) -> Result<(), LoadError> {
        let Sparse { count, indices: at, values: with } = sparse;
        let kind = self::component(at.component_type, index)?;
        let view = self.buffers.view(at.buffer_view)?;
        let targets = Elements::new::<1>(view, at.byte_offset, kind, *count);
        let targets = targets.ok_or_else(|| too_long(index, *count))?;
        let view = self.buffers.view(with.buffer_view)?;
        let replacements = Elements::new::<N>(view, with.byte_offset, component, *count);
        let replacements = replacements.ok_or_else(|| too_long(index, *count))?;
        let all = values.len();
        for ([target], value) in targets.read().zip(replacements.read()) {
            let Some(slot) = values.get_mut(target as usize) else {
                let reason = format!("sparse element {target}, of an accessor of {all}");
                return Err(LoadError::malformed(place(index), reason));
            };
            *slot = value;
        }
        Ok(())
    }
}

fn place(index: usize) -> Place {
    Place::item(format!("accessor {index}"))
}

fn component(code: u32, index: usize) -> Result<Component, LoadError> {
    let reason = || format!("{code} is not a component type");
    Component::new(code).ok_or_else(|| LoadError::malformed(place(index), reason()))
}

fn too_long(index: usize, count: u64) -> LoadError {
    let reason = format!("{count} elements are announced, more than its buffer view holds");
    LoadError::truncated(place(index), reason)
}
