//! Embree 4, through its C interface and its own ray packets.
//!
//! Vertices and indices are copied into buffers of Embree's, so the scene stands alone and its
//! memory is counted by Embree's own monitor. Flush-to-zero is left as Rust leaves it: off.

mod api;
mod packet;

use std::ffi::{CString, c_void};
use std::path::Path;

use anyhow::{Context, Result, ensure};
use kdray::{Mesh, Ray};

use self::api::{Aligned, Api, Arguments, RayHitPacket, RayPacket, Scene};
use self::packet::active;
use crate::definition::{EmbreeOptions, EmbreeQuality, Mode};
use crate::engine::{Builder, Engine, Hit, Index};
use crate::memory::{Memory, Meter};

pub(crate) struct Embree {
    api: &'static Api,
    options: EmbreeOptions,
}

impl Embree {
    /// Opens the library; without a path the error says how to get one.
    pub(crate) fn open(library: Option<&Path>, options: &EmbreeOptions) -> Result<Embree> {
        let path = library.context(
            "no Embree library is named: give --embree PATH or set KDRAY_EMBREE; \
             bench/get-embree fetches the library and prints its path",
        )?;
        Ok(Embree { api: Api::open(path)?, options: options.clone() })
    }

    /// The version of the library at `path`, as in "4.4.0", with a note where the CPU lacks the
    /// instructions for packets of 16, which Embree then traces ray by ray.
    pub(crate) fn version(path: &Path) -> Result<String> {
        Api::open(path)?.version()
    }
}

impl Engine for Embree {
    fn builder(&self, threads: usize) -> Result<Box<dyn Builder>> {
        let configuration = CString::new(format!("threads={threads},set_affinity=0"))?;
        let device = self.api.device(&configuration)?;
        let meter: &'static Meter = Box::leak(Box::new(Meter::new()));
        let user_data = std::ptr::from_ref(meter).cast_mut().cast();
        // SAFETY: the device is live, and the meter lives as long as the process.
        unsafe { (self.api.rtcSetDeviceMemoryMonitorFunction)(device, monitor, user_data) };
        Ok(Box::new(Device { api: self.api, device, meter, options: self.options.clone() }))
    }
}

/// Adds Embree's blocks to the meter.
///
/// # Safety
///
/// `meter` must point to a [`Meter`].
unsafe extern "C" fn monitor(meter: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: the caller gives the pointer that was registered with the device.
    unsafe { &*meter.cast::<Meter>() }.add(bytes as i64);
    true
}

/// A device with its own threads. Scenes keep the device alive, so dropping it early is fine.
struct Device {
    api: &'static Api,
    device: api::Device,
    meter: &'static Meter,
    options: EmbreeOptions,
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: the device is live and this is the reference `rtcNewDevice` gave.
        unsafe { (self.api.rtcReleaseDevice)(self.device) };
    }
}

impl Builder for Device {
    fn build(&self, mesh: &Mesh) -> Result<Box<dyn Index>> {
        self.meter.reset();
        let api = self.api;
        // SAFETY: the device is live.
        let scene = unsafe { (api.rtcNewScene)(self.device) };
        api.succeeded(self.device)?;
        let flags = if self.options.coherent { api::COHERENT } else { 0 };
        let mut committed = Committed { api, scene, flags, memory: Memory::default() };
        self.attach(mesh, scene)?;
        // SAFETY: the scene is live; flags and quality are Embree's.
        unsafe {
            (api.rtcSetSceneFlags)(scene, if self.options.robust { api::ROBUST } else { 0 });
            (api.rtcSetSceneBuildQuality)(scene, quality(self.options.quality));
            (api.rtcCommitScene)(scene);
        }
        api.succeeded(self.device)?;
        committed.memory = self.meter.memory();
        Ok(Box::new(committed))
    }
}

impl Device {
    fn attach(&self, mesh: &Mesh, scene: Scene) -> Result<()> {
        let api = self.api;
        // SAFETY: device and scene are live; the scene keeps the geometry when this reference
        // to it goes.
        unsafe {
            let geometry = (api.rtcNewGeometry)(self.device, api::TRIANGLES);
            let vertices = (api::VERTEX_BUFFER, api::FLOAT3);
            let indices = (api::INDEX_BUFFER, api::UINT3);
            let filled = self
                .fill(geometry, vertices, mesh.positions())
                .and_then(|()| self.fill(geometry, indices, mesh.triangles()));
            (api.rtcCommitGeometry)(geometry);
            (api.rtcAttachGeometry)(scene, geometry);
            (api.rtcReleaseGeometry)(geometry);
            filled
        }
    }

