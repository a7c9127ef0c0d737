//! Pictures on a window, through wgpu.

use std::sync::Arc;

use kdray_render::Picture;
use winit::window::Window;

/// What draws into a window.
pub(super) struct Screen {
    surface: wgpu::Surface<'static>,
    device: wgpu::Device,
    queue: wgpu::Queue,
    settings: wgpu::SurfaceConfiguration,
    pipeline: wgpu::RenderPipeline,
    sampler: wgpu::Sampler,
    /// The picture that is shown, and its size.
    picture: Option<(wgpu::Texture, wgpu::BindGroup)>,
}

impl Screen {
    /// The errors say what is missing.
    pub(super) fn new(window: &Arc<Window>) -> Result<Self, String> {
        let descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        let instance = wgpu::Instance::new(descriptor);
        let surface = instance.create_surface(window.clone()).map_err(|error| error.to_string())?;
        let wanted = wgpu::RequestAdapterOptions {
            compatible_surface: Some(&surface),
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&wanted));
        let adapter = adapter.map_err(|error| error.to_string())?;
        let opened = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            required_limits: wgpu::Limits::downlevel_defaults().using_resolution(adapter.limits()),
            ..Default::default()
        }));
        let (device, queue) = opened.map_err(|error| error.to_string())?;
        let size = window.inner_size();
        let [width, height] = [size.width, size.height].map(|side| side.max(1));
        let settings = surface.get_default_config(&adapter, width, height);
        let mut settings = settings.ok_or("the GPU has no format for it")?;
        // Pictures are in sRGB already.
        let formats = surface.get_capabilities(&adapter).formats;
        let plain = formats.iter().find(|format| !format.is_srgb());
        settings.format = plain.copied().unwrap_or(settings.format);
        surface.configure(&device, &settings);
        let pipeline = pipeline(&device, settings.format);
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor::default());
        Ok(Self { surface, device, queue, settings, pipeline, sampler, picture: None })
    }

    pub(super) fn resize(&mut self, [width, height]: [u32; 2]) {
        (self.settings.width, self.settings.height) = (width, height);
        self.surface.configure(&self.device, &self.settings);
    }

    /// Shows `picture` from the next draw on, over the whole window.
    pub(super) fn load(&mut self, picture: &Picture) {
        let same = |(texture, _): &(wgpu::Texture, _)| {
            [texture.width(), texture.height()] == [picture.width, picture.height]
        };
        let kept = self.picture.take().filter(same);
        let shown = kept.unwrap_or_else(|| self.texture(picture.width, picture.height));
        let opaque = |[r, g, b]: &[u8; 3]| [*r, *g, *b, 255];
        let texels: Vec<u8> = picture.pixels.iter().flat_map(opaque).collect();
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * picture.width),
            rows_per_image: None,
        };
        let size = wgpu::Extent3d {
            width: picture.width,
            height: picture.height,
            depth_or_array_layers: 1,
        };
        self.queue.write_texture(shown.0.as_image_copy(), &texels, layout, size);
        self.picture = Some(shown);
    }

    fn texture(&self, width: u32, height: u32) -> (wgpu::Texture, wgpu::BindGroup) {
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let group = self.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("picture"),
            layout: &self.pipeline.get_bind_group_layout(0),
            entries: &[
                entry(0, wgpu::BindingResource::TextureView(&view)),
                entry(1, wgpu::BindingResource::Sampler(&self.sampler)),
            ],
        });
        (texture, group)
    }

    /// Draws the picture; a window that is not to be seen is left alone.
    pub(super) fn draw(&mut self) -> Result<(), String> {
        use wgpu::CurrentSurfaceTexture as Current;
        let target = match self.surface.get_current_texture() {
            Current::Success(target) | Current::Suboptimal(target) => target,
            Current::Timeout | Current::Occluded => return Ok(()),
            Current::Outdated => {
                self.surface.configure(&self.device, &self.settings);
                return Ok(());
            }
            Current::Lost => return Err("the window's surface is lost".into()),
            Current::Validation => return Err("the driver refuses its surface".into()),
        };
        let view = target.texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let attachment = wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations::default(),
        };
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(attachment)],
            ..Default::default()
        });
        if let Some((_, group)) = &self.picture {
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, group, &[]);
            pass.draw(0..3, 0..1);
        }
        drop(pass);
        self.queue.submit([encoder.finish()]);
        self.queue.present(target);
        Ok(())
    }
}

fn pipeline(device: &wgpu::Device, format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
    let module = device.create_shader_module(wgpu::include_wgsl!("screen.wgsl"));
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("picture"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &module,
            entry_point: Some("corner"),
            compilation_options: Default::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &module,
            entry_point: Some("pixel"),
            compilation_options: Default::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
