//! A mesh as bytes, so that it can be kept beside its tree.
//!
//! ```text
//! offset  size
//!      0     8  "kdray-ms"
//!      8     4  version, 1
//!     12     4  triangles
//!     16     8  vertices
//!     24    32  frame: origin x y z, scale, f64
//!     56     8  XXH3 of all that comes before and after
//!     64        positions, 12 bytes each, then triangles, 12 bytes each
//! ```
//!
//! Everything is little-endian.

use super::{Frame, Mesh, MeshError};

const MAGIC: &[u8; 8] = b"kdray-ms";
const VERSION: u32 = 1;
const HEADER: usize = 64;
const CHECKSUM: usize = 56;

/// Why bytes are not a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshFileError {
    /// The bytes do not start like a mesh.
    #[error("not a mesh of kdray: it starts with {found:02x?}")]
    Foreign {
        /// The first bytes.
        found: Vec<u8>,
    },
    /// A version that this program does not know.
    #[error("mesh of version {found}; this program reads version {VERSION}")]
    Version {
        /// The version there is.
        found: u32,
    },
    /// The bytes end before the mesh does.
    #[error("the header announces {expected} bytes, but there are {found}")]
    Length {
        /// Bytes by the header.
        expected: u128,
        /// Bytes there are.
        found: usize,
    },
    /// The bytes are not those that were written.
    #[error("the checksum is {found:016x} instead of {expected:016x}: the mesh is damaged")]
    Checksum {
        /// Sum in the header.
        expected: u64,
        /// Sum of the bytes.
        found: u64,
    },
    /// No mesh has such a frame.
    #[error("the frame {frame:?} has no meaning")]
    Frame {
        /// Origin and scale.
        frame: Frame,
    },
    /// Positions and triangles are not a mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl Mesh {
    /// The mesh as bytes: its positions in its own frame, the frame, and its triangles.
    ///
    /// ```
    /// let mesh = kdray::Mesh::new(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])?;
    /// let bytes = mesh.to_bytes();
    /// let (again, length) = kdray::Mesh::from_bytes(&bytes)?;
    /// assert_eq!((again.fingerprint(), length), (mesh.fingerprint(), bytes.len()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let (positions, triangles) = (self.positions(), self.triangles());
        let mut bytes =
            Vec::with_capacity(HEADER + size_of_val(positions) + size_of_val(triangles));
        bytes.extend_from_slice(MAGIC);
        bytes.extend_from_slice(&VERSION.to_le_bytes());
        bytes.extend_from_slice(&(triangles.len() as u32).to_le_bytes());
        bytes.extend_from_slice(&(positions.len() as u64).to_le_bytes());
        let Frame { origin, scale } = self.frame();
        for value in origin.iter().chain([&scale]) {
            bytes.extend_from_slice(&value.to_le_bytes());
        }
        bytes.extend_from_slice(&[0; HEADER - CHECKSUM]);
        bytes.extend(positions.as_flattened().iter().flat_map(|value| value.to_le_bytes()));
        bytes.extend(triangles.as_flattened().iter().flat_map(|index| index.to_le_bytes()));
        let sum = checksum(&bytes);
        bytes[CHECKSUM..HEADER].copy_from_slice(&sum.to_le_bytes());
        bytes
    }

    /// The mesh that `bytes` start with, and how many of them it takes: more may follow.
    ///
    /// # Errors
    ///
    /// [`MeshFileError`], whatever the bytes are.
    pub fn from_bytes(bytes: &[u8]) -> Result<(Self, usize), MeshFileError> {
        let (bytes, vertices) = checked(bytes)?;
        let f64_at = |offset| f64::from_le_bytes(array(bytes, offset));
        let frame = Frame { origin: [24, 32, 40].map(f64_at), scale: f64_at(48) };
        if !is_sound(&frame) {
            return Err(MeshFileError::Frame { frame });
        }
        let (positions, triangles) = bytes[HEADER..].split_at(12 * vertices);
        let positions = rows(positions, |word| f32::from_le_bytes(word) + 0.0);
        let triangles = rows(triangles, u32::from_le_bytes);
        Ok((Self::from_local(positions, triangles, frame)?, bytes.len()))
    }
}

