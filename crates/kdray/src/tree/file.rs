//! The tree file: one buffer, versioned, checksummed, memory-mappable.
//!
//! ```text
//! offset  size
//!      0     8  "kdray-kd"
//!      8     4  version, 1
//!     12     4  triangles
//!     16     8  nodes
//!     24     8  references
//!     32    24  bounds: lower x y z, upper x y z, f32
//!     56    32  frame: origin x y z, scale, f64
//!     88    12  traversal cost, intersection cost, empty bonus, f32
//!    100     4  0
//!    104     8  fingerprint of the mesh
//!    112     8  0
//!    120     8  XXH3 of all that comes before and after
//!    128        nodes, 8 bytes each, then references, 4 bytes each
//! ```
//!
//! Everything is little-endian. Nodes and references are the very bytes of memory, so a mapped
//! file is a tree once its checksum and its structure have been checked.

use std::sync::Arc;

use super::check::{self, Fault};
use super::{Header, Node, Storage, Tree};
use crate::build::Cost;
use crate::geometry::{Aabb, Frame};

const MAGIC: &[u8; 8] = b"kdray-kd";
const VERSION: u32 = 1;
const HEADER: usize = 128;
const CHECKSUM: usize = 120;

/// Why bytes are not a tree.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FileError {
    /// The bytes do not start like a tree file.
    #[error("not a kdray tree file: it starts with {found:02x?}")]
    Foreign {
        /// The first bytes.
        found: Vec<u8>,
    },
    /// A version that this program does not know.
    #[error("tree file of version {found}; this program reads version {VERSION}")]
    Version {
        /// The file's version.
        found: u32,
    },
    /// The file is shorter or longer than its header says.
    #[error("the header announces {expected} bytes, but the file has {found}")]
    Length {
        /// Bytes by the header.
        expected: u128,
        /// Bytes there are.
        found: usize,
    },
    /// The bytes are not those that were written.
    #[error("the checksum is {found:016x} instead of {expected:016x}: the file is damaged")]
    Checksum {
        /// Sum in the file.
        expected: u64,
        /// Sum of the bytes.
        found: u64,
    },
    /// A number in the header has no meaning.
    #[error("the header at byte {offset} has a {what} without meaning")]
    Header {
        /// Where it stands.
        offset: usize,
        /// What it is.
        what: &'static str,
    },
    /// Nodes and references are not a tree.
    #[error("the nodes are no tree: {0}")]
    Structure(#[from] Fault),
    /// Only little-endian machines can use the bytes as they are.
    #[error("tree files can only be read on little-endian machines")]
    BigEndian,
}

/// Nodes and references of a file.
pub(super) fn body(bytes: &[u8]) -> &[u8] {
    &bytes[HEADER..]
}

impl Tree {
    /// The tree file. Equal trees are equal files.
    ///
    /// ```
    /// use kdray::{BuildOptions, Mesh, Tree};
    ///
    /// let mesh = Mesh::new(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], &[[0, 1, 2]])?;
    /// let tree = Tree::build(&mesh, &BuildOptions::default())?;
    /// assert_eq!(Tree::from_bytes(&tree.to_bytes())?, tree);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[must_use]
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(HEADER + self.size_bytes());
        bytes.extend_from_slice(&self.header_bytes());
        for word in bytemuck::cast_slice::<Node, u32>(self.nodes()).iter().chain(self.references())
        {
            bytes.extend_from_slice(&word.to_le_bytes());
        }
        let sum = checksum(&bytes);
        bytes[CHECKSUM..HEADER].copy_from_slice(&sum.to_le_bytes());
        bytes
    }

    fn header_bytes(&self) -> [u8; HEADER] {
        let Header { bounds, frame, cost, triangles, mesh } = self.header;
        let mut header = [0; HEADER];
        let mut put = |offset: usize, value: &[u8]| {
            header[offset..offset + value.len()].copy_from_slice(value);
        };
        put(0, MAGIC);
        put(8, &VERSION.to_le_bytes());
        put(12, &triangles.to_le_bytes());
        put(16, &(self.nodes().len() as u64).to_le_bytes());
        put(24, &(self.references().len() as u64).to_le_bytes());
        for (index, value) in bounds.lower.iter().chain(&bounds.upper).enumerate() {
            put(32 + 4 * index, &value.to_le_bytes());
        }
        for (index, value) in frame.origin.iter().chain([&frame.scale]).enumerate() {
            put(56 + 8 * index, &value.to_le_bytes());
        }
        for (index, value) in [cost.traversal, cost.intersect, cost.empty_bonus].iter().enumerate()
        {
            put(88 + 4 * index, &value.to_le_bytes());
        }
        put(104, &mesh.to_le_bytes());
        header
    }

    /// The tree of a file's bytes, copied out of them.
    ///
    /// # Errors
    ///
    /// [`FileError`], whatever the bytes are: foreign, of another version, truncated, damaged, or
    /// well-summed nodes that are no tree.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FileError> {
        let (header, counts) = checked(bytes)?;
        let (nodes, references) = body(bytes).split_at(counts.nodes * size_of::<Node>());
        let nodes: Vec<Node> = bytemuck::allocation::pod_collect_to_vec(nodes);
        let references: Vec<u32> = bytemuck::allocation::pod_collect_to_vec(references);
        check::walk(&nodes, &references, header.bounds, header.triangles as usize, |_, _, _| ())?;
        Ok(Self { header, storage: Storage::Owned { nodes, references }, parts: None })
    }

    /// The tree of a file's bytes, used where they are: hand it a memory map.
    ///
    /// The bytes must not change while the tree lives. Bytes that are not aligned to four are
    /// copied.
    ///
    /// # Errors
    ///
    /// As [`Tree::from_bytes`].
    pub fn from_shared(shared: Arc<dyn AsRef<[u8]> + Send + Sync>) -> Result<Self, FileError> {
        let bytes = (*shared).as_ref();
        if !(bytes.as_ptr() as usize).is_multiple_of(align_of::<Node>()) {
            return Self::from_bytes(bytes);
        }
        let (header, counts) = checked(bytes)?;
        let storage = Storage::File {
            bytes: Arc::clone(&shared),
            nodes: counts.nodes,
            references: counts.references,
        };
        let tree = Self { header, storage, parts: None };
        let triangles = header.triangles as usize;
        check::walk(tree.nodes(), tree.references(), header.bounds, triangles, |_, _, _| ())?;
        Ok(tree)
    }
}

