//! Pictures.

use kdray_render::gpu::{RenderError, Renderer};
use kdray_render::{Camera, RenderOptions, Shading, render};
use numpy::{IntoPyArray, PyArray3, ndarray};
use pyo3::prelude::*;

use crate::error;
use crate::gpu::OnGpu;
use crate::run::run;
use crate::tree::Tree;

/// What a picture is told, as a dict.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Options {
    width: u32,
    height: u32,
    shading: String,
    samples: Option<u32>,
    eye: Option<[f64; 3]>,
    target: Option<[f64; 3]>,
    up: [f32; 3],
    fov: f32,
    ground: bool,
    threads: usize,
    progress: Option<Py<PyAny>>,
}

#[pymethods]
impl Tree {
    /// Rows of pixels in sRGB, from the top left.
    fn render<'py>(&self, py: Python<'py>, options: Options) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let shading = options.shading()?;
        let picture = run(py, options.threads, options.progress.as_ref(), |watch| {
            let report = |fraction| watch.report(fraction);
            let render_options = RenderOptions {
                width: options.width,
                height: options.height,
                shading,
                samples: options.samples,
                ground: options.ground,
                progress: Some(&report),
                cancel: Some(watch.cancel()),
                ..RenderOptions::default()
            };
            let camera = options.camera(self, render_options.aspect());
            let mesh = &self.scene.mesh;
            match self.gpu.as_ref().and_then(OnGpu::tracer) {
                Some(tracer) if shading != Shading::Cost => Renderer::new(tracer.device())
                    .map_err(RenderError::from)
                    .and_then(|mut it| it.render(tracer, mesh, &camera, &render_options))
                    .map_err(|error| match error {
                        RenderError::Gpu(error) => error::gpu(&error),
                        other => error::value(other),
                    }),
                _ => render(self.scene.tracer(), mesh, &camera, &render_options)
                    .map_err(error::value),
            }
        })??;
        let shape = (picture.height as usize, picture.width as usize, 3);
        let pixels = ndarray::Array3::from_shape_vec(shape, picture.pixels.into_flattened());
        Ok(pixels.expect("a colour a pixel").into_pyarray(py))
    }
}

impl Options {
    fn shading(&self) -> PyResult<Shading> {
        match self.shading.as_str() {
            "normals" => Ok(Shading::Normals),
            "ao" => Ok(Shading::Ao),
            "path" => Ok(Shading::Path),
            "cost" => Ok(Shading::Cost),
            other => Err(error::value(format!(
                "shading is {other:?}, which is none of 'normals', 'ao', 'path' and 'cost'"
            ))),
        }
    }

    /// The camera asked for; what is not given is that of a view of the whole mesh.
    fn camera(&self, tree: &Tree, aspect: f32) -> Camera {
        let framing = Camera::framing_mesh(&tree.scene.mesh, self.up, aspect);
        let local = |point| tree.scene.mesh.frame().local_point(point);
        Camera {
            eye: self.eye.map_or(framing.eye, local),
            target: self.target.map_or(framing.target, local),
            up: self.up,
            fov: self.fov,
        }
    }
}
