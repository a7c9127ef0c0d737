//! The cells of a tree, drawn over a picture.

use glam::Vec3;
use kdray::tree::Kind;
use kdray::{Aabb, Ray, Tracer, Tree};
use kdray_render::{Camera, Picture};

/// The depth of the smallest cells that are drawn: below, there are more than a picture can show.
pub const DEEPEST: u32 = 14;

/// Edges that can be seen, and those behind a surface.
const INK: [[u8; 3]; 2] = [[255, 196, 0], [40, 90, 160]];

/// How much of the ink they have.
const COVER: [f32; 2] = [0.85, 0.25];

/// How much nearer than its surface an edge may be behind it, as a part of the distance.
const SLACK: f32 = 1e-3;

/// The boxes of the nodes at `depth`, and of the leaves above.
pub(crate) fn of(tree: &Tree, depth: u32) -> Vec<Aabb> {
    let mut cells = Vec::new();
    let mut stack = vec![(0, tree.bounds(), 0)];
    while let Some((index, bounds, level)) = stack.pop() {
        match tree.nodes()[index].kind() {
            Kind::Inner { axis, position, right } if level < depth.min(DEEPEST) => {
                let (mut below, mut above) = (bounds, bounds);
                below.upper[axis] = position;
                above.lower[axis] = position;
                stack.push((right, above, level + 1));
                stack.push((index + 1, below, level + 1));
            }
            _ => cells.push(bounds),
        }
    }
    cells
}

/// Draws the edges of boxes; those behind a surface are faint.
pub(crate) fn draw(picture: &mut Picture, camera: &Camera, tracer: &Tracer, cells: &[Aabb]) {
    let mut drawing = Drawing::new(picture, camera, tracer);
    for cell in cells {
        for [from, to] in edges(cell) {
            drawing.edge(from, to);
        }
    }
    drawing.ink();
}

/// The twelve edges of a box.
fn edges(bounds: &Aabb) -> impl Iterator<Item = [Vec3; 2]> {
    let ends = [bounds.lower, bounds.upper];
    let corner = move |corner: usize| {
        Vec3::from([0, 1, 2].map(|axis: usize| ends[corner >> axis & 1][axis]))
    };
    let starts = move |axis: usize| (0..8).filter(move |corner| corner >> axis & 1 == 0);
    (0..3).flat_map(move |axis| {
        starts(axis).map(move |from| [corner(from), corner(from | (1 << axis))])
    })
}

/// What is known of a pixel's edges.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Mark {
    None,
    Hidden,
    Seen,
}

struct Drawing<'a> {
    picture: &'a mut Picture,
    camera: &'a Camera,
    tracer: &'a Tracer,
    marks: Vec<Mark>,
}

impl<'a> Drawing<'a> {
    fn new(picture: &'a mut Picture, camera: &'a Camera, tracer: &'a Tracer) -> Self {
        let marks = vec![Mark::None; picture.pixels.len()];
        Self { picture, camera, tracer, marks }
    }

    /// Marks the pixels of a straight edge.
    fn edge(&mut self, from: Vec3, to: Vec3) {
        let size = [self.picture.width as f32, self.picture.height as f32];
        let aspect = size[0] / size[1];
        let place = |point: Vec3| self.camera.project(point.to_array(), aspect);
        let Some([from, to]) = self.in_front(from, to) else { return };
        let [Some((start, near)), Some((end, far))] = [place(from), place(to)] else { return };
        let pixel = |[x, y]: [f32; 2]| [0.5 * (x + 1.0) * size[0], 0.5 * (1.0 - y) * size[1]];
        let [start, end] = [pixel(start), pixel(end)];
        let length = (end[0] - start[0]).abs().max((end[1] - start[1]).abs());
        let steps = length.ceil().clamp(1.0, 8.0 * (size[0] + size[1])) as u32;
        for step in 0..=steps {
            let s = step as f32 / steps as f32;
            let [x, y] = [0, 1].map(|axis| start[axis] + s * (end[axis] - start[axis]));
            // Equal steps on the picture are no equal steps along the edge.
            let along = s * near / (s * near + (1.0 - s) * far);
            self.mark(x, y, from + along * (to - from));
        }
    }

    /// The part of an edge before the eye.
    fn in_front(&self, from: Vec3, to: Vec3) -> Option<[Vec3; 2]> {
        let eye = Vec3::from(self.camera.eye);
        let forward = (Vec3::from(self.camera.target) - eye).try_normalize()?;
        let least = 1e-3 * Vec3::from(self.camera.target).distance(eye);
        let [a, b] = [from, to].map(|point| (point - eye).dot(forward) - least);
        match (a > 0.0, b > 0.0) {
            (true, true) => Some([from, to]),
            (false, false) => None,
            (true, false) => Some([from, from + a / (a - b) * (to - from)]),
            (false, true) => Some([to + b / (b - a) * (from - to), to]),
        }
    }

