// Random numbers that are none. Twin: `sampler.rs`, bit for bit.

const CURVE_BITS = 9u;

// The 24 orders of four, ascending: two bits a digit, a byte an order.
var<private> orders: array<u32, 6> = array(
    0x2d271e1bu, 0x4e4b3936u, 0x78726c63u, 0x9c938d87u, 0xc9c6b4b1u, 0xe4e1d8d2u
);

// Two coordinates of a path's sample, each in 0..1.
fn sample_of(path: u32, dimension: u32) -> vec2f {
    let pixel = pixel_of(path);
    let x = pixel % params.width;
    let y = pixel / params.width;
    let sample = params.first_sample + path % params.samples_here;
    let mask = (1u << CURVE_BITS) - 1u;
    let along = spread(x & mask) | (spread(y & mask) << 1u);
    let within = sample & ((1u << params.sample_bits) - 1u);
    let position = (along << params.sample_bits) | within;
    let curve = hash((x >> CURVE_BITS) | ((y >> CURVE_BITS) << 16u));
    let seed = hash(curve ^ (dimension * 0x9e3779b9u));
    let index = shuffled(position, seed);
    let first = owen_scramble(reverseBits(index), hash(seed ^ 0x68bc21ebu));
    let second = owen_scramble(second_sobol(index), hash(seed ^ 0x02e5be93u));
    return vec2f(f32(first >> 8u), f32(second >> 8u)) / 16777216.0;
}

// The position with the children of every node of the curve's quad tree shuffled.
fn shuffled(position: u32, seed: u32) -> u32 {
    let odd = params.sample_bits & 1u;
    var index = 0u;
    var shift = 2u * CURVE_BITS + params.sample_bits;
    for (; shift > odd; ) {
        shift -= 2u;
        let above = select(position >> ((shift + 2u) & 31u), 0u, shift >= 30u);
        index |= permute4((position >> shift) & 3u, hash(above ^ seed)) << shift;
    }
    if odd == 1u {
        index |= (position ^ hash((position >> 1u) ^ seed)) & 1u;
    }
    return index;
}

// One of the orders, applied to a digit.
fn permute4(digit: u32, random: u32) -> u32 {
    let order = ((random >> 8u) * 24u) >> 24u;
    return (orders[order / 4u] >> (8u * (order % 4u) + 2u * digit)) & 3u;
}

// Puts a zero bit above each of the lowest 16 bits.
fn spread(bits: u32) -> u32 {
    var x = bits;
    x = (x | (x << 8u)) & 0x00ff00ffu;
    x = (x | (x << 4u)) & 0x0f0f0f0fu;
    x = (x | (x << 2u)) & 0x33333333u;
    return (x | (x << 1u)) & 0x55555555u;
}

// The second dimension of the Sobol sequence.
fn second_sobol(sobol_index: u32) -> u32 {
    var index = sobol_index;
    var direction = 1u << 31u;
    var result = 0u;
    for (; index != 0u; ) {
        result ^= direction * (index & 1u);
        direction ^= direction >> 1u;
        index >>= 1u;
    }
    return result;
}

// Shuffles the halves, the quarters, and so on, of the unit interval.
fn owen_scramble(bits: u32, seed: u32) -> u32 {
    var x = reverseBits(bits) + seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return reverseBits(x);
}

// A bijection in which each bit of the input moves each bit of the output half of the time.
fn hash(bits: u32) -> u32 {
    var x = bits;
    x = (x ^ (x >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}
