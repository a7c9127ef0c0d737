//! Where a node puts its mesh: an affine map in `f64`.

use super::schema::Node;

/// An affine map: `point -> linear * point + offset`, with `linear` by columns.
#[derive(Debug, Clone, Copy)]
pub(super) struct Transform {
    columns: [[f64; 3]; 3],
    offset: [f64; 3],
}

/// What a node's transform is made of, if it is no matrix.
#[derive(Clone, Copy)]
pub(super) struct Parts {
    pub(super) translation: [f64; 3],
    pub(super) rotation: [f64; 4],
    pub(super) scale: [f64; 3],
}

impl Parts {
    pub(super) fn of_node(node: &Node) -> Self {
        Self {
            translation: node.translation.unwrap_or([0.0; 3]),
            rotation: node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]),
            scale: node.scale.unwrap_or([1.0; 3]),
        }
    }
}

impl Transform {
    pub(super) const IDENTITY: Self =
        Self { columns: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], offset: [0.0; 3] };

    /// The transform of a node over that of its parent; an error says what is wrong with it.
    pub(super) fn of_node(node: &Node) -> Result<Self, &'static str> {
        let transform = match node.matrix {
            Some(matrix) => Self::from_matrix(matrix)?,
            None => Self::from_parts(&Parts::of_node(node))?,
        };
        let is_finite = transform.columns.as_flattened().iter().all(|value| value.is_finite())
            && transform.offset.iter().all(|value| value.is_finite());
        if is_finite { Ok(transform) } else { Err("its transform is not finite") }
    }

    pub(super) fn from_matrix(m: [f64; 16]) -> Result<Self, &'static str> {
        if [m[3], m[7], m[11], m[15]] != [0.0, 0.0, 0.0, 1.0] {
            return Err("its matrix is not affine");
        }
        let column = |k: usize| [m[4 * k], m[4 * k + 1], m[4 * k + 2]];
        Ok(Self { columns: [column(0), column(1), column(2)], offset: column(3) })
    }

    /// Scales, turns and moves, in this order.
    pub(super) fn from_parts(parts: &Parts) -> Result<Self, &'static str> {
        let mut columns = rotation(parts.rotation)?;
        for (column, scale) in columns.iter_mut().zip(parts.scale) {
            *column = column.map(|value| value * scale);
        }
        Ok(Self { columns, offset: parts.translation })
    }

    /// This transform after `inner`.
    pub(super) fn after(&self, inner: &Self) -> Self {
        let linear = Self { offset: [0.0; 3], ..*self };
        let columns = inner.columns.map(|column| linear.apply(column));
        Self { columns, offset: self.apply(inner.offset) }
    }

    pub(super) fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|row| {
            let [a, b, c] = self.columns;
            a[row] * point[0] + b[row] * point[1] + c[row] * point[2] + self.offset[row]
        })
    }

    /// Whether the map turns the inside out.
    pub(super) fn mirrors(&self) -> bool {
        let [a, b, c] = self.columns;
        let volume = a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        volume < 0.0
    }
}

/// The rotation matrix of a quaternion x, y, z, w, which need not have exactly unit length.
fn rotation([x, y, z, w]: [f64; 4]) -> Result<[[f64; 3]; 3], &'static str> {
    let square = x * x + y * y + z * z + w * w;
    if square == 0.0 {
        return Err("its rotation is zero");
    }
    let s = 2.0 / square;
    Ok([
        [1.0 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)],
        [s * (x * y - w * z), 1.0 - s * (x * x + z * z), s * (y * z + w * x)],
        [s * (x * z + w * y), s * (y * z - w * x), 1.0 - s * (x * x + y * y)],
    ])
}
