// Queues of rays and how long they are. Whoever imports this has `counters`.

fn take_place(counter: u32) -> u32 {
    return atomicAdd(&counters[counter], 1u);
}

fn live_count() -> u32 {
    if params.at == NONE {
        return params.bound;
    }
    return min(params.bound, atomicLoad(&counters[params.at]));
}
