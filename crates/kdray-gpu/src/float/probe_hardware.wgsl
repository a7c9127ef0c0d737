// Try the hardware form of the part `float`.

//#import float_pack
//#import float_hardware
//#import float_hardware_div
//#import float_probe

@compute @workgroup_size(256)
fn probe_hardware(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) invocation: u32,
) {
    probe(group, groups, invocation);
}
