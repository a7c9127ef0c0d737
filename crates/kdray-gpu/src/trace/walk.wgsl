// The leaves along a ray, front to back, with a short stack [HSHH07].
//
// The stack keeps the last subtrees that are to be visited, and forgets the first when it is full.
// What was forgotten is found again from the root: subtrees are ranges of indices, so the index of
// what was visited last says at each node which child it was in.
// Whoever imports this has `nodes`.

//#import ray

const STACK = 16u;
const LEAF = 3u;
const NOWHERE = 0xffffffffu;

// A subtree to be visited, and between which times the ray is in it.
struct Visit {
    node: u32,
    enter: u32,
    leave: u32,
}

var<private> stack: array<Visit, STACK>;
var<private> top: u32; // Where the next one goes; places are taken in turn.
var<private> height: u32;
var<private> has_forgotten: bool;

var<private> here: Visit;
var<private> root: Visit;
var<private> visited: u32; // What was visited last; everything before it was too.
var<private> sought: u32; // What is on the way to `visited`, from the root; or nowhere.

// Key up to which there is more to see.
var<private> until: u32;

// The leaf that the ray is in.
var<private> leaf: Visit;
var<private> leaf_first: u32;
var<private> leaf_count: u32;
var<private> step_count: u32;

// Puts the ray at the root.
fn begin() {
    prepare_slabs();
    root = Visit(0u, t_first, t_last);
    for (var axis = 0u; axis < 3u; axis++) {
        let is_backward = (slabs[axis].inverse & F_SIGN) != 0u;
        let near = select(params.lower[axis], params.upper[axis], is_backward);
        let far = select(params.upper[axis], params.lower[axis], is_backward);
        root.enter = max(root.enter, passing(axis, near).x);
        root.leave = min(root.leave, passing(axis, far).y);
    }
    until = t_last;
    here = root;
    here.node = select(NOWHERE, 0u, root.enter <= root.leave);
    sought = NOWHERE;
    visited = 0u;
    top = 0u;
    height = 0u;
    has_forgotten = false;
    step_count = 0u;
}

fn push(visit: Visit) {
    stack[top % STACK] = visit;
    top++;
    has_forgotten = has_forgotten || height == STACK;
    height = min(height + 1u, STACK);
}

// Goes to the subtree that is next. Gives whether there is one.
fn pop() -> bool {
    for (; height > 0u; ) {
        top--;
        height--;
        here = stack[top % STACK];
        if here.enter <= until {
            return true;
        }
        visited = here.node;
    }
    if has_forgotten {
        has_forgotten = false;
        here = root;
        sought = visited;
    }
    return sought != NOWHERE;
}

// Goes to the next leaf that has triangles. Gives whether there is one.
fn next_leaf() -> bool {
    for (var turn = 0u; turn < NONE; turn++) {
        if here.node == NOWHERE && !pop() {
            return false;
        }
        let node = nodes[here.node];
        step_count++;
        if here.node == sought {
            sought = NOWHERE;
            here.node = NOWHERE;
        } else if (node.y & 3u) != LEAF {
            descend(node);
        } else {
            leaf = here;
            leaf_first = node.x;
            leaf_count = node.y >> 2u;
            visited = here.node;
            here.node = NOWHERE;
            if leaf_count > 0u {
                return true;
            }
        }
    }
    return false;
}

// Goes to a child that the ray meets; the other one, if it is met later, goes on the stack.
fn descend(node: vec2u) {
    let axis = node.y & 3u;
    let right = node.y >> 2u;
    let is_backward = (slabs[axis].inverse & F_SIGN) != 0u;
    let between = passing(axis, node.x);
    let far = Visit(select(right, here.node + 1u, is_backward), max(here.enter, between.x), here.leave);
    let is_far_met = far.enter <= min(far.leave, until);
    var is_near_met = here.enter <= between.y;
    if sought != NOWHERE {
        is_near_met = (sought >= right) == is_backward;
    }
    if is_near_met {
        if is_far_met {
            push(far);
        }
        here.leave = min(here.leave, between.y);
        here.node = select(here.node + 1u, right, is_backward);
    } else if is_far_met || sought != NOWHERE {
        here = far;
    } else {
        visited = here.node;
        here.node = NOWHERE;
    }
}
