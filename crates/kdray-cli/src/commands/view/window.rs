//! The window of `kdray view`.

use std::process::ExitCode;
use std::sync::atomic::AtomicBool;

use kdray_mesh::Sequence;
use kdray_view::{Look, Start};

use super::Arguments;

static NEVER: AtomicBool = AtomicBool::new(false);

/// Shows the frames until the window is closed.
pub(super) fn open(
    sequence: Sequence,
    look: Look,
    arguments: &Arguments,
) -> anyhow::Result<ExitCode> {
    let start = Start {
        title: format!("kdray: {}", arguments.frames[0].display()),
        size: [arguments.size.width, arguments.size.height],
        look,
        frame: arguments.frame,
        frames: sequence.frames(),
    };
    let threads = arguments.threads;
    let make = move |frame| {
        let scene = super::mesh(&sequence, frame);
        scene.and_then(|mesh| super::scene(mesh, threads, &NEVER)).map_err(|e| format!("{e:#}"))
    };
    kdray_view::show(start, Box::new(make))?;
    Ok(ExitCode::SUCCESS)
}
