// The nodes of the next level, and the records of this one.
//
// Twin: `bear.rs`.

//#import bases
//#import float_pack

// Of the references of the next level. What a node has at most starts at zero.
struct Header {
    count: u32,
    parts: u32,
    most: atomic<u32>,
    most_parts: atomic<u32>,
}

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> nodes: array<Node>;
@group(0) @binding(2) var<storage> plans: array<Plan>;
@group(0) @binding(3) var<storage> pairs: array<Pair>;
@group(0) @binding(4) var<storage> exists: array<u32>;
@group(0) @binding(5) var<storage, read_write> next_nodes: array<Node>;
@group(0) @binding(6) var<storage, read_write> header: Header;
@group(0) @binding(7) var<storage, read_write> records: array<vec2u>;

@compute @workgroup_size(256)
fn bear(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    if index == 0u {
        let parts = exists[2u * params.straddlers];
        header.count = params.left + params.right + parts;
        header.parts = parts;
    }
    let node = nodes[index];
    let plan = plans[index];
    if plan.what == LEAF {
        records[params.records + index] = vec2u(plan.place, (node.count << 2u) | LEAF);
        return;
    }
    if plan.what == FINISHED {
        records[params.records + index] = vec2u(plan.place, NONE);
        return;
    }
    let axis = plan.what & 3u;
    let children = params.next_records + 2u * plan.place;
    records[params.records + index] = vec2u(f_of_key(plan.position), (children << 2u) | axis);
    let bases = bases_of(pairs[plan.place]);
    for (var side = 0u; side < 2u; side++) {
        var child = node;
        child.first = bases.references[side];
        child.count = bases.references[side + 1u] - child.first;
        child.fresh_first = bases.parts[side];
        child.fresh_count = bases.parts[side + 1u] - child.fresh_first;
        if side == 0u {
            child.upper[axis] = plan.position;
        } else {
            child.lower[axis] = plan.position;
        }
        next_nodes[2u * plan.place + side] = child;
        atomicMax(&header.most, child.count);
        atomicMax(&header.most_parts, child.fresh_count);
    }
}