/// The bytes of the mesh alone, which have the right length and sum, and the number of vertices.
fn checked(bytes: &[u8]) -> Result<(&[u8], usize), MeshFileError> {
    if !bytes.starts_with(MAGIC) {
        return Err(MeshFileError::Foreign { found: bytes[..bytes.len().min(8)].to_vec() });
    }
    if bytes.len() < HEADER {
        return Err(MeshFileError::Length { expected: HEADER as u128, found: bytes.len() });
    }
    let version = u32::from_le_bytes(array(bytes, 8));
    if version != VERSION {
        return Err(MeshFileError::Version { found: version });
    }
    let triangles = u32::from_le_bytes(array(bytes, 12));
    let vertices = u64::from_le_bytes(array(bytes, 16));
    let expected = HEADER as u128 + 12 * (u128::from(vertices) + u128::from(triangles));
    if expected > bytes.len() as u128 {
        return Err(MeshFileError::Length { expected, found: bytes.len() });
    }
    // Both are less than the length of a slice.
    let bytes = &bytes[..expected as usize];
    let (expected, found) = (u64::from_le_bytes(array(bytes, CHECKSUM)), checksum(bytes));
    if expected != found {
        return Err(MeshFileError::Checksum { expected, found });
    }
    Ok((bytes, vertices as usize))
}

/// Whether a mesh can have this frame: its scale is a power of two.
fn is_sound(frame: &Frame) -> bool {
    let is_power_of_two =
        frame.scale.is_normal() && frame.scale > 0.0 && frame.scale.to_bits() << 12 == 0;
    is_power_of_two && frame.origin.iter().all(|value| value.is_finite())
}

fn rows<T>(bytes: &[u8], value: impl Fn([u8; 4]) -> T) -> Vec<[T; 3]> {
    bytes.chunks_exact(12).map(|row| [0, 4, 8].map(|offset| value(array(row, offset)))).collect()
}

fn array<const N: usize>(bytes: &[u8], offset: usize) -> [u8; N] {
    let mut array = [0; N];
    array.copy_from_slice(&bytes[offset..offset + N]);
    array
}

/// The sum of everything but the sum.
fn checksum(bytes: &[u8]) -> u64 {
    let mut hash = xxhash_rust::xxh3::Xxh3::new();
    hash.update(&bytes[..CHECKSUM]);
    hash.update(&bytes[HEADER..]);
    hash.digest()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh() -> Mesh {
        let far = 4_512_345.678;
        let positions = [[far, 0.0, -0.0], [far + 1.0, 0.0, 3.0], [far, 1.0, 1e-3], [far; 3]];
        Mesh::from_f64(&positions, &[[0, 1, 2], [2, 1, 3]]).unwrap()
    }

    #[test]
    fn a_mesh_comes_back_bit_for_bit_and_leaves_what_follows() {
        let mesh = mesh();
        let mut bytes = mesh.to_bytes();
        let length = bytes.len();
        bytes.extend_from_slice(b"more");
        let (again, taken) = Mesh::from_bytes(&bytes).unwrap();
        assert_eq!(taken, length);
        assert_eq!((again.frame(), again.bounds()), (mesh.frame(), mesh.bounds()));
        assert_eq!((again.positions(), again.triangles()), (mesh.positions(), mesh.triangles()));
    }

    #[test]
    fn every_truncation_and_every_flipped_byte_is_found() {
        let bytes = mesh().to_bytes();
        for length in 0..bytes.len() {
            assert!(Mesh::from_bytes(&bytes[..length]).is_err(), "{length}");
        }
        for place in 0..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 0x40;
            assert!(Mesh::from_bytes(&damaged).is_err(), "{place}");
        }
    }

    /// Well-summed bytes in which `change` was made.
    fn changed(change: impl Fn(&mut [u8])) -> Result<(Mesh, usize), MeshFileError> {
        let mut bytes = mesh().to_bytes();
        change(&mut bytes);
        let sum = checksum(&bytes);
        bytes[CHECKSUM..HEADER].copy_from_slice(&sum.to_le_bytes());
        Mesh::from_bytes(&bytes)
    }

    #[test]
    fn well_summed_nonsense_is_refused() {
        let nan = |bytes: &mut [u8]| bytes[64..68].copy_from_slice(&f32::NAN.to_le_bytes());
        assert!(matches!(changed(nan), Err(MeshFileError::Mesh(MeshError::NonFinite { .. }))));
        let index = |bytes: &mut [u8]| bytes[64 + 48] = 9;
        assert!(matches!(
            changed(index),
            Err(MeshFileError::Mesh(MeshError::IndexOutOfRange { index: 9, .. }))
        ));
        for scale in [0.0, -1.0, 3.0, f64::NAN, f64::INFINITY] {
            let frame = |bytes: &mut [u8]| bytes[48..56].copy_from_slice(&scale.to_le_bytes());
            assert!(matches!(changed(frame), Err(MeshFileError::Frame { .. })), "{scale}");
        }
        let endless = |bytes: &mut [u8]| bytes[16..24].fill(0xff);
        assert!(matches!(changed(endless), Err(MeshFileError::Length { .. })));
    }
}
