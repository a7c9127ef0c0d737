//! The part of Embree 4's C interface that the benchmark uses, loaded at run time.
//!
//! Layouts follow `rtcore_ray.h` and `rtcore_scene.h` of version 4.4 with one level of
//! instancing. Fields that only some builds of the library have are at the end of their
//! structures, so carrying them always serves both.

use std::ffi::{CStr, c_char, c_void};
use std::path::Path;

use anyhow::{Context, Result, ensure};
use libloading::Library;

/// A device: options, threads and memory accounting of some scenes.
pub(super) type Device = *mut c_void;
/// A scene, traced once it is committed.
pub(super) type Scene = *mut c_void;
/// A triangle mesh in a scene.
pub(super) type Geometry = *mut c_void;
/// Is told of every block of bytes taken, or given back when negative; false would stop the build.
pub(super) type MemoryMonitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;

/// `RTC_GEOMETRY_TYPE_TRIANGLE`
pub(super) const TRIANGLES: i32 = 0;
/// `RTC_BUFFER_TYPE_INDEX`
pub(super) const INDEX_BUFFER: i32 = 0;
/// `RTC_BUFFER_TYPE_VERTEX`
pub(super) const VERTEX_BUFFER: i32 = 1;
/// `RTC_FORMAT_UINT3`
pub(super) const UINT3: i32 = 0x5003;
/// `RTC_FORMAT_FLOAT3`
pub(super) const FLOAT3: i32 = 0x9003;
/// `RTC_BUILD_QUALITY_MEDIUM`
pub(super) const MEDIUM: i32 = 1;
/// `RTC_BUILD_QUALITY_HIGH`
pub(super) const HIGH: i32 = 2;
/// `RTC_SCENE_FLAG_ROBUST`
pub(super) const ROBUST: i32 = 1 << 2;
/// `RTC_RAY_QUERY_FLAG_COHERENT`
pub(super) const COHERENT: u32 = 1 << 16;
/// `RTC_INVALID_GEOMETRY_ID`
pub(super) const NO_GEOMETRY: u32 = u32::MAX;
/// `RTC_DEVICE_PROPERTY_VERSION`
const VERSION: i32 = 0;
/// `RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED`
const NATIVE_PACKETS_OF_16: i32 = 34;

/// `RTCIntersectArguments` and `RTCOccludedArguments`, which have one layout.
#[repr(C)]
pub(super) struct Arguments {
    pub(super) flags: u32,
    features: u32,
    context: *mut c_void,
    filter: *mut c_void,
    callback: *mut c_void,
    min_width_distance_factor: f32,
}

impl Arguments {
    /// Everything Embree can do, with the given query flags.
    pub(super) fn new(flags: u32) -> Arguments {
        let none = std::ptr::null_mut();
        Arguments {
            flags,
            features: u32::MAX,
            context: none,
            filter: none,
            callback: none,
            min_width_distance_factor: 0.0,
        }
    }
}

/// `RTCRay`, `RTCRay8` and `RTCRay16`: the single ray is a packet of one.
#[repr(C)]
#[derive(Clone, Copy)]
pub(super) struct RayPacket<const N: usize> {
    pub(super) origin: [[f32; N]; 3],
    pub(super) t_near: [f32; N],
    pub(super) direction: [[f32; N]; 3],
    pub(super) time: [f32; N],
    /// Becomes the distance of the hit, or minus infinity for an occluded ray.
    pub(super) t_far: [f32; N],
    pub(super) mask: [u32; N],
    pub(super) id: [u32; N],
    pub(super) flags: [u32; N],
}

/// `RTCHit`, `RTCHit8` and `RTCHit16`.
#[repr(C)]
#[derive(Clone, Copy)]
pub(super) struct HitPacket<const N: usize> {
    pub(super) normal: [[f32; N]; 3],
    pub(super) uv: [[f32; N]; 2],
    pub(super) triangle: [u32; N],
    pub(super) geometry: [u32; N],
    pub(super) instance: [u32; N],
    pub(super) instance_triangle: [u32; N],
}

/// `RTCRayHit`, `RTCRayHit8` and `RTCRayHit16`.
#[repr(C)]
#[derive(Clone, Copy)]
pub(super) struct RayHitPacket<const N: usize> {
    pub(super) ray: RayPacket<N>,
    pub(super) hit: HitPacket<N>,
}

/// Gives its content the alignment that the widest packets want.
#[repr(C, align(64))]
pub(super) struct Aligned<T>(pub(super) T);

const _: () = assert!(size_of::<RayPacket<1>>() == 48 && size_of::<HitPacket<1>>() == 36);

