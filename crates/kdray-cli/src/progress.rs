//! Progress bars, where somebody is watching.

use indicatif::{ProgressBar, ProgressStyle};

/// The steps of a bar.
const STEPS: u64 = 1000;

/// A bar on standard error that goes away when its work is done; invisible if that is no terminal.
pub(crate) struct Progress(ProgressBar);

impl Progress {
    pub(crate) fn new(what: &'static str) -> Self {
        let bar = ProgressBar::new(STEPS).with_message(what);
        let style = ProgressStyle::with_template("{msg:>10} {bar:40} {percent:>3} %  {eta}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        Self(bar)
    }

    /// Shows that this fraction is done.
    pub(crate) fn set(&self, fraction: f32) {
        self.0.set_position((fraction * STEPS as f32) as u64);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
