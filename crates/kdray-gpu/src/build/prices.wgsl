// The prices of a node's planes, operation by operation those of the tree's definition.
//
// Twin: `NodeCost` of kdray. Prices are floats that are not negative: their bits compare like them.
// Whoever imports this has the parameters.

//#import level
//#import float

const ONE = 0x3f800000u;

// Prices of planes along one axis.
struct Prices {
    face: u32,
    girth: u32,
    step: u32,
    test: u32,
}

fn prices_of(lower: vec3u, upper: vec3u, axis: u32) -> Prices {
    let x = f_sub(f_of_key(upper.x), f_of_key(lower.x));
    let y = f_sub(f_of_key(upper.y), f_of_key(lower.y));
    let z = f_sub(f_of_key(upper.z), f_of_key(lower.z));
    let half_area = f_add(f_mul(x, f_add(y, z)), f_mul(y, z));
    let one = select(select(x, z, axis == 1u), y, axis == 0u);
    let other = select(select(y, x, axis == 1u), z, axis == 0u);
    var prices: Prices;
    prices.face = f_mul(params.intersect, f_mul(one, other));
    prices.girth = f_mul(params.intersect, f_add(one, other));
    prices.step = f_mul(params.traversal, half_area);
    prices.test = f_mul(params.intersect, half_area);
    return prices;
}

// A count as a float. Every device is exact where 24 bits are enough.
fn float_of(count: u32) -> u32 {
    if count < 0x1000000u {
        return bitcast<u32>(f32(count));
    }
    return f_from_u32(count);
}

fn leaf_price(prices: Prices, count: u32) -> u32 {
    return f_mul(prices.test, float_of(count));
}

fn split_price(prices: Prices, distances: vec2u, counts: vec2u) -> u32 {
    let left = f_mul(float_of(counts.x), distances.x);
    let right = f_mul(float_of(counts.y), distances.y);
    let faces = f_mul(prices.face, float_of(counts.x + counts.y));
    let tests = f_add(faces, f_mul(prices.girth, f_add(left, right)));
    let price = f_add(prices.step, tests);
    return f_mul(price, select(ONE, params.empty_factor, counts.x == 0u || counts.y == 0u));
}

// Whether the planes of a node are looked at.
fn is_open(prices: Prices, count: u32) -> bool {
    if params.may_split == 0u || count <= params.max_leaf {
        return false;
    }
    return leaf_price(prices, count) > f_mul(params.empty_factor, prices.step);
}
