//! The thread that traces while the window answers.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::thread;

use kdray_render::RenderOptions;

use super::{Event, MakeScene};
use crate::{Look, Scene};

/// Samples a pixel of the finest picture: more take longer, and show less noise.
const MOST_SAMPLES: u32 = 64;

/// How many times fewer pixels along a side the first picture has after a change.
const COARSE: u32 = 4;

/// What the window wants to show.
#[derive(Clone, Copy)]
pub(super) struct Request {
    pub(super) look: Look,
    pub(super) frame: usize,
    pub(super) size: [u32; 2],
    pub(super) is_playing: bool,
}

/// The window's end of the worker.
pub(super) struct Worker {
    requests: Sender<Request>,
    cancel: Arc<AtomicBool>,
}

impl Worker {
    /// Starts the thread; `tell` says whether anybody listens still.
    pub(super) fn new(
        make: MakeScene,
        frames: usize,
        tell: impl Fn(Event) -> bool + Send + 'static,
    ) -> Self {
        let (requests, received) = mpsc::channel();
        let cancel = Arc::new(AtomicBool::new(false));
        let tracing = Tracing { make, frames, received, cancel: cancel.clone(), scene: None };
        thread::spawn(move || tracing.run(tell));
        Self { requests, cancel }
    }

    /// Wants something else from now on.
    pub(super) fn ask(&self, request: Request) {
        self.cancel.store(true, Ordering::Relaxed);
        // A worker that is gone has said why.
        let _ = self.requests.send(request);
    }
}

struct Tracing {
    make: MakeScene,
    frames: usize,
    received: Receiver<Request>,
    cancel: Arc<AtomicBool>,
    /// The last frame's scene.
    scene: Option<(usize, Scene)>,
}

impl Tracing {
    fn run(mut self, tell: impl Fn(Event) -> bool) {
        // How many frames were played.
        let mut played = 0;
        let mut waiting = None;
        while let Some(request) = waiting.take().or_else(|| self.received.recv().ok()) {
            let request = self.received.try_iter().last().unwrap_or(request);
            self.cancel.store(false, Ordering::Relaxed);
            let frame = (request.frame + played) % self.frames;
            if let Err(reason) = self.load(frame) {
                tell(Event::Failed(reason));
                return;
            }
            if !self.refine(&request, &tell) {
                return;
            }
            if request.is_playing {
                played += 1;
                waiting = Some(request);
            }
        }
    }

    /// Makes the frame the scene.
    fn load(&mut self, frame: usize) -> Result<(), String> {
        if self.scene.as_ref().is_none_or(|(known, _)| *known != frame) {
            self.scene = Some((frame, (self.make)(frame)?));
        }
        Ok(())
    }

    /// Tells of finer and finer pictures, until something else is wanted; while frames are played,
    /// of a single one. Gives whether anybody listens.
    fn refine(&self, request: &Request, tell: &impl Fn(Event) -> bool) -> bool {
        let Some((_, scene)) = &self.scene else { return true };
        let doubled = std::iter::successors(Some(1), |samples| Some(2 * samples));
        let fine = doubled.take_while(|samples| *samples <= MOST_SAMPLES).map(|n| (1, n));
        let coarse = (!request.is_playing).then_some((COARSE, 1));
        let steps = coarse.into_iter().chain(fine);
        for (shrink, samples) in steps.take(if request.is_playing { 1 } else { usize::MAX }) {
            let [width, height] = request.size.map(|side| (side / shrink).max(1));
            let options = RenderOptions {
                width,
                height,
                samples: Some(samples),
                cancel: Some(&self.cancel),
                ..RenderOptions::default()
            };
            let Ok(picture) = scene.picture(&request.look, &options) else { return true };
            if !tell(Event::Picture(picture)) {
                return false;
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Orbit;
    use kdray::{BuildOptions, Mesh, Tree};
    use kdray_render::{Camera, Shading};
    use std::time::Duration;

    fn request(mesh: &Mesh) -> Request {
        let camera = Camera::framing(&mesh.bounds(), Camera::Y_UP, 1.0);
        let orbit = Orbit::new(&camera);
        let look = Look { orbit, shading: Shading::Normals, cells: None, statistics: false };
        Request { look, frame: 0, size: [32, 32], is_playing: false }
    }

    fn triangle(frame: usize) -> Mesh {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0 + frame as f32, 0.0]];
        Mesh::new(&positions, &[[0, 1, 2]]).expect("finite")
    }

    fn make(frame: usize) -> Result<Scene, String> {
        if frame == 2 {
            return Err("frame 2 is bad".into());
        }
        let mesh = triangle(frame);
        let tree = Tree::build(&mesh, &BuildOptions::default()).map_err(|e| e.to_string())?;
        Ok(Scene::new(mesh, tree, 0.0))
    }

    fn worker(frames: usize) -> (Worker, Receiver<Event>) {
        let (sender, events) = mpsc::channel();
        let tell = move |event| sender.send(event).is_ok();
        (Worker::new(Box::new(make), frames, tell), events)
    }

    fn next(events: &Receiver<Event>) -> Event {
        events.recv_timeout(Duration::from_secs(60)).expect("the worker answers")
    }

    #[test]
    fn pictures_become_finer() {
        let (worker, events) = worker(1);
        worker.ask(request(&triangle(0)));
        let mut widths = Vec::new();
        for _picture in 0..8 {
            let Event::Picture(picture) = next(&events) else { panic!("no picture") };
            widths.push((picture.width, picture.rays / u64::from(picture.width * picture.height)));
        }
        let expected = [(8, 1), (32, 1), (32, 2), (32, 4), (32, 8), (32, 16), (32, 32), (32, 64)];
        assert_eq!(widths, expected);
    }

    #[test]
    fn playing_goes_through_the_frames_and_says_what_fails() {
        let (worker, events) = worker(3);
        worker.ask(Request { is_playing: true, ..request(&triangle(0)) });
        let Event::Picture(first) = next(&events) else { panic!("no picture") };
        let Event::Picture(second) = next(&events) else { panic!("no picture") };
        assert_ne!(first.pixels, second.pixels);
        let Event::Failed(reason) = next(&events) else { panic!("frame 2 is bad") };
        assert_eq!(reason, "frame 2 is bad");
        worker.ask(request(&triangle(0)));
    }
}
