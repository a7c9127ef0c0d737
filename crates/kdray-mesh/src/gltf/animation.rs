//! What the channels of an animation say at a time.

use super::accessor::Accessors;
use super::schema::{Animation, Channel, Interpolation, Sampler};
use super::transform::Parts;
use crate::error::{LoadError, Place};

/// What moves at some time; the rest stays as the nodes say.
#[derive(Default)]
pub(super) struct Moved {
    /// By node: its transform's parts.
    pub(super) parts: Vec<Option<Parts>>,
    /// By node: the weights of its morph targets.
    pub(super) weights: Vec<Option<Vec<f64>>>,
}

/// An animation of a document.
pub(super) struct Player<'a> {
    accessors: &'a Accessors<'a>,
    animation: &'a Animation,
    item: String,
}

impl<'a> Player<'a> {
    pub(super) fn new(accessors: &'a Accessors<'a>, index: usize) -> Result<Self, LoadError> {
        let item = format!("animation {index}");
        match accessors.root.animations.get(index) {
            Some(animation) => Ok(Self { accessors, animation, item }),
            None => Err(LoadError::malformed(Place::item(item), "there is no such animation")),
        }
    }

    /// The last of all key times, in seconds.
    pub(super) fn duration(&self) -> Result<f64, LoadError> {
        let mut last = 0.0_f64;
        for channel in &self.animation.channels {
            let times = self.times(self.sampler(channel)?)?;
            last = times.last().map_or(last, |[time]| last.max(*time));
        }
        Ok(last)
    }

    /// What the channels say at `time`, in seconds.
    pub(super) fn at(&self, time: f64) -> Result<Moved, LoadError> {
        let root = self.accessors.root;
        let mut moved = Moved::default();
        moved.parts.resize(root.nodes.len(), None);
        moved.weights.resize(root.nodes.len(), None);
        for channel in &self.animation.channels {
            let Some(index) = channel.target.node else { continue };
            let Some(node) = root.nodes.get(index) else {
                return Err(self.malformed(format!("there is no node {index}")));
            };
            let sampler = self.sampler(channel)?;
            if channel.target.path == "weights" {
                moved.weights[index] = Some(self.weights(sampler, time)?);
                continue;
            }
            if node.matrix.is_some() {
                return Err(self.malformed(format!("node {index} has a matrix and cannot move")));
            }
            let parts = moved.parts[index].get_or_insert_with(|| Parts::of_node(node));
            match channel.target.path.as_str() {
                "translation" => parts.translation = self.value(sampler, "VEC3", time, lerp)?,
                "scale" => parts.scale = self.value(sampler, "VEC3", time, lerp)?,
                "rotation" => parts.rotation = self.value(sampler, "VEC4", time, slerp)?,
                other => return Err(self.malformed(format!("{other:?} is no path of a channel"))),
            }
        }
        Ok(moved)
    }

    fn sampler(&self, channel: &Channel) -> Result<&Sampler, LoadError> {
        let sampler = self.animation.samplers.get(channel.sampler);
        sampler.ok_or_else(|| self.malformed(format!("there is no sampler {}", channel.sampler)))
    }

    /// Key times, which rise.
    fn times(&self, sampler: &Sampler) -> Result<Vec<[f64; 1]>, LoadError> {
        let times: Vec<[f64; 1]> = self.accessors.numbers(sampler.input, "SCALAR")?;
        let rises = times.is_sorted_by(|[a], [b]| a < b);
        match times.last() {
            Some([last]) if rises && times[0][0] >= 0.0 && last.is_finite() => Ok(times),
            Some(_) => Err(self.malformed("its key times do not rise from zero on".to_owned())),
            None => Err(self.malformed("a sampler has no key times".to_owned())),
        }
    }

