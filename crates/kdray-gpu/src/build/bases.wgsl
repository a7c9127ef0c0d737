// Where children have their references and new parts.
//
// Twin: `bases` in `bear.rs`. Whoever imports this has the parameters and what parts there are.

//#import level

// Left, right and the end.
struct Bases {
    references: vec3u,
    parts: vec3u,
}

fn bases_of(pair: Pair) -> Bases {
    let start = parts_before(pair.start.straddlers);
    let end = parts_before(pair.end.straddlers);
    let parts = vec3u(start.x + start.y, end.x + start.y, end.x + end.y);
    let left = vec3u(pair.start.left, pair.end.left, pair.end.left);
    let right = vec3u(pair.start.right, pair.start.right, pair.end.right);
    return Bases(left + right + parts, parts);
}

// How many parts on each side the first `straddlers` of the level have.
fn parts_before(straddlers: u32) -> vec2u {
    let right = exists[params.straddlers + straddlers] - exists[params.straddlers];
    return vec2u(exists[straddlers], right);
}
