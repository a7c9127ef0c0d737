//! glTF 2.0, as JSON and as GLB: the triangles of the default scene, in its coordinates.
//!
//! Read are node transforms (in `f64`, nested), triangle lists, strips and fans, indexed or not, sparse
//! accessors, quantised positions, and buffers in the GLB, in data URIs and in files. A mirrored node turns its
//! triangles around, as the format asks. Skins and morph targets are left at rest,
//! with a note, unless a time of an animation is asked for; points and lines are left out, with a note; an extension that is required and could change the geometry is refused.
//!
//! The JSON is read by `serde_json` into a schema of our own, because the `gltf` crate 1.4 panics on a POSITION
//! accessor out of range, refuses accessors without a buffer view, and rounds transforms to `f32`.

mod accessor;
mod animation;
mod buffers;
mod pose;
mod scene;
mod schema;
mod transform;

use std::io;

use self::accessor::Accessors;
use self::animation::Player;
use self::buffers::Buffers;
use self::pose::Pose;
use self::schema::Root;
use crate::Loaded;
use crate::error::{LoadError, Place};

/// Gets a file that the document refers to: its relative path, and how many bytes are of use.
pub(crate) type External<'a> = &'a dyn Fn(&str, u64) -> io::Result<Vec<u8>>;

/// Reads a glTF or GLB file.
pub(crate) fn read(bytes: &[u8], external: External) -> Result<Loaded, LoadError> {
    with_accessors(bytes, external, |accessors| scene::flatten(accessors, None))
}

/// Reads a file as it is at `time` of an animation, in seconds: skins and morph targets move.
pub(crate) fn read_at(
    bytes: &[u8],
    external: External,
    animation: usize,
    time: f64,
) -> Result<Loaded, LoadError> {
    with_accessors(bytes, external, |accessors| {
        let pose = Pose::new(&Player::new(&accessors, animation)?, &accessors, time)?;
        scene::flatten(accessors, Some(&pose))
    })
}

/// How long an animation is, in seconds.
pub(crate) fn duration(
    bytes: &[u8],
    external: External,
    animation: usize,
) -> Result<f64, LoadError> {
    with_accessors(bytes, external, |accessors| Player::new(&accessors, animation)?.duration())
}

fn with_accessors<T>(
    bytes: &[u8],
    external: External,
    read: impl FnOnce(Accessors) -> Result<T, LoadError>,
) -> Result<T, LoadError> {
    let (json, chunk) =
        if bytes.starts_with(b"glTF") { buffers::split_glb(bytes)? } else { (bytes, None) };
    let root = parse(json)?;
    check_extensions(&root)?;
    let buffers = Buffers::new(&root, chunk, external, bytes.len());
    read(Accessors { root: &root, buffers: &buffers })
}

fn parse(json: &[u8]) -> Result<Root, LoadError> {
    let root: Root = serde_json::from_slice(json).map_err(|error| {
        LoadError::malformed(
            Place::line(error.line()),
            format!("the JSON of the document: {error}"),
        )
    })?;
    if root.asset.version.starts_with("2.") {
        return Ok(root);
    }
    let reason = format!("glTF version {}; 2.0 is read", root.asset.version);
    Err(LoadError::unsupported(Place::item("asset"), reason))
}

/// Refuses required extensions, but for those that leave positions alone or are read here.
fn check_extensions(root: &Root) -> Result<(), LoadError> {
    const HARMLESS: &[&str] = &[
        "KHR_mesh_quantization",
        "KHR_materials_",
        "KHR_texture_",
        "KHR_lights_",
        "KHR_xmp",
        "EXT_texture_",
        "EXT_lights_",
    ];
    let is_harmful = |name: &&String| !HARMLESS.iter().any(|prefix| name.starts_with(prefix));
    match root.extensions_required.iter().find(is_harmful) {
        None => Ok(()),
        Some(name) => {
            let place = Place::item("extensionsRequired");
            Err(LoadError::unsupported(place, format!("the extension {name}")))
        }
    }
}
