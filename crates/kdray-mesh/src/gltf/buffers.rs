//! The bytes of a glTF document: the chunks of a GLB, data URIs and files, fetched when first used.

use std::cell::OnceCell;

use data_url::DataUrl;
use percent_encoding::percent_decode_str;

use super::External;
use super::schema::{Buffer, Root};
use crate::error::{LoadError, Place, Reason};

/// Takes a GLB file apart: its JSON, and its binary chunk if it has one.
pub(super) fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), LoadError> {
    let word = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|word| word.try_into().ok());
        let missing = || LoadError::truncated(Place::byte(at), "a GLB header is cut off");
        word.map(u32::from_le_bytes).ok_or_else(missing)
    };
    let version = word(4)?;
    if version != 2 {
        return Err(LoadError::unsupported(Place::byte(4), format!("GLB version {version}")));
    }
    let announced = word(8)? as usize;
    if announced > bytes.len() {
        let reason = format!("{announced} bytes are announced, {} are here", bytes.len());
        return Err(LoadError::truncated(Place::byte(8), reason));
    }
    let chunk = |at: usize| -> Result<(u32, &[u8]), LoadError> {
        let length = word(at)? as usize;
        let content = (at + 8).checked_add(length).and_then(|end| bytes.get(at + 8..end));
        let reason = || format!("a chunk of {length} bytes is announced, {} are left", bytes.len() - at);
        Ok((word(at + 4)?, content.ok_or_else(|| LoadError::truncated(Place::byte(at), reason()))?))
    };
    let (kind, json) = chunk(12)?;
    if kind != u32::from_le_bytes(*b"JSON") {
        return Err(LoadError::malformed(Place::byte(16), "the first chunk of a GLB must be JSON"));
    }
    // Chunks start on multiples of four.
    let next = (20 + json.len()).next_multiple_of(4);
    if next >= announced {
        return Ok((json, None));
    }
    let (kind, content) = chunk(next)?;
    Ok((json, (kind == u32::from_le_bytes(*b"BIN\0")).then_some(content)))
}

/// The buffers of a document.
pub(super) struct Buffers<'a> {
    root: &'a Root,
    chunk: Option<&'a [u8]>,
    external: External<'a>,
    fetched: Vec<OnceCell<Vec<u8>>>,
    /// How many elements an accessor without data may claim: each is a zero that no byte stands for.
    pub(super) most_zeros: u64,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(
        root: &'a Root,
        chunk: Option<&'a [u8]>,
        external: External<'a>,
        file_size: usize,
    ) -> Self {
        let fetched = root.buffers.iter().map(|_| OnceCell::new()).collect();
        Self { root, chunk, external, fetched, most_zeros: file_size as u64 }
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
            let reason = format!("{} bytes are announced, {} are here", buffer.byte_length, bytes.len());
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