struct Counts {
    nodes: usize,
    references: usize,
}

/// The header of bytes that have the right length and sum.
fn checked(bytes: &[u8]) -> Result<(Header, Counts), FileError> {
    if cfg!(target_endian = "big") {
        return Err(FileError::BigEndian);
    }
    if !bytes.starts_with(MAGIC) {
        return Err(FileError::Foreign { found: bytes[..bytes.len().min(8)].to_vec() });
    }
    if bytes.len() < HEADER {
        return Err(FileError::Length { expected: HEADER as u128, found: bytes.len() });
    }
    let version = u32::from_le_bytes(array(bytes, 8));
    if version != VERSION {
        return Err(FileError::Version { found: version });
    }
    let nodes = u64::from_le_bytes(array(bytes, 16));
    let references = u64::from_le_bytes(array(bytes, 24));
    let expected = HEADER as u128 + 8 * u128::from(nodes) + 4 * u128::from(references);
    if expected != bytes.len() as u128 {
        return Err(FileError::Length { expected, found: bytes.len() });
    }
    let (expected, found) = (u64::from_le_bytes(array(bytes, CHECKSUM)), checksum(bytes));
    if expected != found {
        return Err(FileError::Checksum { expected, found });
    }
    // Both are less than the length of a slice.
    let counts = Counts { nodes: nodes as usize, references: references as usize };
    Ok((read_header(bytes)?, counts))
}

fn read_header(bytes: &[u8]) -> Result<Header, FileError> {
    let f32_at = |offset| f32::from_le_bytes(array(bytes, offset));
    let f64_at = |offset| f64::from_le_bytes(array(bytes, offset));
    let vector = |offset: usize| [0, 4, 8].map(|step| f32_at(offset + step));
    let bounds = Aabb { lower: vector(32), upper: vector(44) };
    let finite = bounds.lower.iter().chain(&bounds.upper).all(|value| value.is_finite());
    if !finite || bounds.is_empty() {
        return Err(FileError::Header { offset: 32, what: "box" });
    }
    let frame = Frame { origin: [56, 64, 72].map(f64_at), scale: f64_at(80) };
    if !frame.origin.iter().all(|v| v.is_finite()) || !frame.scale.is_normal() || frame.scale < 0.0
    {
        return Err(FileError::Header { offset: 56, what: "frame" });
    }
    let [traversal, intersect, empty_bonus] = vector(88);
    let cost = Cost { traversal, intersect, empty_bonus };
    if !(traversal > 0.0 && intersect > 0.0 && (0.0..1.0).contains(&empty_bonus)) {
        return Err(FileError::Header { offset: 88, what: "cost" });
    }
    let triangles = u32::from_le_bytes(array(bytes, 12));
    Ok(Header { bounds, frame, cost, triangles, mesh: u64::from_le_bytes(array(bytes, 104)) })
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
