// Try the part `double`: sum, difference, product, quotient, and the f32 of the first operand.

//#import count
//#import double_product

@group(0) @binding(0) var<uniform> params: Count;
@group(0) @binding(1) var<storage> counter: array<u32>;
@group(0) @binding(2) var<storage> operands: array<Double>;
@group(0) @binding(3) var<storage, read_write> results: array<Double>;

@compute @workgroup_size(256)
fn probe_double(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) invocation: u32,
) {
    let i = group_index(group, groups) * WORKGROUP + invocation;
    if i >= element_count(params) {
        return;
    }
    let a = operands[2u * i];
    let b = operands[2u * i + 1u];
    results[5u * i] = d_add(a, b);
    results[5u * i + 1u] = d_add(a, Double(b.high, b.low, b.exponent, b.sign ^ F_SIGN));
    results[5u * i + 2u] = d_mul(a, b);
    results[5u * i + 3u] = d_div(a, b);
    results[5u * i + 4u] = d_of(d_to_f32(a));
}
