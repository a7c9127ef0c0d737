//! The connected parts of a mesh.

use glam::Vec3;
use kdray::Mesh;

/// Which part each triangle belongs to, and how large the parts are.
pub(crate) struct Components {
    /// For each triangle an index into `areas`.
    pub(crate) of_triangle: Vec<u32>,
    /// Twice the surface area of each part, in descending order.
    pub(crate) areas: Vec<f32>,
}

impl Components {
    /// Triangles that share a vertex, as `welded`, are of one part.
    pub(crate) fn new(mesh: &Mesh, welded: &[u32]) -> Self {
        let mut forest = Forest { parent: (0..welded.len() as u32).collect() };
        for triangle in mesh.triangles() {
            let [a, b, c] = triangle.map(|vertex| welded[vertex as usize]);
            forest.join(a, b);
            forest.join(b, c);
        }
        let root = |triangle: &[u32; 3]| welded[triangle[0] as usize];
        let roots: Vec<u32> = mesh.triangles().iter().map(|t| forest.root(root(t))).collect();
        Self::ranked(mesh, &roots, welded.len())
    }

    /// Numbers the parts by their area, equal ones by their first vertex.
    fn ranked(mesh: &Mesh, roots: &[u32], vertices: usize) -> Self {
        let mut area_of_root = vec![-1.0_f32; vertices];
        for (triangle, root) in roots.iter().enumerate() {
            let area = &mut area_of_root[*root as usize];
            *area = area.max(0.0) + double_area(mesh.triangle(triangle));
        }
        let is_part = |root: &u32| area_of_root[*root as usize] >= 0.0;
        let mut parts: Vec<u32> = (0..vertices as u32).filter(is_part).collect();
        parts.sort_by(|a, b| area_of_root[*b as usize].total_cmp(&area_of_root[*a as usize]));
        let mut rank = vec![0; vertices];
        for (index, root) in parts.iter().enumerate() {
            rank[*root as usize] = index as u32;
        }
        Self {
            of_triangle: roots.iter().map(|root| rank[*root as usize]).collect(),
            areas: parts.iter().map(|root| area_of_root[*root as usize]).collect(),
        }
    }
}

fn double_area(triangle: [[f32; 3]; 3]) -> f32 {
    let [a, b, c] = triangle.map(Vec3::from);
    (b - a).cross(c - a).length()
}

/// Union-find; the lowest vertex of a tree is its root.
struct Forest {
    parent: Vec<u32>,
}

impl Forest {
    fn root(&mut self, mut vertex: u32) -> u32 {
        while self.parent[vertex as usize] != vertex {
            let above = self.parent[self.parent[vertex as usize] as usize];
            self.parent[vertex as usize] = above;
            vertex = above;
        }
        vertex
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weld::weld;

    #[test]
    fn parts_are_told_apart_and_ordered_by_area() {
        let small = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let large = [[9.0; 3], [9.0, 9.0, 29.0], [9.0, 29.0, 9.0]];
        let larger_by_a_split_vertex = [[9.0, 9.0, 29.0], [29.0, 9.0, 9.0], [9.0, 29.0, 9.0]];
        let positions = [small, large, larger_by_a_split_vertex].concat();
        let triangles = [[0, 1, 2], [3, 4, 5], [6, 7, 8]];
        let mesh = Mesh::new(&positions, &triangles).expect("finite");
        let components = Components::new(&mesh, &weld(&mesh));
        assert_eq!(components.of_triangle, [1, 0, 0]);
        assert_eq!(components.areas.len(), 2);
        assert_eq!(components.areas[1], 1.0);
    }
}
