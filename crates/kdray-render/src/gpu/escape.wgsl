// The light of the sky on paths whose last reflection meets nothing. Twin: `arriving` in `path.rs`.

@group(0) @binding(1) var<storage> found: array<u32>;
@group(0) @binding(2) var<storage> rays: array<Ray>;
@group(0) @binding(3) var<storage> ids: array<u32>;
@group(0) @binding(4) var<storage, read_write> paths: array<Path>;
@group(0) @binding(5) var<storage, read_write> counters: array<atomic<u32>>;

@compute @workgroup_size(256)
fn escape(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = number(group, groups, local);
    if index >= live_count() {
        return;
    }
    let path = ids[index];
    paths[path].rays += 1u;
    paths[path].hits += found[index];
    let ray = rays[index];
    if found[index] == 0u && ground_distance(ray) < 0.0 {
        paths[path].light += paths[path].throughput * radiance(ray.direction);
    }
}
