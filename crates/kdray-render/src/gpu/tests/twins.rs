//! What kernels give, beside what the CPU gives.

use kdray_gpu::record::{Kernel, Moved, Recording, Work};

use super::lavapipe;
use crate::gpu::kernels::{NONE, Params, SAMPLED};
use crate::sampler::Sampler;

fn run(kernel: &'static Kernel, params: &Params, buffers: &[&kdray_gpu::device::Buffer]) {
    let mut recording = Recording::new(lavapipe());
    let work = Work::each(&params.bound.into());
    recording.dispatch(kernel, params, buffers, &work, |_| Moved::default());
    recording.run().expect("it runs");
}

/// Bit for bit: every dimension, odd and even bits, pixels beyond the curve, samples that repeat.
#[test]
fn random_numbers_are_those_of_the_cpu() {
    let device = lavapipe();
    for samples in [1, 2, 3, 8, 16, 1000, 16_384] {
        for first_pixel in [0, 70_000, 600 * 1300 + 500] {
            for dimension in [0, 1, 7] {
                let (pixels, samples_here) = (500_u32, 2);
                let params = Params {
                    bound: pixels * samples_here,
                    at: NONE,
                    width: 1300,
                    height: 1000,
                    samples,
                    sample_bits: Sampler::sample_bits(samples),
                    first_pixel,
                    first_sample: samples / 2,
                    samples_here,
                    bounce: dimension,
                    ..Params::default()
                };
                let squares = device.buffer("squares", 2 * u64::from(params.bound)).unwrap();
                run(&SAMPLED, &params, &[&squares]);
                let found: Vec<[f32; 2]> = device.read(&squares).unwrap();
                for (path, found) in (0..).zip(found) {
                    let pixel = first_pixel + path / samples_here;
                    let sample = params.first_sample + path % samples_here;
                    let mut sampler = Sampler::new([pixel % 1300, pixel / 1300], sample, samples);
                    for _ in 0..dimension {
                        sampler.next();
                    }
                    let expected = sampler.next();
                    let bits = |square: [f32; 2]| square.map(f32::to_bits);
                    assert_eq!(bits(found), bits(expected), "{params:?} {path}");
                }
            }
        }
    }
}
