// The straddlers in one list, the references of leaves in another, and the counts where inner nodes
// start and end.
//
// Twin: `gather.rs`.

//#import route

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage> references: References;
@group(0) @binding(2) var<storage> nodes: array<Node>;
@group(0) @binding(3) var<storage> marks: array<u32>;
@group(0) @binding(4) var<storage> sums: array<u32>;
@group(0) @binding(5) var<storage, read_write> plans: array<Plan>;
@group(0) @binding(6) var<storage, read_write> pairs: array<Pair>;
@group(0) @binding(7) var<storage, read_write> straddlers: array<u32>;
@group(0) @binding(8) var<storage, read_write> finished: array<u32>;

@compute @workgroup_size(256)
fn gather(
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
    var leaf = params.finished + before(WAY_LEAF, index);
    for (var place = index * CHUNK; place < end; place++) {
        let reference = references.list[place];
        let slot = reference.slot;
        let first = nodes[slot].first;
        let way = route(plans[slot].what, marks[place]);
        if way == WAY_FINISHED {
            continue;
        }
        if way == WAY_LEAF {
            if place == first {
                plans[slot].place = leaf;
            }
            finished[leaf] = reference.triangle;
            leaf++;
            continue;
        }
        let pair = plans[slot].place;
        if place == first {
            pairs[pair].start = ranks;
        }
        if way == WAY_BOTH {
            straddlers[ranks.straddlers] = place;
        }
        ranks.straddlers += u32(way == WAY_BOTH);
        ranks.left += u32(way == WAY_LEFT);
        ranks.right += u32(way == WAY_RIGHT);
        if place == first + nodes[slot].count - 1u {
            pairs[pair].end = ranks;
        }
    }
}
