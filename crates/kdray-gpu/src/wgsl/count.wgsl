// How many elements there are, and which of them an invocation works on.
//
// A count that only the device knows is a word of the kernel's binding `counter`. For one that the
// host knows, the word is greater than any bound.
//
// A dispatch has at most 65,535 workgroups along a dimension, so larger grids fill rows of that
// many. The last row may be too long: kernels look at the count.

const WORKGROUP = 256u;
const TILE = 4096u; // Elements of a workgroup that takes 16 an invocation.

struct Count {
    bound: u32,
    at: u32,
    per: u32, // How many of them make one element: more than one where tiles are counted.
    unused: u32,
}

fn element_count(count: Count) -> u32 {
    return div_ceil(min(count.bound, counter[count.at]), count.per);
}

fn div_ceil(a: u32, b: u32) -> u32 {
    return a / b + u32(a % b != 0u);
}

// Number of a workgroup, row after row.
fn group_index(group: vec3u, groups: vec3u) -> u32 {
    return group.y * groups.x + group.x;
}
