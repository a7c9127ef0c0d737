// The references of the next level, and under which name each of this level's goes on.
//
// Twin: `name.rs`.

//#import route
//#import bases

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> references: References;
@group(0) @binding(2) var<storage> plans: array<Plan>;
@group(0) @binding(3) var<storage> pairs: array<Pair>;
@group(0) @binding(4) var<storage> exists: array<u32>;
@group(0) @binding(5) var<storage> sums: array<u32>;
@group(0) @binding(6) var<storage, read_write> marks: array<u32>;
@group(0) @binding(7) var<storage, read_write> next_references: References;
@group(0) @binding(8) var<storage, read_write> places: array<vec2u>;

@compute @workgroup_size(256)
fn name(
    @builtin(workgroup_id) group: vec3u,
    @builtin(num_workgroups) groups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = invocation(group, groups, local);
    if index >= params.count {
        return;
    }
    let end = min((index + 1u) * CHUNK, references.count);
    var ranks =
        Ranks(before(WAY_BOTH, index), before(WAY_LEFT, index), before(WAY_RIGHT, index));
    for (var place = index * CHUNK; place < end; place++) {
        let reference = references.list[place];
        let plan = plans[reference.slot];
        let way = route(plan.what, marks[place]);
        marks[place] = NONE;
        if way >= WAY_LEAF {
            continue;
        }
        let parts = parts_before(ranks.straddlers);
        let names = names_of(pairs[plan.place], ranks, parts);
        let left = Reference(reference.triangle, 2u * plan.place);
        let right = Reference(reference.triangle, 2u * plan.place + 1u);
        if way == WAY_LEFT {
            next_references.list[names.x] = left;
            marks[place] = names.x;
        } else if way == WAY_RIGHT {
            next_references.list[names.y] = right;
            marks[place] = names.y | TO_RIGHT;
        } else {
            let is_there = parts_before(ranks.straddlers + 1u) > parts;
            if is_there.x {
                next_references.list[names.x] = left;
            }
            if is_there.y {
                next_references.list[names.y] = right;
            }
            places[ranks.straddlers] = select(vec2u(NONE), names, is_there);
        }
        ranks.straddlers += u32(way == WAY_BOTH);
        ranks.left += u32(way == WAY_LEFT);
        ranks.right += u32(way == WAY_RIGHT);
    }
}

// The places in both children of the next of a node's references.
fn names_of(pair: Pair, ranks: Ranks, parts: vec2u) -> vec2u {
    let kept = vec2u(ranks.left - pair.start.left, ranks.right - pair.start.right);
    let fresh = parts - parts_before(pair.start.straddlers);
    return bases_of(pair).references.xy + kept + fresh;
}
