//! How a command ends when it cannot do its work.

use std::process::ExitCode;

use kdray::{BatchError, BuildError};
use kdray_gpu::GpuError;
use kdray_render::Cancelled;

/// Exit status of a cancelled command: that of a program ended by an interrupt.
const CANCELLED: u8 = 130;

/// Says on standard error what went wrong, in one line; with `json` also as an object on standard
/// output.
pub(crate) fn report(error: &anyhow::Error, json: bool) -> ExitCode {
    let cancelled = is_cancelled(error);
    let message = if cancelled { "cancelled".to_owned() } else { message(error) };
    if json {
        println!("{}", serde_json::json!({ "error": message }));
    }
    if cancelled {
        eprintln!("kdray: {message}");
        return ExitCode::from(CANCELLED);
    }
    eprintln!("kdray: error: {message}");
    ExitCode::FAILURE
}

fn is_cancelled(error: &anyhow::Error) -> bool {
    let on_gpu = error.downcast_ref();
    error.is::<Cancelled>()
        || error.downcast_ref() == Some(&BuildError::Cancelled)
        || error.downcast_ref() == Some(&BatchError::Cancelled)
        || on_gpu == Some(&GpuError::Build(BuildError::Cancelled))
        || on_gpu == Some(&GpuError::Batch(BatchError::Cancelled))
}

/// The error and its causes, joined by colons. Causes that a message already ends with are not
/// repeated.
fn message(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if text.is_empty() {
            text = cause;
        } else if !text.ends_with(&cause) {
            text = format!("{text}: {cause}");
        }
    }
    text.replace('\n', " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;

    #[test]
    fn causes_are_joined_and_not_repeated() {
        let inner = Err::<(), _>(anyhow::anyhow!("it is a folder"));
        let error =
            inner.context("cannot read a.ply: it is a folder").context("input").unwrap_err();
        assert_eq!(message(&error), "input: cannot read a.ply: it is a folder");
    }

    #[test]
    fn cancellation_is_known_through_its_context() {
        let error = anyhow::Error::from(BuildError::Cancelled).context("a.ply");
        assert!(is_cancelled(&error));
        assert!(is_cancelled(&Cancelled.into()));
        assert!(!is_cancelled(&anyhow::anyhow!("no")));
    }
}
