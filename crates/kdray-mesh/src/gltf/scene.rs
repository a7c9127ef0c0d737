//! The default scene as one mesh.

use std::collections::HashMap;

use super::accessor::Accessors;
use super::pose::{Deformation, Pose};
use super::schema::{Primitive, Root};
use super::transform::Transform;
use crate::Loaded;
use crate::error::{LoadError, Place, Reason};
use crate::loaded::check_vertex_count;

/// The triangles of the default scene; without a scene, of all nodes; without nodes, of all meshes.
/// With a pose, skins and morph targets are as it says.
pub(super) fn flatten(accessors: Accessors, pose: Option<&Pose>) -> Result<Loaded, LoadError> {
    let root = accessors.root;
    let (loaded, left_out) = (Loaded::default(), LeftOut::default());
    let mut flat = Flat { accessors, pose, loaded, left_out };
    check_transforms(root)?;
    if root.nodes.is_empty() {
        for mesh in 0..root.meshes.len() {
            flat.mesh(mesh, &Transform::IDENTITY, None)?;
        }
    } else {
        flat.nodes(root_nodes(root)?)?;
    }
    flat.left_out.note(&mut flat.loaded.notes);
    Ok(flat.loaded)
}

/// Checks every node, whether it is in the scene or not.
fn check_transforms(root: &Root) -> Result<(), LoadError> {
    for (index, node) in root.nodes.iter().enumerate() {
        Transform::of_node(node).map_err(|reason| node_error(index, reason))?;
    }
    Ok(())
}

/// The nodes to start from.
fn root_nodes(root: &Root) -> Result<Vec<usize>, LoadError> {
    let index = root.scene.unwrap_or(0);
    match root.scenes.get(index) {
        Some(scene) => Ok(scene.nodes.clone()),
        None if root.scene.is_some() => Err(LoadError::malformed(
            Place::item(format!("scene {index}")),
            "there is no such scene",
        )),
        None => {
            let mut is_child = vec![false; root.nodes.len()];
            for &child in root.nodes.iter().flat_map(|node| &node.children) {
                if let Some(is_child) = is_child.get_mut(child) {
                    *is_child = true;
                }
            }
            Ok((0..root.nodes.len()).filter(|&node| !is_child[node]).collect())
        }
    }
}

fn node_error(index: usize, reason: &str) -> LoadError {
    LoadError::malformed(Place::item(format!("node {index}")), reason)
}

/// What has no triangles at rest.
#[derive(Default)]
struct LeftOut {
    lines_and_points: usize,
    corners: usize,
    morphs: usize,
    skins: usize,
}

impl LeftOut {
    fn note(&self, notes: &mut Vec<String>) {
        let mut note = |count: usize, what: &str| {
            if count > 0 {
                notes.push(format!("{count} {what}"));
            }
        };
        note(self.lines_and_points, "primitives of points or lines left out");
        note(self.corners, "corners beyond the last whole triangle left out");
        note(self.morphs, "primitives with morph targets taken at rest");
        note(self.skins, "skinned meshes taken at rest");
    }
}

/// The scene so far.
struct Flat<'a> {
    accessors: Accessors<'a>,
    pose: Option<&'a Pose>,
    loaded: Loaded,
    left_out: LeftOut,
}

