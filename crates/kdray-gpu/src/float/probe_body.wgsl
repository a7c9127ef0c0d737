// What the probes compute: single operations, and sums and products that drivers like to rewrite.
// Twin: `evaluate` in `probe.rs`.

//#import count

const OPERATIONS = 8u;

@group(0) @binding(0) var<uniform> params: Count;
@group(0) @binding(1) var<storage> counter: array<u32>;
@group(0) @binding(2) var<storage> operands: array<u32>;
@group(0) @binding(3) var<storage, read_write> results: array<u32>;

fn probe(group: vec3u, groups: vec3u, invocation: u32) {
    let i = group_index(group, groups) * WORKGROUP + invocation;
    if i >= element_count(params) {
        return;
    }
    let a = operands[3u * i];
    let b = operands[3u * i + 1u];
    let c = operands[3u * i + 2u];
    let at = i * OPERATIONS;
    results[at] = f_add(a, b);
    results[at + 1u] = f_sub(a, b);
    results[at + 2u] = f_mul(a, b);
    results[at + 3u] = f_add(f_mul(a, b), c);
    results[at + 4u] = f_add(f_mul(a, b), f_mul(a, c));
    results[at + 5u] = f_add(f_sub(a, b), b);
    results[at + 6u] = f_mul(f_mul(a, b), c);
    results[at + 7u] = f_div(a, b);
}