    /// The value of a sampler at `time`.
    fn value<const N: usize>(
        &self,
        sampler: &Sampler,
        shape: &str,
        time: f64,
        blend: fn([f64; N], [f64; N], f64) -> [f64; N],
    ) -> Result<[f64; N], LoadError> {
        let key = Key::find(&self.times(sampler)?, time, sampler.interpolation);
        let values: Vec<[f64; N]> = self.accessors.numbers(sampler.output, shape)?;
        let get = |index: usize| values.get(index).copied().ok_or_else(|| self.too_few());
        match sampler.interpolation {
            Interpolation::Linear => Ok(blend(get(key.index)?, get(key.next)?, key.fraction)),
            Interpolation::Step => get(key.index),
            Interpolation::CubicSpline => {
                // In-tangent, value and out-tangent of each key.
                let [start, end] = [3 * key.index, 3 * key.next];
                let ends = [get(start + 1)?, get(end + 1)?];
                Ok(key.spline(ends, [get(start + 2)?, get(end)?]))
            }
        }
    }

    /// The weights of morph targets at `time`: as many at every key.
    fn weights(&self, sampler: &Sampler, time: f64) -> Result<Vec<f64>, LoadError> {
        let times = self.times(sampler)?;
        let values: Vec<[f64; 1]> = self.accessors.numbers(sampler.output, "SCALAR")?;
        let a_key = if sampler.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let targets = values.len() / (a_key * times.len());
        if targets == 0 || targets * a_key * times.len() != values.len() {
            return Err(self.too_few());
        }
        let key = Key::find(&times, time, sampler.interpolation);
        let of = |row: usize, target: usize| values[row * targets + target][0];
        let weight = |target| match sampler.interpolation {
            Interpolation::Linear => {
                let [from, to] = [key.index, key.next].map(|row| of(row, target));
                from + (to - from) * key.fraction
            }
            Interpolation::Step => of(key.index, target),
            Interpolation::CubicSpline => {
                let [start, end] = [3 * key.index, 3 * key.next];
                let ends = [start + 1, end + 1].map(|row| [of(row, target)]);
                key.spline(ends, [[of(start + 2, target)], [of(end, target)]])[0]
            }
        };
        Ok((0..targets).map(weight).collect())
    }

    fn too_few(&self) -> LoadError {
        self.malformed("a sampler's values are not as many as its key times ask for".to_owned())
    }

    fn malformed(&self, reason: String) -> LoadError {
        LoadError::malformed(Place::item(self.item.clone()), reason)
    }
}

/// Where a time is among key times.
struct Key {
    index: usize,
    next: usize,
    /// How far between the two, in 0..=1.
    fraction: f64,
    /// Seconds between the two.
    step: f64,
}

impl Key {
    fn find(times: &[[f64; 1]], time: f64, interpolation: Interpolation) -> Self {
        let last = times.len() - 1;
        let index = times.partition_point(|[key]| *key <= time).saturating_sub(1);
        let next = if interpolation == Interpolation::Step { index } else { (index + 1).min(last) };
        let step = times[next][0] - times[index][0];
        let fraction = if step > 0.0 { (time - times[index][0]) / step } else { 0.0 };
        Self { index, next, fraction: fraction.clamp(0.0, 1.0), step }
    }

    /// The cubic through both ends with these tangents, a second.
    fn spline<const N: usize>(&self, ends: [[f64; N]; 2], tangents: [[f64; N]; 2]) -> [f64; N] {
        let t = self.fraction;
        let (square, cube) = (t * t, t * t * t);
        std::array::from_fn(|k| {
            (2.0 * cube - 3.0 * square + 1.0) * ends[0][k]
                + self.step * (cube - 2.0 * square + t) * tangents[0][k]
                + (3.0 * square - 2.0 * cube) * ends[1][k]
                + self.step * (cube - square) * tangents[1][k]
        })
    }
}

fn lerp<const N: usize>(from: [f64; N], to: [f64; N], fraction: f64) -> [f64; N] {
    std::array::from_fn(|k| from[k] + (to[k] - from[k]) * fraction)
}

/// Between two rotations, along the shorter arc.
fn slerp(from: [f64; 4], to: [f64; 4], fraction: f64) -> [f64; 4] {
    let dot: f64 = from.iter().zip(&to).map(|(a, b)| a * b).sum();
    let to = if dot < 0.0 { to.map(|value| -value) } else { to };
    let angle = dot.abs().min(1.0).acos();
    if angle < 1e-6 {
        return lerp(from, to, fraction);
    }
    let [first, second] = [1.0 - fraction, fraction].map(|part| (part * angle).sin() / angle.sin());
    std::array::from_fn(|k| first * from[k] + second * to[k])
}
