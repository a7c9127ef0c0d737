//! Whether a device's arithmetic is the processor's: tried on cases where it is hard to be.

use rand_pcg::Pcg32;
use rand_pcg::rand_core::{Rng, SeedableRng};

use super::Floats;
use super::double::Double;
use crate::device::Device;
use crate::error::GpuError;
use crate::record::{Binding, Count, Kernel, Moved, Recording, Work};

const BINDINGS: &[Binding] = &[Binding::Uniform, Binding::Read, Binding::Read, Binding::Write];

pub(crate) static HARDWARE: Kernel = Kernel {
    name: "probe_hardware",
    source: include_str!("probe_hardware.wgsl"),
    bindings: BINDINGS,
};

pub(crate) static SOFT: Kernel =
    Kernel { name: "probe_soft", source: include_str!("probe_soft.wgsl"), bindings: BINDINGS };

/// Tries the part `double`.
pub(crate) static DOUBLE: Kernel =
    Kernel { name: "probe_double", source: include_str!("probe_double.wgsl"), bindings: BINDINGS };

const OPERATIONS: usize = 8;
/// The last operation is a quotient; the others are sums and products.
const DIVISION: usize = OPERATIONS - 1;

/// How many of the cases are random.
const RANDOM: usize = 100_000;

/// Zeros, ends of ranges, neighbours of powers of two, and digits that round badly.
const EDGES: [u32; 20] = [
    0,
    1,
    2,
    0x0040_0000,
    0x007f_ffff,
    0x0080_0000,
    0x0080_0001,
    0x00ff_ffff,
    0x1f80_0000,
    0x3380_0000,
    0x3400_0000,
    0x3eaa_aaab,
    0x3f7f_ffff,
    0x3f80_0000,
    0x3f80_0001,
    0x4040_0000,
    0x4b7f_ffff,
    0x5f80_0000,
    0x7f00_0000,
    0x7f7f_ffff,
];

/// The fastest form that is right on `device`.
pub(super) fn choose(device: &Device) -> Result<Floats, GpuError> {
    let cases = cases();
    match wrong(device, Floats::Hardware, &cases)? {
        [0, 0] => return Ok(Floats::Hardware),
        [0, _] => return Ok(Floats::SoftDivision),
        _ => {}
    }
    match wrong(device, Floats::Soft, &cases)? {
        [0, 0] => Ok(Floats::Soft),
        wrong => {
            let what = "arithmetic in integers".to_owned();
            Err(GpuError::Driver { what, reason: format!("{wrong:?} results are wrong") })
        }
    }
}

/// How many sums and products, and how many quotients, `floats` gets wrong.
fn wrong(device: &Device, floats: Floats, cases: &[[u32; 3]]) -> Result<[usize; 2], GpuError> {
    let mut wrong = [0; 2];
    // A device may bind less than all results take.
    let most = device.limits().binding_bytes as usize / size_of::<[u32; OPERATIONS]>();
    let mut results = Vec::with_capacity(cases.len());
    for cases in cases.chunks(most.max(1)) {
        results.extend(run(device, floats, cases)?);
    }
    for (case, results) in cases.iter().zip(results) {
        let [a, b, c] = case.map(f32::from_bits);
        for (operation, (result, expected)) in
            results.into_iter().zip(evaluate(a, b, c)).enumerate()
        {
            let is_wrong = expected.is_some_and(|expected| expected.to_bits() != result);
            wrong[usize::from(operation == DIVISION)] += usize::from(is_wrong);
        }
    }
    Ok(wrong)
}

/// What the device makes of `cases`, operation by operation. With soft division, quotients are
/// those of [`Floats::Soft`] and the rest is [`Floats::Hardware`].
///
/// # Errors
///
/// If the device fails.
pub fn run(
    device: &Device,
    floats: Floats,
    cases: &[[u32; 3]],
) -> Result<Vec<[u32; OPERATIONS]>, GpuError> {
    let kernel = if floats == Floats::Soft { &SOFT } else { &HARDWARE };
    let count = Count::from(cases.len() as u32);
    let operands = device.upload("operands", cases)?;
    let results = device.buffer("results", (OPERATIONS * cases.len()) as u64)?;
    let mut recording = Recording::new(device);
    let buffers = [count.counter(device), &operands, &results];
    let moved = |n| Moved { read: 12 * n, written: 4 * OPERATIONS as u64 * n };
    recording.dispatch(kernel, &count.params(), &buffers, &Work::each(&count), moved);
    recording.run()?;
    device.read(&results)
}

/// What the device makes of pairs of f64: sum, difference, product, quotient, and the f32 nearest to
/// the first.
///
/// # Errors
///
/// If the device fails.
pub fn run_double(device: &Device, cases: &[[f64; 2]]) -> Result<Vec<[Double; 5]>, GpuError> {
    let count = Count::from(cases.len() as u32);
    let operands: Vec<_> = cases.iter().map(|case| case.map(Double::from)).collect();
    let operands = device.upload("operands", &operands)?;
    let results = device.buffer("results", 20 * cases.len() as u64)?;
    let mut recording = Recording::new(device);
    let buffers = [count.counter(device), &operands, &results];
    let moved = |n| Moved { read: 32 * n, written: 80 * n };
    recording.dispatch(&DOUBLE, &count.params(), &buffers, &Work::each(&count), moved);
    recording.run()?;
    device.read(&results)
}

/// What the processor makes of a case; `None` where the result is no number, or none is promised.
#[must_use]
pub fn evaluate(a: f32, b: f32, c: f32) -> [Option<f32>; OPERATIONS] {
    let number = |x: f32| x.is_finite().then_some(x);
    [
        Some(a + b),
        Some(a - b),
        Some(a * b),
        number(a * b + c),
        number(a * b + a * c),
        number((a - b) + b),
        number(a * b * c),
        (b != 0.0).then_some(a / b),
    ]
}

/// Operands without infinities and NaN, the same on every machine: all pairs of edges with both
/// signs, and random numbers of the same size, of any size, and close to each other.
#[must_use]
pub fn cases() -> Vec<[u32; 3]> {
    let mut random = Pcg32::seed_from_u64(0x6b64);
    let edges: Vec<u32> = EDGES.iter().flat_map(|&edge| [edge, edge | 1 << 31]).collect();
    let mut cases = Vec::with_capacity(edges.len() * edges.len() + RANDOM);
    for &a in &edges {
        cases
            .extend(edges.iter().map(|&b| [a, b, edges[random.next_u32() as usize % edges.len()]]));
    }
    while cases.len() < cases.capacity() {
        let case = [(); 3].map(|()| random.next_u32());
        let [a, b, c] = match cases.len() % 4 {
            0 => case,
            // Exponents from -8 to 7.
            1 => case.map(|bits| bits & 0x83ff_ffff | 0x3c00_0000),
            // Few digits: ties.
            2 => case.map(|bits| bits & 0x87ff_f000 | 0x3c00_0000),
            // Differences cancel.
            _ => [case[0], case[0] ^ (case[1] & 0xff), case[2]],
        };
        if [a, b, c].iter().all(|&bits| f32::from_bits(bits).is_finite()) {
            cases.push([a, b, c]);
        }
    }
    cases
}
