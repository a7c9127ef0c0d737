//! How fast the primitives are on a device: `cargo run --release -p kdray-gpu --example primitives`.
//!
//! Runs on lavapipe, or on the adapter that the variable `KDRAY_TEST_GPU` names.

use std::time::Instant;

use kdray_gpu::primitives::compact::Compaction;
use kdray_gpu::primitives::radix::{Pairs, Sort};
use kdray_gpu::primitives::scan::Scan;
use kdray_gpu::primitives::segmented::SegmentedScan;
use kdray_gpu::record::{Count, Recording};
use kdray_gpu::{Device, GpuError, Limits};
use kdray_test::random::Random;
use kdray_test::vulkan;

const RUNS: u32 = 5;

fn main() -> Result<(), GpuError> {
    vulkan::set_up();
    let name = vulkan::override_name().unwrap_or_else(|| vulkan::LAVAPIPE.to_owned());
    let Ok(selection) = name.parse();
    let device = Device::open(&selection, &Limits::PORTABLE)?;
    println!("{}: {}", device.adapter().name, device.adapter().driver);
    println!("floats: {:?}\n", device.floats()?);
    println!("{:28} {:>9} {:>11} {:>10} {:>7}", "", "M", "best ms", "M a second", "GB/s");
    for size in [1 << 16, 1 << 20, 8 << 20] {
        measure(&device, size)?;
    }
    Ok(())
}

fn measure(device: &Device, size: u32) -> Result<(), GpuError> {
    let count = Count::from(size);
    let words = Random::new(1).words(size as usize);
    let [keys, values, flags] = [
        device.upload("keys", &words)?,
        device.upload("values", &words)?,
        device.upload("flags", &words.iter().map(|word| word & 1).collect::<Vec<_>>())?,
    ];
    let [room_keys, room_values] =
        [device.buffer("room", size.into())?, device.buffer("room", size.into())?];
    let total = device.buffer("total", 1)?;
    let scan = Scan::new(device, size)?;
    time(device, "scan", size, |recording| scan.record(recording, &values, &count, None))?;
    let compaction =
        Compaction { flags: &flags, values: &values, kept: &room_values, total: (&total, 0) };
    time(device, "compact", size, |recording| compaction.record(recording, &scan, &count))?;
    let offsets: Vec<u32> = (0..size).step_by(100).collect();
    let segments = offsets.len() as u32;
    let offsets = device.upload("offsets", &offsets)?;
    let segmented = SegmentedScan::new(device, size, segments)?;
    time(device, "scan, segments of 100", size, |recording| {
        segmented.record(recording, &values, &count, &offsets, segments);
    })?;
    let sort = Sort::new(device, size)?;
    let pairs = Pairs { keys: &keys, values: &values };
    let room = Pairs { keys: &room_keys, values: &room_values };
    time(device, "sort, 32 bits", size, |recording| {
        sort.record(recording, pairs, room, &count, 32);
    })?;
    println!();
    Ok(())
}

/// Prints the best of some runs.
fn time(
    device: &Device,
    name: &str,
    size: u32,
    record: impl Fn(&mut Recording),
) -> Result<(), GpuError> {
    let mut recording = Recording::new(device);
    record(&mut recording);
    let moved = recording.profile()?.total().moved;
    let mut best = f64::INFINITY;
    for _ in 0..RUNS {
        let start = Instant::now();
        recording.run()?;
        device.wait()?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    let millions = f64::from(size) / 1e6;
    let gigabytes = (moved.read + moved.written) as f64 / 1e9;
    let [ms, rate, bandwidth] = [best * 1e3, millions / best, gigabytes / best];
    println!("{name:28} {millions:9.2} {ms:11.2} {rate:10.1} {bandwidth:7.2}");
    Ok(())
}
