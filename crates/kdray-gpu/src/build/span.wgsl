// Where a reference starts and ends along an axis: by its bounds, or, in the root, whose references
// are all triangles, by its triangle.
//
// Twin: `span` in `ends.rs`. Whoever imports this has the parameters, positions, triangles and bounds.

//#import level
//#import float_pack

fn span(reference: u32, axis: u32) -> vec2u {
    if params.has_bounds == 1u {
        return vec2u(bounds[reference].lower[axis], bounds[reference].upper[axis]);
    }
    var span = vec2u(NONE, 0u);
    for (var corner = 0u; corner < 3u; corner++) {
        let position = f_key(positions[3u * triangles[3u * reference + corner] + axis]);
        span = vec2u(min(span.x, position), max(span.y, position));
    }
    return span;
}
