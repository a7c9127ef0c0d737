//! Queries answered by trying every triangle.

use kdray::trace::intersect;
use kdray::{Hit, Mesh, Ray};

/// Every hit of the ray, by triangle.
pub fn hits<'a>(mesh: &'a Mesh, ray: &'a Ray) -> impl Iterator<Item = Hit> + 'a {
    (0..mesh.triangles().len())
        .filter_map(|triangle| intersect(ray, triangle as u32, &mesh.triangle(triangle)))
}

/// The hit with the lowest `t`; of several the one of the lowest triangle.
#[must_use]
pub fn closest_hit(mesh: &Mesh, ray: &Ray) -> Option<Hit> {
    hits(mesh, ray).reduce(|best, hit| if hit.t < best.t { hit } else { best })
}

/// Whether there is any hit.
#[must_use]
pub fn any_hit(mesh: &Mesh, ray: &Ray) -> bool {
    hits(mesh, ray).next().is_some()
}