impl Flat<'_> {
    /// Walks the tree of nodes, parents first.
    fn nodes(&mut self, roots: Vec<usize>) -> Result<(), LoadError> {
        let nodes = &self.accessors.root.nodes;
        let mut visited = vec![false; nodes.len()];
        let start = roots.into_iter().rev().map(|index| (index, Transform::IDENTITY));
        let mut stack: Vec<(usize, Transform)> = start.collect();
        while let Some((index, parent)) = stack.pop() {
            let node =
                nodes.get(index).ok_or_else(|| node_error(index, "there is no such node"))?;
            if std::mem::replace(&mut visited[index], true) {
                return Err(node_error(index, "it is in the scene twice, or its own ancestor"));
            }
            let local = match self.pose {
                Some(pose) => pose.locals[index],
                None => Transform::of_node(node).map_err(|reason| node_error(index, reason))?,
            };
            let transform = parent.after(&local);
            if let Some(mesh) = node.mesh {
                self.node_mesh(index, mesh, &transform)?;
            }
            stack.extend(node.children.iter().rev().map(|&child| (child, transform)));
        }
        Ok(())
    }

    /// Adds the mesh of a node.
    fn node_mesh(
        &mut self,
        index: usize,
        mesh: usize,
        transform: &Transform,
    ) -> Result<(), LoadError> {
        let node = &self.accessors.root.nodes[index];
        let Some(pose) = self.pose else {
            self.left_out.skins += usize::from(node.skin.is_some());
            return self.mesh(mesh, transform, None);
        };
        let deformation = pose.deformation(index, node, &self.accessors)?;
        let of_joints = deformation.is_skinned();
        let transform = if of_joints { &Transform::IDENTITY } else { transform };
        self.mesh(mesh, transform, Some(&deformation))
    }

    /// Adds a mesh. Primitives that share their positions share their vertices, unless they are
    /// deformed.
    fn mesh(
        &mut self,
        index: usize,
        transform: &Transform,
        deformation: Option<&Deformation>,
    ) -> Result<(), LoadError> {
        let place = || Place::item(format!("mesh {index}"));
        let missing = || LoadError::malformed(place(), "there is no such mesh");
        let mesh = self.accessors.root.meshes.get(index).ok_or_else(missing)?;
        let mut known = HashMap::new();
        for (number, primitive) in mesh.primitives.iter().enumerate() {
            let item = format!("mesh {index}, primitive {number}");
            if deformation.is_some() {
                known.clear();
            }
            self.primitive(primitive, (transform, deformation), &item, &mut known)?;
        }
        Ok(())
    }

    fn primitive(
        &mut self,
        primitive: &Primitive,
        (transform, deformation): (&Transform, Option<&Deformation>),
        item: &str,
        known: &mut HashMap<usize, Vertices>,
    ) -> Result<(), LoadError> {
        let place = || Place::item(item);
        match primitive.mode {
            0..4 => {
                self.left_out.lines_and_points += 1;
                return Ok(());
            }
            4..7 => {}
            mode => {
                return Err(LoadError::malformed(place(), format!("{mode} is not a mode")));
            }
        }
        let is_at_rest = deformation.is_none() && !primitive.targets.is_empty();
        self.left_out.morphs += usize::from(is_at_rest);
        let Some(position) = primitive.attributes.position else {
            return Err(LoadError::malformed(place(), "it has no positions"));
        };
        let vertices = match known.get(&position) {
            Some(vertices) => *vertices,
            None => {
                let mut positions = self.accessors.positions(position)?;
                if let Some(deformation) = deformation {
                    deformation.apply(&mut positions, primitive, &self.accessors)?;
                }
                *known.entry(position).or_insert(self.vertices(&positions, transform)?)
            }
        };
        let corners = match primitive.indices {
            Some(indices) => self.accessors.indices(indices)?,
            None => (0..vertices.count).collect(),
        };
        self.triangles(primitive.mode, &corners, vertices, transform.mirrors(), item)
    }

    /// Adds vertices, moved to their place.
    fn vertices(
        &mut self,
        positions: &[[f64; 3]],
        transform: &Transform,
    ) -> Result<Vertices, LoadError> {
        let first = self.loaded.positions.len();
        check_vertex_count(first + positions.len())?;
        self.loaded.positions.extend(positions.iter().map(|&position| transform.apply(position)));
        Ok(Vertices { first: first as u32, count: positions.len() as u32 })
    }

    fn triangles(
        &mut self,
        mode: u32,
        corners: &[u32],
        vertices: Vertices,
        is_mirrored: bool,
        item: &str,
    ) -> Result<(), LoadError> {
        if let Some(bad) = corners.iter().position(|&corner| corner >= vertices.count) {
            let place = Place::item(format!("{item}, corner {bad}"));
            let (index, vertices) = (corners[bad].into(), vertices.count as usize);
            return Err(LoadError::new(place, Reason::IndexOutOfRange { index, vertices }));
        }
        let (count, surplus) = match (mode, corners.len()) {
            (4, corners) => (corners / 3, corners % 3),
            (_, corners @ 0..3) => (0, corners),
            (_, corners) => (corners - 2, 0),
        };
        self.left_out.corners += surplus;
        self.loaded.triangles.extend((0..count).map(|k| {
            let [a, b, c] = match mode {
                4 => [3 * k, 3 * k + 1, 3 * k + 2],
                5 => [k, k + 1 + k % 2, k + 2 - k % 2],
                _ => [k + 1, k + 2, 0],
            };
            let [a, b, c] = [a, b, c].map(|corner| corners[corner] + vertices.first);
            if is_mirrored { [a, c, b] } else { [a, b, c] }
        }));
        Ok(())
    }
}

/// Vertices of the scene that came from one accessor.
#[derive(Clone, Copy)]
struct Vertices {
    first: u32,
    count: u32,
}
