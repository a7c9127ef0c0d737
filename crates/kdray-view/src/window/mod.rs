//! A window on a scene: the mouse goes around it, keys change how it is shown.

mod screen;
mod worker;

use std::sync::Arc;

use kdray_render::{Picture, Shading};
use winit::application::ApplicationHandler;
use winit::dpi::{PhysicalPosition, PhysicalSize};
use winit::event::{ElementState, MouseButton, MouseScrollDelta, WindowEvent};
use winit::event_loop::{ActiveEventLoop, EventLoop, EventLoopProxy};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowId};

use crate::{DEEPEST, Look, Scene};
use screen::Screen;
use worker::{Request, Worker};

/// Radians that a drag across a window's height turns.
const TURN: f32 = 3.0;

/// How much nearer a notch of the wheel goes.
const NOTCH: f32 = 1.15;

/// The depth of the cells that are drawn first.
const DEPTH: u32 = 6;

/// Pixels that a touchpad scrolls for a notch.
const PIXELS_A_NOTCH: f64 = 40.0;

/// Why there is no window, or no more.
#[derive(Debug, thiserror::Error)]
pub enum WindowError {
    /// The system opens no window.
    #[error("cannot open a window: {0}")]
    Window(String),
    /// No GPU can draw into it.
    #[error("cannot draw into the window: {0}")]
    Screen(String),
    /// A frame cannot be read or built.
    #[error("{0}")]
    Frame(String),
}

/// What is shown: the scene of every frame, made when it is asked for.
pub type MakeScene = Box<dyn FnMut(usize) -> Result<Scene, String> + Send>;

/// What a window starts with.
pub struct Start {
    /// In the window's frame.
    pub title: String,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// How the scene is looked at first.
    pub look: Look,
    /// The frame that is shown first, and how many there are.
    pub frame: usize,
    /// How many frames there are.
    pub frames: usize,
}

/// Opens a window, and returns when it was closed.
///
/// The left mouse button turns, the right one shifts, the wheel approaches; 1 to 4 shade by
/// normals, ambient occlusion, paths and cost; C draws cells, + and - change their depth; S
/// writes statistics; the space bar plays frames; Escape closes.
///
/// # Errors
///
/// [`WindowError`]: there is no display, no GPU that can draw there, or a frame cannot be made.
pub fn show(start: Start, make: MakeScene) -> Result<(), WindowError> {
    let failed = |error: winit::error::EventLoopError| WindowError::Window(error.to_string());
    let events = EventLoop::<Event>::with_user_event().build().map_err(failed)?;
    let mut app = App::new(start, make, events.create_proxy());
    events.run_app(&mut app).map_err(failed)?;
    app.failure.map_or(Ok(()), Err)
}

/// What the worker tells the window.
pub(crate) enum Event {
    Picture(Picture),
    Failed(String),
}

struct App {
    title: String,
    size: [u32; 2],
    request: Request,
    worker: Worker,
    window: Option<(Arc<Window>, Screen)>,
    /// The button that is held, and where the mouse was.
    held: Option<MouseButton>,
    mouse: PhysicalPosition<f64>,
    failure: Option<WindowError>,
}

impl App {
    fn new(start: Start, make: MakeScene, proxy: EventLoopProxy<Event>) -> Self {
        let Start { title, size, look, frame, frames } = start;
        Self {
            title,
            size,
            request: Request { look, frame, size, is_playing: false },
            worker: Worker::new(make, frames, move |event| proxy.send_event(event).is_ok()),
            window: None,
            held: None,
            mouse: PhysicalPosition::default(),
            failure: None,
        }
    }

    fn open(&mut self, events: &ActiveEventLoop) -> Result<(), WindowError> {
        let [width, height] = self.size;
        let size = PhysicalSize::new(width, height);
        let attributes = Window::default_attributes().with_title(&self.title).with_inner_size(size);
        let window = events.create_window(attributes);
        let window = window.map_err(|error| WindowError::Window(error.to_string()))?;
        let window = Arc::new(window);
        let screen = Screen::new(&window).map_err(WindowError::Screen)?;
        self.resize(window.inner_size());
        self.window = Some((window, screen));
        self.worker.ask(self.request);
        Ok(())
    }

