//! Random numbers that are none: low-discrepancy points by integer hashing alone.
//!
//! Each pair of dimensions is an Owen-scrambled Sobol sequence [Bur20]; pixels take consecutive
//! pieces of it along a Z curve whose turns are shuffled, so that the errors of neighbouring pixels
//! differ as much as they can and noise looks like fine grain [AW20]. Only 32-bit integers are used.

/// Pixels of this many bits in x and y share one curve; beyond it the pattern is hashed anew.
const CURVE_BITS: u32 = 9;

/// The points of one sample of one pixel, two dimensions at a time.
pub(crate) struct Sampler {
    /// Position on the curve, the sample in its lowest bits.
    position: u32,
    sample_bits: u32,
    curve: u32,
    dimension: u32,
}

impl Sampler {
    /// The most samples that differ from each other.
    const MOST_SAMPLES: u32 = 1 << (32 - 2 * CURVE_BITS);

    /// Of `sample` out of `samples`.
    pub(crate) fn new([x, y]: [u32; 2], sample: u32, samples: u32) -> Self {
        let sample_bits = Self::sample_bits(samples);
        let mask = (1 << CURVE_BITS) - 1;
        let along = spread(x & mask) | spread(y & mask) << 1;
        Self {
            position: along << sample_bits | sample & ((1 << sample_bits) - 1),
            sample_bits,
            curve: hash(x >> CURVE_BITS | y >> CURVE_BITS << 16),
            dimension: 0,
        }
    }

    /// Bits that tell so many samples apart.
    pub(crate) fn sample_bits(samples: u32) -> u32 {
        samples.clamp(1, Self::MOST_SAMPLES).next_power_of_two().ilog2()
    }

    /// The next two coordinates, each in 0..1.
    pub(crate) fn next(&mut self) -> [f32; 2] {
        let seed = hash(self.curve ^ self.dimension.wrapping_mul(0x9e37_79b9));
        self.dimension += 1;
        let index = self.shuffled(seed);
        let x = owen_scramble(index.reverse_bits(), hash(seed ^ 0x68bc_21eb));
        let y = owen_scramble(second_sobol(index), hash(seed ^ 0x02e5_be93));
        [x, y].map(|bits| (bits >> 8) as f32 / 16_777_216.0)
    }

    /// The position with the children of every node of the curve's quad tree shuffled.
    fn shuffled(&self, seed: u32) -> u32 {
        let odd = self.sample_bits & 1;
        let mut index = 0;
        let mut shift = 2 * CURVE_BITS + self.sample_bits;
        while shift > odd {
            shift -= 2;
            let above = self.position.checked_shr(shift + 2).unwrap_or(0);
            let digit = self.position >> shift & 3;
            index |= permute4(digit, hash(above ^ seed)) << shift;
        }
        if odd == 1 {
            index |= (self.position ^ hash(self.position >> 1 ^ seed)) & 1;
        }
        index
    }
}

/// One of the 24 orders of four, applied to a digit.
fn permute4(digit: u32, random: u32) -> u32 {
    const ORDERS: [[u8; 4]; 24] = orders_of_four();
    u32::from(ORDERS[(((random >> 8) * 24) >> 24) as usize][digit as usize])
}

const fn orders_of_four() -> [[u8; 4]; 24] {
    let mut orders = [[0; 4]; 24];
    let (mut found, mut code) = (0, 0);
    while code < 256 {
        let order = [code as u8 & 3, code as u8 >> 2 & 3, code as u8 >> 4 & 3, code as u8 >> 6];
        let seen = 1 << order[0] | 1 << order[1] | 1 << order[2] | 1 << order[3];
        if seen == 15 {
            orders[found] = order;
            found += 1;
        }
        code += 1;
    }
    orders
}

/// Puts a zero bit above each of the lowest 16 bits.
fn spread(mut x: u32) -> u32 {
    x = (x | x << 8) & 0x00ff_00ff;
    x = (x | x << 4) & 0x0f0f_0f0f;
    x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

/// The second dimension of the Sobol sequence; the first is the index with its bits reversed.
fn second_sobol(mut index: u32) -> u32 {
    let (mut direction, mut result) = (1_u32 << 31, 0);
    while index != 0 {
        if index & 1 == 1 {
            result ^= direction;
        }
        direction ^= direction >> 1;
        index >>= 1;
    }
    result
}

/// Shuffles the halves, the quarters, and so on, of the unit interval [Bur20].
fn owen_scramble(x: u32, seed: u32) -> u32 {
    let mut x = x.reverse_bits().wrapping_add(seed);
    for factor in [0x6c50_b47c, 0xb82f_1e52, 0xc7af_e638, 0x8d22_f6e6_u32] {
        x ^= x.wrapping_mul(factor);
    }
    x.reverse_bits()
}

/// A bijection in which each bit of the input moves each bit of the output half of the time.
fn hash(mut x: u32) -> u32 {
    x = (x ^ x >> 16).wrapping_mul(0x7feb_352d);
    x = (x ^ x >> 15).wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How many of `n` by `m` cells have other than one of the `n * m` points.
    fn badly_filled(points: &[[f32; 2]], n: usize, m: usize) -> usize {
        let mut cells = vec![0; n * m];
        for [x, y] in points {
            cells[(x * n as f32) as usize * m + (y * m as f32) as usize] += 1;
        }
        cells.iter().filter(|count| **count != 1).count()
    }

    #[test]
    fn a_pixel_fills_every_stratum_once_in_each_dimension() {
        for samples in [2, 16, 32] {
            let mut samplers: Vec<_> =
                (0..samples).map(|sample| Sampler::new([700, 13], sample, samples)).collect();
            for _dimension in 0..4 {
                let points: Vec<_> = samplers.iter_mut().map(Sampler::next).collect();
                let mut n = 1;
                while n <= samples as usize {
                    assert_eq!(badly_filled(&points, n, samples as usize / n), 0);
                    n *= 2;
                }
            }
        }
    }

    #[test]
    fn four_neighbouring_pixels_fill_finer_strata_together() {
        let pixels = [[6, 8], [7, 8], [6, 9], [7, 9]];
        let point = |pixel, sample| Sampler::new(pixel, sample, 4).next();
        let points: Vec<_> =
            pixels.into_iter().flat_map(|pixel| (0..4).map(move |s| point(pixel, s))).collect();
        assert_eq!(badly_filled(&points, 4, 4), 0);
    }

    #[test]
    fn dimensions_pixels_and_curves_differ() {
        let mut first = Sampler::new([5, 5], 0, 16);
        let points = [first.next(), first.next(), Sampler::new([6, 5], 0, 16).next()];
        let far = Sampler::new([5 + (1 << CURVE_BITS), 5], 0, 16).next();
        assert!(points[0] != points[1] && points[0] != points[2] && points[0] != far);
    }

    #[test]
    fn any_number_of_samples_will_do() {
        for samples in [0, 1, 3, Sampler::MOST_SAMPLES, u32::MAX] {
            let [x, y] = Sampler::new([u32::MAX, 0], samples / 2, samples).next();
            assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y));
        }
    }
}
