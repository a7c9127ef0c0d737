// Values of one to three words, one after the other, whose first word counts most.

@group(0) @binding(2) var<storage> words: array<u32>;

fn value_of(i: u32) -> vec3u {
    let at = i * params.width;
    var value = vec3u(words[at], 0u, 0u);
    if params.width > 1u {
        value.y = words[at + 1u];
    }
    if params.width > 2u {
        value.z = words[at + 2u];
    }
    return value;
}
