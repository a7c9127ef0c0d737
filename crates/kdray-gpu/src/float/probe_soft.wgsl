// Try the soft form of the part `float`.

//#import float_pack
//#import float_soft
//#import float_soft_div
//#import float_probe

@compute @workgroup_size(256)
fn probe_soft(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) invocation: u32,
) {
    probe(group, groups, invocation);
}
