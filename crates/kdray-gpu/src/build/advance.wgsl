// From one node of a subtree to the next.
//
// Twin: `subtree.rs`. Runs in one invocation of a team.

//#import share

// Notes the node down and goes on with its left child; after a leaf, with the last that waits.
fn advance(task: Task, plan: Plan) {
    if plan.what == LEAF {
        finish_leaf(task);
    } else {
        finish_inner(task, plan);
    }
    // Children without parts are leaves, and need no team.
    for (var passed = 0u; passed <= WAITING + 1u; passed++) {
        if state != BUSY || current.count > 0u {
            return;
        }
        finish_leaf(current);
    }
}

fn finish_inner(task: Task, plan: Plan) {
    let left_count = size(mask(0u));
    let right_count = size(mask(1u));
    let first = task.first + task.count;
    state = IDLE;
    if first + left_count + right_count > ROOM || waiting_count == WAITING {
        return;
    }
    let place = put_node(task, vec2u(f_of_key(plan.position), plan.what & 3u));
    if place == NONE {
        return;
    }
    let left = child_of(task, plan, 0u);
    let right = child_of(task, plan, 1u);
    let depth = task.depth - 1u;
    waiting[waiting_count] = Task(right.lower, first, right.upper, right_count, place, depth);
    waiting_count++;
    current = Task(left.lower, first + right_count, left.upper, left_count, NONE, depth);
    state = BUSY;
}

fn finish_leaf(task: Task) {
    let leaf = vec2u(piece.references, (task.count << 2u) | LEAF);
    state = IDLE;
    if put_node(task, leaf) == NONE
        || piece.references + task.count > most_references(piece.room) {
        return;
    }
    piece.references += task.count;
    if waiting_count == 0u {
        state = DONE;
        return;
    }
    waiting_count--;
    current = waiting[waiting_count];
    state = BUSY;
}
