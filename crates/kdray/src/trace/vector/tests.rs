//! Vectors, lane by lane.

use super::*;
use crate::trace::simd::Best;

fn a(lane: usize) -> f32 {
    (if lane & 2 == 0 { -1.7 } else { 0.3 }) * (1 + lane) as f32
}

fn b(lane: usize) -> f32 {
    5.3 - lane as f32
}

fn of<V: Vector>(proof: V::Proof, of: &dyn Fn(usize) -> f32) -> V {
    V::of_numbers(proof, &Numbers(std::array::from_fn(of)))
}

fn equal<V: Vector>(vector: V, of: &dyn Fn(usize) -> f32) {
    for lane in 0..V::LANES {
        assert_eq!(vector.numbers().0[lane].to_bits(), of(lane).to_bits(), "lane {lane}");
    }
}

fn bits<V: Vector>(is: &dyn Fn(usize) -> bool) -> u32 {
    (0..V::LANES).fold(0, |bits, lane| bits | u32::from(is(lane)) << lane)
}

/// Every function, lane by lane.
fn functions_are_those_of_numbers<V: Vector>(proof: V::Proof) {
    let (va, vb): (V, V) = (of(proof, &a), of(proof, &b));
    equal(va + vb, &|i| a(i) + b(i));
    equal(va - vb, &|i| a(i) - b(i));
    equal(va * vb, &|i| a(i) * b(i));
    equal(va / vb, &|i| a(i) / b(i));
    equal(va.min(vb), &|i| a(i).min(b(i)));
    equal(va.max(vb), &|i| a(i).max(b(i)));
    // Of two without an order, the second.
    equal(va.all(f32::NAN).min(va), &a);
    equal(va.all(f32::NAN).max(va), &a);
    equal(va.min(va.all(f32::NAN)).max(vb), &b);
    equal(va.all(-0.0).min(va.all(0.0)), &|_| 0.0);
    equal(va.all(0.0).max(va.all(-0.0)), &|_| -0.0);
    equal(va.magnitude(), &|i| a(i).abs());
    // In double precision the product is exact.
    equal(va.fused(vb, va), &|i| (f64::from(a(i)) * f64::from(b(i)) + f64::from(a(i))) as f32);
    equal(va.all(0.7), &|_| 0.7);
    let (less, most) = (va.is_less(vb), vb.is_at_most(va));
    assert_eq!(less.bits(), bits::<V>(&|i| a(i) < b(i)));
    assert_eq!(va.is_at_most(va).and_not(most).bits(), bits::<V>(&|i| b(i) > a(i)));
    assert_eq!(less.and(most).bits(), 0);
    assert_eq!(less.or(most).bits(), bits::<V>(&|_| true));
    equal(V::pick(less, va, vb), &|i| if a(i) < b(i) { a(i) } else { b(i) });
}

#[cfg(target_arch = "x86_64")]
fn rays() -> [Ray; MOST] {
    std::array::from_fn(|index| {
        let number = |place: usize| (8 * index + place) as f32;
        Ray {
            origin: [number(0), number(1), number(2)],
            t_min: number(3),
            direction: [number(4), number(5), number(6)],
            t_max: number(7),
        }
    })
}

/// So it is with what only packets need.
#[cfg(target_arch = "x86_64")]
fn functions_of_packets_are_those_of_numbers<V: Vector>(proof: V::Proof) {
    for (place, column) in V::of_rays(proof, &rays()[..V::LANES]).into_iter().enumerate() {
        equal(column, &|lane| (8 * lane + place) as f32);
    }
    let (va, vb): (V, V) = (of(proof, &a), of(proof, &b));
    equal(va.with_signs_of(vb), &|i| a(i).copysign(b(i)));
    assert_eq!(va.greatest(), (0..V::LANES).map(a).fold(f32::NEG_INFINITY, f32::max));
    for lane in 0..V::LANES {
        let one = |low: f32| move |i: usize| if i == lane { low } else { 0.5 };
        assert_eq!(of::<V>(proof, &one(f32::INFINITY)).greatest(), f32::INFINITY);
        assert_eq!(of::<V>(proof, &one(-3.0)).least(), -3.0);
    }
    let (pa, pb) = (va.precise(), vb.precise());
    let precise = |of: &dyn Fn(f64, f64) -> f64, lane: usize| {
        of(f64::from(a(lane)), f64::from(b(lane))) as f32
    };
    equal((pa * pb + pa).rounded(), &|i| precise(&|a, b| a * b + a, i));
    equal((pa / pb - pb).rounded(), &|i| precise(&|a, b| a / b - b, i));
    equal(pa.min(pb).rounded(), &|i| precise(&|a, b| a.min(b), i));
    equal(pa.max(pb.all(0.1)).rounded(), &|i| precise(&|a, _| a.max(0.1), i));
    let (less, most) = (pa.is_less(pb), pb.is_at_most(pa));
    assert_eq!(less.bits(), bits::<V>(&|i| a(i) < b(i)));
    assert_eq!(less.or(most).and_not(less).bits(), bits::<V>(&|i| b(i) <= a(i)));
    assert_eq!(less.and(most).bits(), 0);
}

#[cfg(target_arch = "x86_64")]
#[test]
fn all_that_this_processor_has() {
    match Best::detect().avx2() {
        Some(proof) => {
            functions_are_those_of_numbers::<Eight>(proof);
            functions_of_packets_are_those_of_numbers::<Eight>(proof);
        }
        None => println!("this processor has no AVX2: its vectors were not tested"),
    }
    match Best::detect().avx512() {
        Some(proof) => {
            functions_are_those_of_numbers::<Sixteen>(proof);
            functions_of_packets_are_those_of_numbers::<Sixteen>(proof);
        }
        None => println!("this processor has no AVX-512: its vectors were not tested"),
    }
}

#[cfg(target_arch = "aarch64")]
#[test]
fn all_that_this_processor_has() {
    match Best::detect() {
        Best::Neon(proof) => functions_are_those_of_numbers::<Eight>(proof),
        Best::Plain => println!("this processor has no NEON: its vectors were not tested"),
    }
}
