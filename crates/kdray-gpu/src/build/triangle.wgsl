// The corners of a triangle, as the polygon that is clipped.
//
// Whoever imports this has positions and triangles.

//#import polygon

fn load(triangle: u32) {
    for (var corner = 0u; corner < 3u; corner++) {
        let vertex = 3u * triangles[3u * triangle + corner];
        corners[corner] = vec3u(positions[vertex], positions[vertex + 1u], positions[vertex + 2u]);
    }
    corner_count = 3u;
}