    fn mark(&mut self, x: f32, y: f32, point: Vec3) {
        let [width, height] = [self.picture.width as f32, self.picture.height as f32];
        if !(0.0..width).contains(&x) || !(0.0..height).contains(&y) {
            return;
        }
        let index = y as usize * self.picture.width as usize + x as usize;
        if self.marks[index] == Mark::Seen {
            return;
        }
        let way = point - Vec3::from(self.camera.eye);
        let ray = Ray { t_max: 1.0 - SLACK, ..Ray::new(self.camera.eye, way.to_array()) };
        let mark = if self.tracer.any_hit(&ray) { Mark::Hidden } else { Mark::Seen };
        if mark > self.marks[index] {
            self.marks[index] = mark;
        }
    }

    fn ink(self) {
        for (pixel, mark) in self.picture.pixels.iter_mut().zip(self.marks) {
            let kind = match mark {
                Mark::None => continue,
                Mark::Seen => 0,
                Mark::Hidden => 1,
            };
            for (channel, ink) in pixel.iter_mut().zip(INK[kind]) {
                let mixed =
                    COVER[kind] * f32::from(ink) + (1.0 - COVER[kind]) * f32::from(*channel);
                *channel = mixed.round() as u8;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kdray::{BuildOptions, Mesh};

    fn two_walls() -> (Mesh, Tree) {
        let wall = |z: f32| [[-1.0, -1.0, z], [1.0, -1.0, z], [0.0, 1.0, z]];
        let positions = [wall(0.0), wall(1.0)].concat();
        let mesh = Mesh::new(&positions, &[[0, 1, 2], [3, 4, 5]]).expect("finite");
        let cost = kdray::Cost { traversal: 1e-3, ..kdray::Cost::default() };
        let options = BuildOptions { cost, ..BuildOptions::default() };
        let tree = Tree::build(&mesh, &options).expect("built");
        (mesh, tree)
    }

    #[test]
    fn cells_fill_the_root_at_every_depth() {
        let (_, tree) = two_walls();
        let volume = |bounds: &Aabb| bounds.extent().iter().product::<f32>();
        assert_eq!(of(&tree, 0), [tree.bounds()]);
        let mut last = 0;
        for depth in 0..6 {
            let cells = of(&tree, depth);
            let filled: f32 = cells.iter().map(volume).sum();
            assert!((filled - volume(&tree.bounds())).abs() < 1e-5, "{depth}");
            assert!(cells.len() >= last);
            last = cells.len();
        }
    }

    #[test]
    fn edges_in_sight_are_strong_and_those_behind_are_faint() {
        let (mesh, tree) = two_walls();
        let tracer = Tracer::new(&mesh, &tree);
        let camera = Camera { eye: [0.0, 0.0, 5.0], target: [0.0; 3], up: Camera::Y_UP, fov: 40.0 };
        let pixels = vec![[0; 3]; 64 * 64];
        let mut picture = Picture { width: 64, height: 64, pixels, rays: 0, hits: 0 };
        // Behind the front wall, and larger than it.
        let cell = Aabb { lower: [-1.5, -0.2, 0.5], upper: [1.5, -0.2, 0.5] };
        draw(&mut picture, &camera, &tracer, &[cell]);
        let inked: Vec<[u8; 3]> =
            picture.pixels.iter().copied().filter(|pixel| *pixel != [0; 3]).collect();
        let seen = inked.iter().filter(|pixel| pixel[0] > pixel[2]).count();
        assert!(seen > 10 && inked.len() - seen > 10, "{seen} of {}", inked.len());
    }

    #[test]
    fn edges_behind_the_eye_and_through_it_do_no_harm() {
        let (mesh, tree) = two_walls();
        let tracer = Tracer::new(&mesh, &tree);
        let camera =
            Camera { eye: [0.0; 3], target: [0.0, 0.0, -1.0], up: Camera::Y_UP, fov: 90.0 };
        let mut picture =
            Picture { width: 9, height: 9, pixels: vec![[0; 3]; 81], rays: 0, hits: 0 };
        draw(&mut picture, &camera, &tracer, &[Aabb { lower: [-9.0; 3], upper: [9.0; 3] }]);
        draw(&mut picture, &camera, &tracer, &[Aabb { lower: [0.0; 3], upper: [0.0; 3] }]);
    }
}