    /// Copies elements into a new buffer of the geometry.
    ///
    /// # Safety
    ///
    /// The geometry must be live, and `T` must be what the buffer's format says.
    unsafe fn fill<T: Copy>(
        &self,
        geometry: api::Geometry,
        (buffer, format): (i32, i32),
        elements: &[[T; 3]],
    ) -> Result<()> {
        let (size, count) = (size_of::<[T; 3]>(), elements.len());
        // SAFETY: the buffer that comes back has room for `count` elements of `size` bytes.
        unsafe {
            let room = (self.api.rtcSetNewGeometryBuffer)(geometry, buffer, 0, format, size, count);
            ensure!(count == 0 || !room.is_null(), "Embree gives no buffer");
            std::ptr::copy_nonoverlapping(elements.as_ptr(), room.cast(), count);
        }
        self.api.succeeded(self.device)
    }
}

fn quality(quality: EmbreeQuality) -> i32 {
    match quality {
        EmbreeQuality::Medium => api::MEDIUM,
        EmbreeQuality::High => api::HIGH,
    }
}

/// A scene ready for rays.
struct Committed {
    api: &'static Api,
    scene: Scene,
    flags: u32,
    memory: Memory,
}

// SAFETY: Embree allows queries of a committed scene from any number of threads.
unsafe impl Sync for Committed {}
// SAFETY: Embree's scenes belong to no thread.
unsafe impl Send for Committed {}

impl Drop for Committed {
    fn drop(&mut self) {
        // SAFETY: the scene is live and this is the reference `rtcNewScene` gave.
        unsafe { (self.api.rtcReleaseScene)(self.scene) };
    }
}

impl Committed {
    fn closest_by<const N: usize>(
        &self,
        rays: &[Ray],
        hits: &mut [Hit],
        intersect: impl Fn(*const i32, *mut RayHitPacket<N>, *mut Arguments),
    ) {
        let mut arguments = Arguments::new(self.flags);
        for (rays, hits) in rays.chunks(N).zip(hits.chunks_mut(N)) {
            let valid = Aligned(active::<N>(rays.len()));
            let mut packet = Aligned(RayHitPacket::<N>::new(rays));
            intersect(valid.0.as_ptr(), &raw mut packet.0, &raw mut arguments);
            for (lane, hit) in hits.iter_mut().enumerate() {
                *hit = packet.0.hit(lane);
            }
        }
    }

    fn any_by<const N: usize>(
        &self,
        rays: &[Ray],
        occluded: &mut [bool],
        occlude: impl Fn(*const i32, *mut RayPacket<N>, *mut Arguments),
    ) {
        let mut arguments = Arguments::new(self.flags);
        for (rays, occluded) in rays.chunks(N).zip(occluded.chunks_mut(N)) {
            let valid = Aligned(active::<N>(rays.len()));
            let mut packet = Aligned(RayPacket::<N>::new(rays));
            occlude(valid.0.as_ptr(), &raw mut packet.0, &raw mut arguments);
            for (lane, occluded) in occluded.iter_mut().enumerate() {
                *occluded = packet.0.t_far[lane] == f32::NEG_INFINITY;
            }
        }
    }
}

impl Index for Committed {
    fn closest(&self, mode: Mode, rays: &[Ray], hits: &mut [Hit]) {
        let (api, scene) = (self.api, self.scene);
        // SAFETY: the scene is committed, and packets, masks and arguments are live, aligned and
        // of the size in the function's name.
        unsafe {
            match mode {
                Mode::Single | Mode::Batch => {
                    self.closest_by(rays, hits, |_, packet, arguments| {
                        (api.rtcIntersect1)(scene, packet, arguments);
                    })
                }
                Mode::Packet8 => self.closest_by(rays, hits, |valid, packet, arguments| {
                    (api.rtcIntersect8)(valid, scene, packet, arguments);
                }),
                Mode::Packet16 => self.closest_by(rays, hits, |valid, packet, arguments| {
                    (api.rtcIntersect16)(valid, scene, packet, arguments);
                }),
            }
        }
    }

    fn any(&self, mode: Mode, rays: &[Ray], occluded: &mut [bool]) {
        let (api, scene) = (self.api, self.scene);
        // SAFETY: as in `closest`.
        unsafe {
            match mode {
                Mode::Single | Mode::Batch => {
                    self.any_by(rays, occluded, |_, packet, arguments| {
                        (api.rtcOccluded1)(scene, packet, arguments);
                    })
                }
                Mode::Packet8 => self.any_by(rays, occluded, |valid, packet, arguments| {
                    (api.rtcOccluded8)(valid, scene, packet, arguments);
                }),
                Mode::Packet16 => self.any_by(rays, occluded, |valid, packet, arguments| {
                    (api.rtcOccluded16)(valid, scene, packet, arguments);
                }),
            }
        }
    }

    fn foreign_memory(&self) -> Memory {
        self.memory
    }
}
