//! Floats on devices, against the processor's.

use kdray_gpu::device::Device;
use kdray_gpu::float::double::{self, Double};
use kdray_gpu::float::{Floats, probe};
use kdray_test::random::Random;

use crate::support;

/// Operands of any bits that are numbers.
fn random_cases(count: usize) -> Vec<[u32; 3]> {
    let mut random = Random::new(7);
    let mut number = || loop {
        let bits = random.word();
        if f32::from_bits(bits).is_finite() {
            return bits;
        }
    };
    (0..count).map(|_| [number(), number(), number()]).collect()
}

/// The first `operations` of every case are those of the processor.
fn check(device: &Device, floats: Floats, cases: &[[u32; 3]], operations: std::ops::Range<usize>) {
    for (case, results) in cases.iter().zip(probe::run(device, floats, cases).unwrap()) {
        let [a, b, c] = case.map(f32::from_bits);
        let expected = probe::evaluate(a, b, c);
        for operation in operations.clone() {
            let Some(expected) = expected[operation] else { continue };
            let result = results[operation];
            assert_eq!(
                result,
                expected.to_bits(),
                "operation {operation} of {a:e} {b:e} {c:e}: {:e}, {expected:e}",
                f32::from_bits(result)
            );
        }
    }
}

#[test]
fn soft_floats_are_those_of_the_processor() {
    for device in [support::lavapipe(), support::swiftshader()] {
        check(device, Floats::Soft, &probe::cases(), 0..8);
    }
    check(support::lavapipe(), Floats::Soft, &random_cases(2_000_000), 0..8);
}

#[test]
fn the_form_that_is_chosen_is_right() {
    for device in [support::lavapipe(), support::swiftshader()] {
        let floats = device.floats().unwrap();
        println!("{}: {floats:?}", device.adapter().name);
        let cases = random_cases(200_000);
        match floats {
            Floats::SoftDivision => {
                check(device, Floats::Hardware, &cases, 0..7);
                check(device, Floats::Soft, &cases, 7..8);
            }
            floats => check(device, floats, &cases, 0..8),
        }
    }
}

#[test]
fn doubles_are_those_of_the_processor() {
    for (device, count) in [(support::lavapipe(), 1_000_000), (support::swiftshader(), 50_000)] {
        let cases = double::cases(count);
        let results = probe::run_double(device, &cases).unwrap();
        for ([a, b], [arithmetic @ .., single]) in cases.iter().zip(&results) {
            let (expected, bits) = double::evaluate(*a, *b);
            for (operation, (result, expected)) in arithmetic.iter().zip(expected).enumerate() {
                let is_right = expected.is_none_or(|expected| expected == *result);
                assert!(is_right, "operation {operation} of {a:e} {b:e}: {result:?} {expected:?}");
            }
            let expected = f64::from(f32::from_bits(bits));
            // The f32 came back as a double, which an infinity has no form for.
            let is_right = expected.is_infinite() || Double::from(expected) == *single;
            assert!(is_right, "{a:e} as f32: {single:?}, {expected:e}");
        }
    }
}
