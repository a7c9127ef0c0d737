// The light of shadow rays that nothing is in the way of. Twin: `from_sun` in `path.rs`.

@group(0) @binding(1) var<storage> found: array<u32>;
@group(0) @binding(2) var<storage> shadows: array<vec4u>;
@group(0) @binding(3) var<storage, read_write> paths: array<Path>;
@group(0) @binding(4) var<storage, read_write> counters: array<atomic<u32>>;

@compute @workgroup_size(256)
fn sunlight(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = number(group, groups, local);
    if index >= live_count() {
        return;
    }
    let shadow = shadows[index];
    let path = shadow.w;
    paths[path].rays += 1u;
    paths[path].hits += found[index];
    if found[index] == 0u {
        paths[path].light += bitcast<vec3f>(shadow.xyz);
    }
}
