// Where a triangle starts and ends along an axis.
//
// Twin: `span` in `root.rs`. Whoever imports this has positions and triangles.

//#import level
//#import float_pack

fn span(triangle: u32, axis: u32) -> vec2u {
    var span = vec2u(NONE, 0u);
    for (var corner = 0u; corner < 3u; corner++) {
        let position = f_key(positions[3u * triangles[3u * triangle + corner] + axis]);
        span = vec2u(min(span.x, position), max(span.y, position));
    }
    return span;
}