    fn resize(&mut self, size: PhysicalSize<u32>) {
        self.request.size = [size.width.max(1), size.height.max(1)];
    }

    /// Whether the picture changes.
    fn key(&mut self, key: &Key) -> bool {
        let look = &mut self.request.look;
        let depth = look.cells.unwrap_or(0);
        match key.as_ref() {
            Key::Character("1") => look.shading = Shading::Normals,
            Key::Character("2") => look.shading = Shading::Ao,
            Key::Character("3") => look.shading = Shading::Path,
            Key::Character("4") => look.shading = Shading::Cost,
            Key::Character("c") => look.cells = look.cells.xor(Some(DEPTH)),
            Key::Character("+" | "=") => look.cells = Some((depth + 1).min(DEEPEST)),
            Key::Character("-") => look.cells = depth.checked_sub(1),
            Key::Character("s") => look.statistics = !look.statistics,
            Key::Named(NamedKey::Space) => self.request.is_playing = !self.request.is_playing,
            _ => return false,
        }
        true
    }

    /// Whether the picture changes.
    fn drag(&mut self, to: PhysicalPosition<f64>) -> bool {
        let height = f64::from(self.request.size[1]);
        let [right, down] =
            [to.x - self.mouse.x, to.y - self.mouse.y].map(|pixels| (pixels / height) as f32);
        self.mouse = to;
        let orbit = &mut self.request.look.orbit;
        match self.held {
            Some(MouseButton::Left) => orbit.turn(-TURN * right, TURN * down),
            Some(MouseButton::Right) => orbit.shift(-right, down),
            _ => return false,
        }
        true
    }

    fn scroll(&mut self, delta: MouseScrollDelta) {
        let notches = match delta {
            MouseScrollDelta::LineDelta(_, lines) => lines,
            MouseScrollDelta::PixelDelta(pixels) => (pixels.y / PIXELS_A_NOTCH) as f32,
        };
        self.request.look.orbit.approach(NOTCH.powf(notches));
    }

    fn end(&mut self, events: &ActiveEventLoop, failure: WindowError) {
        self.failure.get_or_insert(failure);
        events.exit();
    }
}

impl ApplicationHandler<Event> for App {
    fn resumed(&mut self, events: &ActiveEventLoop) {
        if self.window.is_none()
            && let Err(error) = self.open(events)
        {
            self.end(events, error);
        }
    }

    fn user_event(&mut self, events: &ActiveEventLoop, event: Event) {
        match (event, &mut self.window) {
            (Event::Failed(reason), _) => self.end(events, WindowError::Frame(reason)),
            (Event::Picture(picture), Some((window, screen))) => {
                screen.load(&picture);
                window.request_redraw();
            }
            (Event::Picture(_), None) => {}
        }
    }

    fn window_event(&mut self, events: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let has_changed = match event {
            WindowEvent::CloseRequested => return events.exit(),
            WindowEvent::RedrawRequested => {
                if let Some((_, screen)) = &mut self.window
                    && let Err(reason) = screen.draw()
                {
                    self.end(events, WindowError::Screen(reason));
                }
                return;
            }
            WindowEvent::Resized(size) => {
                self.resize(size);
                if let Some((_, screen)) = &mut self.window {
                    screen.resize(self.request.size);
                }
                true
            }
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                if event.logical_key == Key::Named(NamedKey::Escape) {
                    return events.exit();
                }
                self.key(&event.logical_key)
            }
            WindowEvent::MouseInput { state, button, .. } => {
                self.held = (state == ElementState::Pressed).then_some(button);
                false
            }
            WindowEvent::CursorMoved { position, .. } => self.drag(position),
            WindowEvent::MouseWheel { delta, .. } => {
                self.scroll(delta);
                true
            }
            _ => false,
        };
        if has_changed {
            self.worker.ask(self.request);
        }
    }
}
