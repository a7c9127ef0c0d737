//! The bytes of a glTF document: the chunks of a GLB, data URIs and files, fetched when first used.

use std::cell::{Cell, OnceCell};

use data_url::DataUrl;
use percent_encoding::percent_decode_str;

use super::External;
use super::schema::{Buffer, Root};
use crate::error::{LoadError, Place, Reason};

/// Elements without data that any file may have.
const FREE_ZEROS: u64 = 65_536;

/// Takes a GLB file apart: its JSON, and its binary chunk if it has one.
pub(super) fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), LoadError> {
    let version = glb_word(bytes, 4)?;
    if version != 2 {
        let reason = format!("GLB version {version}");
        return Err(LoadError::unsupported(Place::byte(4), reason));
    }
    let announced = glb_word(bytes, 8)? as usize;
    if announced > bytes.len() {
        let reason = format!("{announced} bytes are announced, {} are here", bytes.len());
        return Err(LoadError::truncated(Place::byte(8), reason));
    }
    let (kind, json) = glb_chunk(bytes, 12)?;
    if kind != u32::from_le_bytes(*b"JSON") {
        let reason = "the first chunk of a GLB must be JSON";
        return Err(LoadError::malformed(Place::byte(16), reason));
    }
    // Chunks start on multiples of four.
    let next = (20 + json.len()).next_multiple_of(4);
    if next >= announced {
        return Ok((json, None));
    }
    let (kind, content) = glb_chunk(bytes, next)?;
    let is_binary = kind == u32::from_le_bytes(*b"BIN\0");
    Ok((json, is_binary.then_some(content)))
}

fn glb_word(bytes: &[u8], at: usize) -> Result<u32, LoadError> {
    let word = bytes.get(at..at + 4).and_then(|word| word.try_into().ok());
    let missing = || LoadError::truncated(Place::byte(at), "a GLB header is cut off");
    word.map(u32::from_le_bytes).ok_or_else(missing)
}

/// The kind and the content of the chunk at `at`.
fn glb_chunk(bytes: &[u8], at: usize) -> Result<(u32, &[u8]), LoadError> {
    let (length, kind) = (glb_word(bytes, at)?, glb_word(bytes, at + 4)?);
    let content = slice(bytes, at as u64 + 8, length.into());
    let missing = || {
        let left = bytes.len() - at;
        let reason = format!("a chunk of {length} bytes is announced, {left} are left");
        LoadError::truncated(Place::byte(at), reason)
    };
    Ok((kind, content.ok_or_else(missing)?))
}

/// The buffers of a document.
pub(super) struct Buffers<'a> {
    root: &'a Root,
    chunk: Option<&'a [u8]>,
    external: External<'a>,
    fetched: Vec<OnceCell<Vec<u8>>>,
    /// How many more elements may be zeros that no byte stands for.
    zeros_left: Cell<u64>,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(
        root: &'a Root,
        chunk: Option<&'a [u8]>,
        external: External<'a>,
        file_size: usize,
    ) -> Self {
        let fetched = root.buffers.iter().map(|_| OnceCell::new()).collect();
        let zeros_left = Cell::new(FREE_ZEROS.max(file_size as u64));
        Self { root, chunk, external, fetched, zeros_left }
    }

    /// Whether an accessor without data may have `count` elements; if so, they count.
    pub(super) fn spend_zeros(&self, count: u64) -> bool {
        let left = self.zeros_left.get().checked_sub(count);
        self.zeros_left.set(left.unwrap_or(self.zeros_left.get()));
        left.is_some()
    }

    /// The bytes of a buffer view, and its stride if it has one.
    pub(super) fn view(&self, index: usize) -> Result<(&[u8], Option<u64>), LoadError> {
        let place = || Place::item(format!("bufferView {index}"));
        let missing = || LoadError::malformed(place(), "there is no such buffer view");
        let view = self.root.buffer_views.get(index).ok_or_else(missing)?;
        let buffer = self.buffer(view.buffer)?;
        let bytes = slice(buffer, view.byte_offset, view.byte_length);
        let reason = || {
            let (offset, length, all) = (view.byte_offset, view.byte_length, buffer.len());
            format!("{length} bytes from byte {offset} on, of a buffer of {all}")
        };
        Ok((bytes.ok_or_else(|| LoadError::truncated(place(), reason()))?, view.byte_stride))
    }

    fn buffer(&self, index: usize) -> Result<&[u8], LoadError> {
        let place = || Place::item(format!("buffer {index}"));
        let Some((buffer, cell)) = self.root.buffers.get(index).zip(self.fetched.get(index)) else {
            return Err(LoadError::malformed(place(), "there is no such buffer"));
        };
        let bytes = match (&buffer.uri, self.chunk) {
            (None, Some(chunk)) if index == 0 => chunk,
            (None, _) => return Err(LoadError::malformed(place(), "it has no uri and no chunk")),
            (Some(uri), _) => match cell.get() {
                Some(bytes) => bytes,
                None => {
                    let bytes = self.fetch(buffer, uri);
                    let bytes = bytes.map_err(|reason| LoadError::new(place(), reason))?;
                    cell.get_or_init(|| bytes)
                }
            },
        };
        if (bytes.len() as u64) < buffer.byte_length {
            let reason =
                format!("{} bytes are announced, {} are here", buffer.byte_length, bytes.len());
            return Err(LoadError::truncated(place(), reason));
        }
        Ok(bytes)
    }

    fn fetch(&self, buffer: &Buffer, uri: &str) -> Result<Vec<u8>, Reason> {
        if uri.starts_with("data:") {
            let bad = |what: &str| Reason::Malformed(format!("its data URI is {what}"));
            let url = DataUrl::process(uri).map_err(|_| bad("not well formed"))?;
            return Ok(url.decode_to_vec().map_err(|_| bad("not base64"))?.0);
        }
        if uri.contains("://") {
            return Err(Reason::Unsupported(format!("the remote buffer {uri}")));
        }
        let name = percent_decode_str(uri).decode_utf8();
        let name = name.map_err(|_| Reason::Malformed("its uri is not UTF-8".into()))?;
        (self.external)(&name, buffer.byte_length).map_err(|error| {
            Reason::Io(std::io::Error::new(error.kind(), format!("{name}: {error}")))
        })
    }
}

/// `length` bytes from `offset` on, if they are there.
pub(super) fn slice(bytes: &[u8], offset: u64, length: u64) -> Option<&[u8]> {
    let start = usize::try_from(offset).ok()?;
    let end = usize::try_from(offset.checked_add(length)?).ok()?;
    bytes.get(start..end)
}
