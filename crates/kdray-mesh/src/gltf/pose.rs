//! Where everything is at one time of an animation: nodes, and the vertices that skins and morph
//! targets move.

use super::accessor::Accessors;
use super::animation::Player;
use super::schema::{Attributes, Node, Primitive};
use super::transform::Transform;
use crate::error::{LoadError, Place};

/// Nodes at one time.
pub(super) struct Pose {
    /// By node, over its parent.
    pub(super) locals: Vec<Transform>,
    /// By node, over the scene.
    globals: Vec<Transform>,
    /// By node: the weights of its morph targets, if an animation sets them.
    weights: Vec<Option<Vec<f64>>>,
}

impl Pose {
    pub(super) fn new(
        player: &Player,
        accessors: &Accessors,
        time: f64,
    ) -> Result<Self, LoadError> {
        let moved = player.at(time)?;
        let nodes = &accessors.root.nodes;
        let local = |(index, node): (usize, &Node)| {
            let local = match &moved.parts[index] {
                Some(parts) => Transform::from_parts(parts),
                None => Transform::of_node(node),
            };
            local.map_err(|reason| LoadError::malformed(item("node", index), reason))
        };
        let locals = nodes.iter().enumerate().map(local).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { globals: globals(nodes, &locals), locals, weights: moved.weights })
    }

    /// How the mesh of a node is deformed.
    pub(super) fn deformation(
        &self,
        index: usize,
        node: &Node,
        accessors: &Accessors,
    ) -> Result<Deformation, LoadError> {
        let mesh = node.mesh.and_then(|mesh| accessors.root.meshes.get(mesh));
        let rest = || node.weights.clone().or_else(|| mesh.map(|mesh| mesh.weights.clone()));
        let weights = self.weights[index].clone().or_else(rest).unwrap_or_default();
        let joints = node.skin.map(|skin| self.joints(skin, accessors)).transpose()?;
        Ok(Deformation { weights, joints })
    }

    /// The maps of a skin's joints, from rest to now.
    fn joints(&self, index: usize, accessors: &Accessors) -> Result<Vec<Transform>, LoadError> {
        let malformed = |reason: &str| LoadError::malformed(item("skin", index), reason);
        let skin = accessors.root.skins.get(index);
        let skin = skin.ok_or_else(|| malformed("there is no such skin"))?;
        let binds: Vec<[f64; 16]> = match skin.inverse_bind_matrices {
            Some(accessor) => accessors.numbers(accessor, "MAT4")?,
            None => Vec::new(),
        };
        if skin.inverse_bind_matrices.is_some() && binds.len() < skin.joints.len() {
            return Err(malformed("it has fewer inverse bind matrices than joints"));
        }
        let joint = |(place, node): (usize, &usize)| {
            let joint = self.globals.get(*node).ok_or_else(|| malformed("a joint is no node"))?;
            let bind = binds.get(place).map(|bind| Transform::from_matrix(*bind)).transpose();
            let bind = bind.map_err(malformed)?.unwrap_or(Transform::IDENTITY);
            Ok(joint.after(&bind))
        };
        skin.joints.iter().enumerate().map(joint).collect()
    }
}

/// Transforms over the scene. Nodes that are their own ancestors stay where they are: the walk over
/// the scene refuses them.
fn globals(nodes: &[Node], locals: &[Transform]) -> Vec<Transform> {
    let mut is_child = vec![false; nodes.len()];
    for &child in nodes.iter().flat_map(|node| &node.children) {
        if let Some(is_child) = is_child.get_mut(child) {
            *is_child = true;
        }
    }
    let mut globals = locals.to_vec();
    let mut visited = is_child.iter().map(|is_child| !is_child).collect::<Vec<_>>();
    let mut stack: Vec<usize> = (0..nodes.len()).filter(|node| !is_child[*node]).collect();
    while let Some(parent) = stack.pop() {
        for &child in &nodes[parent].children {
            if child < nodes.len() && !std::mem::replace(&mut visited[child], true) {
                globals[child] = globals[parent].after(&locals[child]);
                stack.push(child);
            }
        }
    }
    globals
}

/// What moves the vertices of a node's mesh.
pub(super) struct Deformation {
    /// Of the morph targets; those that are left out are zero.
    weights: Vec<f64>,
    joints: Option<Vec<Transform>>,
}

impl Deformation {
    /// Whether joints decide where the mesh is, and the node does not.
    pub(super) fn is_skinned(&self) -> bool {
        self.joints.is_some()
    }

    /// Moves the positions of a primitive.
    pub(super) fn apply(
        &self,
        positions: &mut [[f64; 3]],
        primitive: &Primitive,
        accessors: &Accessors,
    ) -> Result<(), LoadError> {
        for (target, weight) in primitive.targets.iter().zip(&self.weights) {
            let Some(accessor) = target.position.filter(|_| *weight != 0.0) else { continue };
            let steps = accessors.positions(accessor)?;
            check_count(accessor, steps.len(), positions.len())?;
            for (position, step) in positions.iter_mut().zip(&steps) {
                *position = std::array::from_fn(|axis| position[axis] + weight * step[axis]);
            }
        }
        match &self.joints {
            Some(joints) => skin(positions, &primitive.attributes, joints, accessors),
            None => Ok(()),
        }
    }
}

/// Moves every position by the mean of its joints.
fn skin(
    positions: &mut [[f64; 3]],
    attributes: &Attributes,
    joints: &[Transform],
    accessors: &Accessors,
) -> Result<(), LoadError> {
    let mut sums = vec![([0.0; 3], 0.0); positions.len()];
    let sets = [
        (attributes.joints, attributes.weights),
        (attributes.more_joints, attributes.more_weights),
    ];
    for (names, weights) in sets {
        let (Some(names), Some(weights)) = (names, weights) else { continue };
        let [name_values, weight_values] =
            [names, weights].map(|accessor| accessors.numbers::<4>(accessor, "VEC4"));
        let (name_values, weight_values) = (name_values?, weight_values?);
        check_count(names, name_values.len(), positions.len())?;
        check_count(weights, weight_values.len(), positions.len())?;
        for (index, (four, weights)) in name_values.iter().zip(&weight_values).enumerate() {
            for (name, weight) in four.iter().zip(weights).filter(|(_, weight)| **weight != 0.0) {
                let Some(joint) = joints.get(*name as usize) else {
                    let reason =
                        format!("vertex {index} hangs on joint {name}, which the skin lacks");
                    return Err(LoadError::malformed(item("accessor", names), reason));
                };
                let moved = joint.apply(positions[index]);
                let (sum, total) = &mut sums[index];
                *sum = std::array::from_fn(|axis| sum[axis] + weight * moved[axis]);
                *total += weight;
            }
        }
    }
    for (position, (sum, total)) in positions.iter_mut().zip(sums) {
        if total != 0.0 {
            *position = sum.map(|value| value / total);
        }
    }
    Ok(())
}

fn check_count(accessor: usize, count: usize, vertices: usize) -> Result<(), LoadError> {
    if count == vertices {
        return Ok(());
    }
    let reason = format!("it has {count} elements, for {vertices} vertices");
    Err(LoadError::malformed(item("accessor", accessor), reason))
}

fn item(what: &str, index: usize) -> Place {
    Place::item(format!("{what} {index}"))
}
