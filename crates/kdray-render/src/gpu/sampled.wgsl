// The random numbers of every path, for a test. Twin: `Sampler::next` in `sampler.rs`.

@group(0) @binding(1) var<storage, read_write> squares: array<vec2f>;

@compute @workgroup_size(256)
fn sampled(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let path = number(group, groups, local);
    if path < params.bound {
        squares[path] = sample_of(path, params.bounce);
    }
}
