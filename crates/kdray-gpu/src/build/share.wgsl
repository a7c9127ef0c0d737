// Shares the parts of a node between its children.
//
// Twin: `subtree.rs`. Whoever imports this has positions and triangles.

//#import subtree
//#import triangle

const MASK_BOTH = 2u;

// A bit a part: whether it goes left, goes right, and is clipped; two words each.
var<workgroup> masks: array<atomic<u32>, 6>;
fn clear_masks(local: u32) {
    if local < 6u {
        atomicStore(&masks[local], 0u);
    }
}

fn mask(which: u32) -> vec2u {
    return vec2u(atomicLoad(&masks[2u * which]), atomicLoad(&masks[2u * which + 1u]));
}

fn bit(index: u32) -> u32 {
    return 1u << (index % 32u);
}

fn has(mask: vec2u, index: u32) -> bool {
    return (select(mask.x, mask.y, index >= 32u) & bit(index)) != 0u;
}

fn size(mask: vec2u) -> u32 {
    return countOneBits(mask.x) + countOneBits(mask.y);
}

fn before(mask: vec2u, index: u32) -> u32 {
    let low = bit(index) - 1u;
    return size(select(vec2u(mask.x & low, 0u), vec2u(mask.x, mask.y & low), index >= 32u));
}

// Says for every part which sides of the plane it reaches.
fn route_parts(task: Task, plan: Plan, local: u32) {
    let axis = plan.what & 3u;
    let flat_side = select(LEFT, RIGHT, (plan.what & FLAT_RIGHT) != 0u);
    for (var index = local; index < task.count; index += TEAM) {
        let part = task.first + index;
        let left = select(0u, LEFT, part_bounds[6u * part + 2u * axis] < plan.position);
        let right = select(0u, RIGHT, part_bounds[6u * part + 2u * axis + 1u] > plan.position);
        let way = select(left | right, flat_side, (left | right) == 0u);
        let word = index / 32u;
        if (way & LEFT) != 0u {
            atomicOr(&masks[word], bit(index));
        }
        if (way & RIGHT) != 0u {
            atomicOr(&masks[2u + word], bit(index));
        }
        if way == (LEFT | RIGHT) {
            atomicOr(&masks[4u + word], bit(index));
        }
    }
}

// Clips the parts on both sides to both children; some of them miss one.
fn clip_straddlers(task: Task, plan: Plan, local: u32) {
    let both = mask(MASK_BOTH);
    for (var item = local; item < 2u * size(both); item += TEAM) {
        let index = nth(both, item / 2u);
        let side = item % 2u;
        load(part_triangle[task.first + index]);
        let part = part_inside(child_of(task, plan, side), params.clip == 1u);
        if part.lower.x == NONE {
            atomicAnd(&masks[2u * side + index / 32u], ~bit(index));
        }
        for (var axis = 0u; axis < 3u; axis++) {
            part_bounds[6u * (ROOM + item) + 2u * axis] = part.lower[axis];
            part_bounds[6u * (ROOM + item) + 2u * axis + 1u] = part.upper[axis];
        }
    }
}

// Where a mask has a bit that so many come before.
fn nth(mask: vec2u, rank: u32) -> u32 {
    var rest = mask;
    for (var passed = 0u; passed < rank; passed++) {
        if rest.x != 0u {
            rest.x &= rest.x - 1u;
        } else {
            rest.y &= rest.y - 1u;
        }
    }
    return select(32u + firstTrailingBit(rest.y), firstTrailingBit(rest.x), rest.x != 0u);
}

fn child_of(task: Task, plan: Plan, side: u32) -> Box {
    var child = Box(task.lower, task.upper);
    if side == 0u {
        child.upper[plan.what & 3u] = plan.position;
    } else {
        child.lower[plan.what & 3u] = plan.position;
    }
    return child;
}

// Puts the parts of the right child behind those of the node, and those of the left behind these.
fn share_parts(task: Task, local: u32) {
    let left = mask(0u);
    let right = mask(1u);
    let both = mask(MASK_BOTH);
    let first = task.first + task.count;
    if first + size(left) + size(right) > ROOM {
        return;
    }
    for (var index = local; index < task.count; index += TEAM) {
        let own = task.first + index;
        let is_left = has(left, index);
        let is_right = has(right, index);
        let to_right = first + before(right, index);
        let to = select(to_right, first + size(right) + before(left, index), is_left);
        let item = 2u * before(both, index);
        let is_cut = has(both, index);
        if is_left || is_right {
            put_part(to, own, select(own, ROOM + item + u32(!is_left), is_cut));
        }
        if is_left && is_right {
            put_part(to_right, own, ROOM + item + 1u);
        }
    }
}

// Copies a part, or what was clipped of it.
fn put_part(to: u32, own: u32, bounds: u32) {
    part_triangle[to] = part_triangle[own];
    for (var word = 0u; word < 6u; word++) {
        part_bounds[6u * to + word] = part_bounds[6u * bounds + word];
    }
}