macro_rules! functions {
    ($($name:ident: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The functions, under their C names.
        #[expect(non_snake_case, reason = "the names of the C interface")]
        pub(super) struct Api {
            $(pub(super) $name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Api {
            /// # Safety
            ///
            /// The library must be Embree 4.
            unsafe fn load(library: &Library) -> Result<Api, libloading::Error> {
                // SAFETY: the types are those of Embree 4's headers, by the caller's word.
                Ok(unsafe { Api { $($name: *library.get(stringify!($name))?,)* } })
            }
        }
    };
}

functions! {
    rtcNewDevice: fn(*const c_char) -> Device;
    rtcReleaseDevice: fn(Device);
    rtcGetDeviceError: fn(Device) -> i32;
    rtcGetDeviceLastErrorMessage: fn(Device) -> *const c_char;
    rtcGetDeviceProperty: fn(Device, i32) -> isize;
    rtcSetDeviceMemoryMonitorFunction: fn(Device, MemoryMonitor, *mut c_void);
    rtcNewScene: fn(Device) -> Scene;
    rtcReleaseScene: fn(Scene);
    rtcSetSceneBuildQuality: fn(Scene, i32);
    rtcSetSceneFlags: fn(Scene, i32);
    rtcCommitScene: fn(Scene);
    rtcNewGeometry: fn(Device, i32) -> Geometry;
    rtcReleaseGeometry: fn(Geometry);
    rtcSetNewGeometryBuffer: fn(Geometry, i32, u32, i32, usize, usize) -> *mut c_void;
    rtcCommitGeometry: fn(Geometry);
    rtcAttachGeometry: fn(Scene, Geometry) -> u32;
    rtcIntersect1: fn(Scene, *mut RayHitPacket<1>, *mut Arguments);
    rtcIntersect8: fn(*const i32, Scene, *mut RayHitPacket<8>, *mut Arguments);
    rtcIntersect16: fn(*const i32, Scene, *mut RayHitPacket<16>, *mut Arguments);
    rtcOccluded1: fn(Scene, *mut RayPacket<1>, *mut Arguments);
    rtcOccluded8: fn(*const i32, Scene, *mut RayPacket<8>, *mut Arguments);
    rtcOccluded16: fn(*const i32, Scene, *mut RayPacket<16>, *mut Arguments);
}

impl Api {
    /// Opens the library at `path`; it stays loaded, because its worker threads outlive scenes.
    pub(super) fn open(path: &Path) -> Result<&'static Api> {
        // SAFETY: the user names the library; Embree's initialisers have no preconditions.
        let library =
            unsafe { Library::new(path) }.with_context(|| format!("loading {}", path.display()))?;
        let library: &'static Library = Box::leak(Box::new(library));
        // SAFETY: a library that has all these names is Embree; `check` below asks its version.
        let api = unsafe { Api::load(library) }
            .with_context(|| format!("{} is not Embree 4", path.display()))?;
        api.check().with_context(|| format!("in {}", path.display()))?;
        Ok(Box::leak(Box::new(api)))
    }

    fn check(&self) -> Result<()> {
        let version = self.version()?;
        ensure!(version.starts_with("4."), "Embree {version} is not Embree 4");
        Ok(())
    }

    /// The library's version, as in "4.4.0", and whether it has packets of 16 on this CPU.
    pub(super) fn version(&self) -> Result<String> {
        let device = self.device(c"threads=1")?;
        // SAFETY: the device is live until it is released here.
        let (number, native) = unsafe {
            let property = |which| (self.rtcGetDeviceProperty)(device, which);
            let properties = (property(VERSION), property(NATIVE_PACKETS_OF_16) != 0);
            (self.rtcReleaseDevice)(device);
            properties
        };
        let [major, minor, patch] = [number / 10_000, number / 100 % 100, number % 100];
        let note = if native { "" } else { " (no native packets of 16)" };
        Ok(format!("{major}.{minor}.{patch}{note}"))
    }

    /// A new device, to be released by the caller.
    pub(super) fn device(&self, configuration: &CStr) -> Result<Device> {
        // SAFETY: the configuration is a C string.
        let device = unsafe { (self.rtcNewDevice)(configuration.as_ptr()) };
        ensure!(!device.is_null(), "Embree makes no device: {}", self.message(device));
        Ok(device)
    }

    /// Fails with Embree's words if anything went wrong on the device since the last call.
    pub(super) fn succeeded(&self, device: Device) -> Result<()> {
        // SAFETY: the device is live.
        let code = unsafe { (self.rtcGetDeviceError)(device) };
        ensure!(code == 0, "Embree error {code}: {}", self.message(device));
        Ok(())
    }

    fn message(&self, device: Device) -> String {
        // SAFETY: the function takes live devices and null, and gives null or a C string that
        // is valid until the next call.
        unsafe {
            let text = (self.rtcGetDeviceLastErrorMessage)(device);
            match text.is_null() {
                true => "no reason given".to_owned(),
                false => CStr::from_ptr(text).to_string_lossy().into_owned(),
            }
        }
    }
}
