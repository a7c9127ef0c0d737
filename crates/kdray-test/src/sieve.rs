//! Every triangle tried for a ray, a million times a scene: most are sifted out eight at a time.

use kdray::trace::intersect;
use kdray::{Hit, Mesh, Ray};

const LANES: usize = 8;
type Lanes = [f32; LANES];

/// The triangles of a mesh, eight by eight, by corner and axis.
pub struct Sieve<'a> {
    mesh: &'a Mesh,
    blocks: Vec<[[Lanes; 3]; 3]>,
}

/// A ray, and the shear that takes it to the z axis. In a hurry: what it lets through is decided by
/// `intersect`, so it must only not hold back too much.
struct Sheared {
    axes: [usize; 3],
    origin: [f32; 3],
    shear: [f32; 2],
}

impl Sheared {
    fn new(ray: &Ray) -> Self {
        let magnitude = ray.direction.map(f32::abs);
        let last = (0..3).max_by(|a, b| magnitude[*a].total_cmp(&magnitude[*b])).unwrap_or(2);
        let axes = [(last + 1) % 3, (last + 2) % 3, last];
        let [x, y, z] = axes.map(|axis| ray.direction[axis]);
        Self { axes, origin: axes.map(|axis| ray.origin[axis]), shear: [x / z, y / z] }
    }

    /// A bit for every triangle that the line of the ray may cross.
    #[inline(always)]
    fn may_cross(&self, block: &[[Lanes; 3]; 3]) -> u32 {
        let (a, a_size) = self.seen(&block[0]);
        let (b, b_size) = self.seen(&block[1]);
        let (c, c_size) = self.seen(&block[2]);
        let mut sides = [[0.0; LANES]; 2];
        for lane in 0..LANES {
            let edge =
                |p: &[Lanes; 2], q: &[Lanes; 2]| p[0][lane] * q[1][lane] - p[1][lane] * q[0][lane];
            let (u, v, w) = (edge(&c, &b), edge(&a, &c), edge(&b, &a));
            let size = a_size[lane].max(b_size[lane]).max(c_size[lane]);
            let margin = 1e-5 * size * size;
            sides[0][lane] = u.min(v).min(w) + margin;
            sides[1][lane] = margin - u.max(v).max(w);
        }
        let mut crossed = 0;
        for lane in 0..LANES {
            let may = (sides[0][lane] >= 0.0) | (sides[1][lane] >= 0.0);
            crossed |= u32::from(may) << lane;
        }
        crossed
    }

    /// A corner of every triangle as the ray sees it, and how large its numbers are.
    #[inline(always)]
    fn seen(&self, corner: &[Lanes; 3]) -> ([Lanes; 2], Lanes) {
        let [x, y, z] = [&corner[self.axes[0]], &corner[self.axes[1]], &corner[self.axes[2]]];
        let (mut seen, mut size) = ([[0.0; LANES]; 2], [0.0; LANES]);
        for lane in 0..LANES {
            let along = z[lane] - self.origin[2];
            let (across, up) = (x[lane] - self.origin[0], y[lane] - self.origin[1]);
            seen[0][lane] = across - self.shear[0] * along;
            seen[1][lane] = up - self.shear[1] * along;
            size[lane] = across.abs() + up.abs() + 2.0 * along.abs();
        }
        (seen, size)
    }
}

impl<'a> Sieve<'a> {
    /// A sieve for the rays through `mesh`.
    #[must_use]
    pub fn new(mesh: &'a Mesh) -> Self {
        let count = mesh.triangles().len();
        let mut blocks = vec![[[[f32::NAN; LANES]; 3]; 3]; count.div_ceil(LANES)];
        for triangle in 0..count {
            for (corner, position) in mesh.triangle(triangle).iter().enumerate() {
                for axis in 0..3 {
                    blocks[triangle / LANES][corner][axis][triangle % LANES] = position[axis];
                }
            }
        }
        Self { mesh, blocks }
    }

    /// By ray, all hits in order of `t`, then of the triangle.
    #[must_use]
    pub fn all_hits(&self, rays: &[Ray]) -> Vec<Vec<Hit>> {
        let sheared: Vec<Sheared> = rays.iter().map(Sheared::new).collect();
        let mut hits = vec![Vec::new(); rays.len()];
        for (index, block) in self.blocks.iter().enumerate() {
            for (ray, sheared) in sheared.iter().enumerate() {
                let mut lanes = sheared.may_cross(block);
                while lanes != 0 {
                    let triangle = index * LANES + lanes.trailing_zeros() as usize;
                    lanes &= lanes - 1;
                    if triangle < self.mesh.triangles().len() {
                        let corners = self.mesh.triangle(triangle);
                        hits[ray].extend(intersect(&rays[ray], triangle as u32, &corners));
                    }
                }
            }
        }
        for hits in &mut hits {
            hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        }
        hits
    }
}
