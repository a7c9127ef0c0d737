//! The devices that tests run on.

use std::sync::OnceLock;

use kdray_gpu::device::Buffer;
use kdray_gpu::record::TILE;
use kdray_gpu::{Device, Limits, Selection, devices};
use kdray_test::random::Random;
use kdray_test::vulkan;

/// The first major version of Mesa whose lavapipe does not end long loops early.
const MESA: u32 = 25;

/// The device that every kernel is tested on, within the portable limits.
pub(crate) fn lavapipe() -> &'static Device {
    static DEVICE: OnceLock<Device> = OnceLock::new();
    DEVICE.get_or_init(|| {
        let device = open(vulkan::LAVAPIPE, &Limits::PORTABLE);
        let driver = &device.adapter().driver;
        if vulkan::override_name().is_none() {
            let version =
                driver.split_once("Mesa ").and_then(|(_, version)| version.split('.').next());
            let major = version.and_then(|major| major.parse::<u32>().ok());
            assert!(major >= Some(MESA), "{driver} is too old: run `.ci/vulkan --again`");
        }
        device
    })
}

/// A second driver, for small inputs.
pub(crate) fn swiftshader() -> &'static Device {
    static DEVICE: OnceLock<Device> = OnceLock::new();
    DEVICE.get_or_init(|| open(vulkan::SWIFTSHADER, &Limits::PORTABLE))
}

/// Opens an adapter by name and says what it is.
pub(crate) fn open(name: &str, limits: &Limits) -> Device {
    vulkan::set_up();
    let name = vulkan::override_name().unwrap_or_else(|| name.to_owned());
    let selection: Selection = name.parse().expect("every word is a selection");
    let device = Device::open(&selection, limits);
    let device = device.unwrap_or_else(|error| panic!("{error}; all adapters: {:?}", devices()));
    println!("on {}: {}", device.adapter().name, device.adapter().driver);
    device
}

/// The first `count` words of a buffer, which has at least one.
pub(crate) fn prefix(device: &Device, buffer: &Buffer, count: usize) -> Vec<u32> {
    let mut words: Vec<u32> = device.read(buffer).expect("the buffer can be read");
    words.truncate(count);
    words
}

/// Nothing, and the edges of invocations, workgroups and tiles.
pub(crate) fn sizes() -> Vec<u32> {
    let edges = [1, 16, 256, TILE, 2 * TILE, TILE * 255];
    let mut sizes: Vec<u32> = edges.iter().flat_map(|&edge| [edge - 1, edge, edge + 1]).collect();
    sizes.extend([100, 12_345]);
    sizes
}

/// Offsets of segments of `count` values in all, from 0 to `count`; some are empty, some long.
pub(crate) fn segments(random: &mut Random, count: u32) -> Vec<u32> {
    let mut offsets = vec![0];
    let mut end = 0;
    loop {
        let lengths = [0, 0, 1, 1, 2, 5, 17, 100, 300, 5_000, 40_000];
        let length = random.pick(&lengths);
        end += length;
        offsets.push(end.min(count));
        if end >= count {
            return offsets;
        }
    }
}
