//! Software Vulkan drivers, so that what runs on a GPU can be tested without one.
//!
//! `.ci/vulkan` puts them into `target/vulkan`, and tests find them there. With the variable
//! `KDRAY_TEST_GPU`, tests run on the adapter of that name or index instead, with the drivers of
//! the system.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use libloading::Library;

/// Where the drivers are.
const FOLDER: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../target/vulkan");

/// The adapter of Mesa's lavapipe, or the one that `KDRAY_TEST_GPU` names.
pub const LAVAPIPE: &str = "llvmpipe";

/// The adapter of SwiftShader: correct, and slow wherever invocations wait for each other.
pub const SWIFTSHADER: &str = "SwiftShader";

/// The adapter that tests are to run on instead of the software drivers.
#[must_use]
pub fn override_name() -> Option<String> {
    std::env::var("KDRAY_TEST_GPU").ok()
}

/// Makes the drivers known to this process. Call it before anything that uses Vulkan.
///
/// # Panics
///
/// If the drivers are not there. The message says what to do about it.
pub fn set_up() {
    static LIBRARIES: OnceLock<Vec<Library>> = OnceLock::new();
    LIBRARIES.get_or_init(|| {
        for (variable, value) in environment() {
            if variable != "LD_LIBRARY_PATH" {
                // SAFETY: it happens once, before this process uses Vulkan. Other threads of the
                // tests wait here for it, and Rust's own readers of the environment are kept out.
                unsafe { std::env::set_var(variable, value) };
            }
        }
        if override_name().is_some() { Vec::new() } else { load_all(&libraries()) }
    });
}

/// The variables that make the drivers known to a new process; none if `KDRAY_TEST_GPU` is set.
///
/// # Panics
///
/// As [`set_up`].
#[must_use]
pub fn environment() -> Vec<(&'static str, OsString)> {
    if override_name().is_some() {
        return Vec::new();
    }
    let folder = Path::new(FOLDER);
    let manifests = ["lavapipe.json", "swiftshader.json"].map(|name| folder.join(name));
    for manifest in &manifests {
        assert!(
            manifest.exists(),
            "{} is not there: run `.ci/vulkan`, which brings software Vulkan drivers, or name an \
             adapter of this machine in KDRAY_TEST_GPU",
            manifest.display()
        );
    }
    let manifests = std::env::join_paths(&manifests).expect("the paths have no colons");
    vec![
        ("VK_DRIVER_FILES", manifests.clone()),
        // The name that older loaders know.
        ("VK_ICD_FILENAMES", manifests),
        ("LD_LIBRARY_PATH", folder.join("lib").into()),
        // Mesa complains where there is none.
        ("XDG_RUNTIME_DIR", std::env::temp_dir().into()),
    ]
}

/// What the drivers need beside the libraries of the system.
fn libraries() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(Path::new(FOLDER).join("lib")).into_iter().flatten();
    entries.map(|entry| entry.expect("an entry").path()).collect()
}

/// Loads libraries, each after those that it needs. Whoever asks for one by its name then gets it,
/// as if it were in the library path.
fn load_all(paths: &[PathBuf]) -> Vec<Library> {
    let mut loaded = Vec::new();
    let mut waiting: Vec<&PathBuf> = paths.iter().collect();
    loop {
        let before = waiting.len();
        waiting.retain(|path| {
            // SAFETY: libraries of the system's own distribution, which do nothing when loaded.
            let library = unsafe { Library::new(path.as_path()) };
            library.map(|library| loaded.push(library)).is_err()
        });
        if waiting.is_empty() {
            return loaded;
        }
        assert!(waiting.len() < before, "cannot load {waiting:?}");
    }
}
