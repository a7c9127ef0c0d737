// From one node of a subtree to the next.
//
// Twin: `subtree.rs`. Every invocation of a team does the same.

//#import share

// Notes the node down and goes on with its left child; after a leaf, with the last that waits.
fn advance(task: Task, plan: Plan, local: u32) {
    if plan.what == LEAF {
        finish_leaf(task, local);
    } else {
        finish_inner(task, plan, local);
    }
    // Children without parts are leaves, and need no team.
    for (var passed = 0u; passed <= WAITING + 1u; passed++) {
        if stand != BUSY || current.count > 0u {
            return;
        }
        finish_leaf(current, local);
    }
}

fn finish_inner(task: Task, plan: Plan, local: u32) {
    var counts = vec2u(task.count);
    var firsts = vec2u(task.first);
    is_counted = (plan.what & EMPTY) != 0u;
    if is_counted {
        // All parts stay where they are.
        counts *= vec2u((vec2u(plan.what) & vec2u(EMPTY_LEFT, EMPTY_RIGHT)) == vec2u(0u));
    } else {
        counts = vec2u(size(mask(0u)), size(mask(1u)));
        firsts += task.count;
        firsts.x += counts.y;
    }
    stand = IDLE;
    if firsts.y + counts.x + counts.y > ROOM || waiting_count == WAITING {
        return;
    }
    let place = put_node(task.parent, vec2u(f_of_key(plan.position), plan.what & 3u), local);
    if place == NONE {
        return;
    }
    stand = BUSY;
    let left = child_of(task, plan, 0u);
    let right = child_of(task, plan, 1u);
    let depth = task.depth - 1u;
    let right_child = Task(right.lower, firsts.y, right.upper, counts.y, place, depth);
    if counts.x > 0u {
        park(right_child, local);
        current = Task(left.lower, firsts.x, left.upper, counts.x, NONE, depth);
    } else if put_node(NONE, vec2u(piece.references, LEAF), local) == NONE {
        stand = IDLE;
    } else {
        current = right_child;
    }
}

fn finish_leaf(task: Task, local: u32) {
    let leaf = vec2u(piece.references, (task.count << 2u) | LEAF);
    is_counted = false;
    stand = IDLE;
    if put_node(task.parent, leaf, local) == NONE
        || piece.references + task.count > most_references(piece.room) {
        return;
    }
    piece.references += task.count;
    if waiting_count == 0u {
        stand = DONE;
        return;
    }
    current = unpark();
    stand = BUSY;
}
