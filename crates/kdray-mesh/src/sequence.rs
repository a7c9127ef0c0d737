//! Meshes that follow each other in time, with the same triangles.

use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

use crate::error::{LoadError, Place, Reason};
use crate::load::read_beside;
use crate::{Format, Loaded, gltf, load};

/// Frames of a scene that moves. They are read one at a time, when they are asked for.
#[derive(Debug)]
pub struct Sequence {
    source: Source,
    frames: usize,
    /// Of every frame.
    triangles: usize,
}

#[derive(Debug)]
enum Source {
    /// A mesh a frame.
    Files(Vec<PathBuf>),
    /// A mesh whose vertices are elsewhere in every frame: positions in f32, least significant byte
    /// first, frame after frame.
    Raw { base: Loaded, path: PathBuf },
    /// The first animation of a glTF file, and how many frames a second it gives.
    Animation { bytes: Vec<u8>, path: PathBuf, rate: f64 },
}

/// Frames that a glTF animation may have.
const MOST_FRAMES: f64 = 100_000.0;

impl Sequence {
    /// Opens frames: a mesh file each; or a mesh and a `.f32` file with its vertices' positions in
    /// every frame; or one glTF file, whose first animation gives `rate` frames a second.
    ///
    /// # Errors
    /// As [`load`]; a `.f32` file that is no whole number of frames; a glTF file without animations;
    /// a rate that is not above zero.
    pub fn open(paths: &[PathBuf], rate: f64) -> Result<Self, LoadError> {
        let (source, frames) = match paths {
            [] => return Err(LoadError::new(Place::whole(), Reason::Empty)),
            [base, raw] if has_extension(raw, "f32") => raw_source(base, raw)?,
            [path] if Format::from_extension(path) == Some(Format::Gltf) => {
                let opened = animation(path, rate);
                opened.map_err(|error| error.in_file(path))?
            }
            files => (Source::Files(files.to_vec()), files.len()),
        };
        let mut sequence = Self { source, frames, triangles: 0 };
        sequence.triangles = sequence.read(0)?.triangles.len();
        Ok(sequence)
    }

    /// How many frames there are, at least one.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// How many triangles every frame has.
    #[must_use]
    pub fn triangles(&self) -> usize {
        self.triangles
    }

    /// Reads a frame, of which the first is 0.
    ///
    /// # Errors
    /// As [`load`]; and if the frame does not have as many triangles as the first.
    pub fn frame(&self, index: usize) -> Result<Loaded, LoadError> {
        let loaded = self.read(index)?;
        let (here, first) = (loaded.triangles.len(), self.triangles);
        if here == first {
            return Ok(loaded);
        }
        let reason = format!("{here} triangles, but the first frame has {first}");
        Err(LoadError::malformed(Place::item(format!("frame {index}")), reason)
            .in_file(self.path(index)))
    }

    fn read(&self, index: usize) -> Result<Loaded, LoadError> {
        let path = self.path(index);
        match &self.source {
            Source::Files(_) => load(path),
            Source::Raw { base, .. } => raw_frame(base, path, index),
            Source::Animation { bytes, rate, .. } => {
                let external = |name: &str, limit| read_beside(folder(path), name, limit);
                gltf::read_at(bytes, &external, 0, index as f64 / rate)
                    .map_err(|error| error.in_file(path))
            }
        }
    }

    /// The file that a frame is in.
    fn path(&self, index: usize) -> &Path {
        match &self.source {
            Source::Files(paths) => &paths[index.min(paths.len() - 1)],
            Source::Raw { path, .. } | Source::Animation { path, .. } => path,
        }
    }
}

fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new(""))
}

fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

fn raw_source(base: &Path, raw: &Path) -> Result<(Source, usize), LoadError> {
    let base = load(base)?;
    let io = |error| LoadError::new(Place::whole(), Reason::Io(error)).in_file(raw);
    let bytes = fs::metadata(raw).map_err(io)?.len();
    let (vertices, frame) = (base.positions.len(), frame_bytes(&base));
    if bytes == 0 || frame == 0 {
        return Err(LoadError::new(Place::whole(), Reason::Empty).in_file(raw));
    }
    if bytes % frame != 0 {
        let reason = format!(
            "{bytes} bytes are no whole number of frames of {vertices} vertices, {frame} bytes each"
        );
        return Err(LoadError::truncated(Place::whole(), reason).in_file(raw));
    }
    Ok((Source::Raw { base, path: raw.to_path_buf() }, (bytes / frame) as usize))
}

/// Bytes of a frame's positions.
fn frame_bytes(base: &Loaded) -> u64 {
    12 * base.positions.len() as u64
}

fn raw_frame(base: &Loaded, path: &Path, index: usize) -> Result<Loaded, LoadError> {
    let read = || {
        let mut file = File::open(path)?;
        file.seek(SeekFrom::Start(index as u64 * frame_bytes(base)))?;
        let mut bytes = vec![0; frame_bytes(base) as usize];
        file.read_exact(&mut bytes).map(|()| bytes)
    };
    let place = || Place::item(format!("frame {index}"));
    let bytes = read().map_err(|error| LoadError::new(place(), Reason::Io(error)).in_file(path))?;
    let number = |bytes: &[u8; 4]| f64::from(f32::from_le_bytes(*bytes));
    let numbers: Vec<f64> = bytes.as_chunks().0.iter().map(number).collect();
    let positions = numbers.as_chunks().0.to_vec();
    Ok(Loaded { positions, triangles: base.triangles.clone(), notes: Vec::new() })
}

fn animation(path: &Path, rate: f64) -> Result<(Source, usize), LoadError> {
    let bytes =
        fs::read(path).map_err(|error| LoadError::new(Place::whole(), Reason::Io(error)))?;
    let external = |name: &str, limit| read_beside(folder(path), name, limit);
    let frames = (gltf::duration(&bytes, &external, 0)? * rate).floor() + 1.0;
    if !(rate > 0.0 && frames <= MOST_FRAMES) {
        let reason = format!("{rate} frames a second make {frames} frames");
        return Err(LoadError::unsupported(Place::item("animation 0"), reason));
    }
    Ok((Source::Animation { bytes, path: path.to_path_buf(), rate }, frames as usize))
}
