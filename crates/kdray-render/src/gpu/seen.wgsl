// A path whose camera ray met a point, or nothing but the background.

fn seen(point: Point, background: vec3f) -> Path {
    var path = Path();
    path.background = background;
    path.haze = point.haze;
    path.position = point.position;
    path.has_surface = point.kind & SURFACE;
    path.normal = point.shading;
    path.rays = 1u;
    path.albedo = point.albedo;
    path.hits = u32((point.kind & TRIANGLE) != 0u);
    path.throughput = vec3f(1.0);
    return path;
}
