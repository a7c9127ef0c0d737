//! Real meshes, where they are at hand.
//!
//! They carry research-use terms, so they are not part of the project: they lie beside it.

use std::path::Path;

use kdray::Mesh;

/// The folder of the meshes, beside the project.
pub const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/meshes");

/// The mesh in the file `name`; `None`, and a line that says so, if it is not there.
///
/// # Panics
///
/// If the file is damaged, or is not there although the variable `CI` is set.
#[must_use]
pub fn mesh(name: &str) -> Option<Mesh> {
    let path = Path::new(FOLDER).join(name);
    if !path.exists() {
        assert!(
            std::env::var_os("CI").is_none(),
            "{} is not there, but CI needs it",
            path.display()
        );
        println!("skipped: {} is not there", path.display());
        return None;
    }
    let loaded = kdray_mesh::load(&path).expect("the shared meshes are well-formed");
    Some(loaded.mesh().expect("the shared meshes are finite"))
}
