//! What is looked at, how, and the picture of it.

use std::time::Instant;

use kdray::{Mesh, Tracer, Tree};
use kdray_render::{Cancelled, Picture, RenderOptions, Shading};

use crate::cells;
use crate::orbit::Orbit;

/// Where statistics are written, in pixels from the upper left corner, and how far apart lines are.
const MARGIN: u32 = 12;
const LINE: u32 = 20;

/// A mesh with its tree.
pub struct Scene {
    mesh: Mesh,
    tree: Tree,
    tracer: Tracer,
    build_s: f64,
}

/// How a scene is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Where the camera is.
    pub orbit: Orbit,
    /// How surfaces are shaded.
    pub shading: Shading,
    /// The depth of the tree's cells that are drawn; no deeper than [`DEEPEST`](crate::DEEPEST).
    pub cells: Option<u32>,
    /// Whether what tree and picture took is written on it.
    pub statistics: bool,
}

impl Scene {
    /// Takes a mesh and its tree, which took so many seconds.
    #[must_use]
    pub fn new(mesh: Mesh, tree: Tree, build_s: f64) -> Self {
        let tracer = Tracer::new(&mesh, &tree);
        Self { mesh, tree, tracer, build_s }
    }

    /// The mesh.
    #[must_use]
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The picture: that of [`kdray_render::render`] with `options`, but shaded as `look` says, with
    /// what is to be seen over it.
    ///
    /// # Errors
    ///
    /// [`Cancelled`], if the options' flag says so.
    pub fn picture(&self, look: &Look, options: &RenderOptions) -> Result<Picture, Cancelled> {
        let camera = look.orbit.camera();
        let options = RenderOptions { shading: look.shading, ..options.clone() };
        let start = Instant::now();
        let mut picture = kdray_render::render(&self.tracer, &self.mesh, &camera, &options)?;
        let seconds = start.elapsed().as_secs_f64();
        let drawn = look.cells.map(|depth| cells::of(&self.tree, depth));
        if let Some(drawn) = &drawn {
            cells::draw(&mut picture, &camera, &self.tracer, drawn);
        }
        if look.statistics {
            let drawn = look.cells.zip(drawn.as_ref().map(Vec::len));
            let lines = self.statistics(&picture, seconds, drawn);
            darken(&mut picture, 2 * MARGIN + LINE * lines.len() as u32);
            for (line, text) in (0..).zip(lines) {
                picture.write([MARGIN, MARGIN + LINE * line], &text);
            }
        }
        Ok(picture)
    }

    fn statistics(
        &self,
        picture: &Picture,
        seconds: f64,
        drawn: Option<(u32, usize)>,
    ) -> Vec<String> {
        let nodes = self.tree.nodes().len();
        let triangles = self.mesh.triangles().len();
        let (rays, ms) = (picture.rays, 1e3 * seconds);
        let speed = rays as f64 / seconds.max(1e-9) / 1e6;
        let mut lines = vec![
            format!("{triangles} triangles, {nodes} nodes, built in {:.1} ms", 1e3 * self.build_s),
            format!("{rays} rays in {ms:.1} ms, {speed:.1} million a second"),
        ];
        lines.extend(drawn.map(|(depth, cells)| format!("{cells} cells down to depth {depth}")));
        lines
    }
}

/// Makes the uppermost rows of a picture dark, so that light letters can be read there.
fn darken(picture: &mut Picture, rows: u32) {
    let pixels = rows as usize * picture.width as usize;
    for channel in picture.pixels.iter_mut().take(pixels).flatten() {
        *channel /= 3;
    }
}
