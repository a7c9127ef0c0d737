// Workgroups that work on one element each.
//
// Twin: `TEAM` in `kernel.rs`.

//#import level

const TEAM = 8u; // Invocations of a workgroup.

// Number of a team, row after row.
fn team(group: vec3u, groups: vec3u) -> u32 {
    return group.y * groups.x + group.x;
}
