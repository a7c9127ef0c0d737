//! Answers, and the arrays that they are written as.

use std::fs::File;
use std::io::BufWriter;

use kdray::{ClosestPoint, Frame, Hit};
use ndarray::{Array1, Array2, aview1};
use ndarray_npy::{NpzWriter, WritableElement};

/// What was found, in the coordinates of the mesh.
pub(super) enum Answers {
    Closest(Vec<Option<Hit>>),
    Any(Vec<bool>),
    All { offsets: Vec<u64>, hits: Vec<Hit> },
    Count(Vec<u32>),
    Contains(Vec<bool>),
    ClosestPoint(Vec<Option<ClosestPoint>>),
    SignedDistance(Vec<Option<f32>>),
    Within { offsets: Vec<u64>, triangles: Vec<u32> },
}

/// The triangle of a query that has none.
const NONE: u32 = u32::MAX;

/// A file of arrays.
struct Arrays<'a> {
    file: NpzWriter<BufWriter<&'a mut File>>,
}

impl Arrays<'_> {
    fn add<T: WritableElement>(&mut self, name: &str, values: &[T]) -> anyhow::Result<()> {
        Ok(self.file.add_array(name, &aview1(values))?)
    }

    /// An array of what `value` is of every item.
    fn map<A, T: WritableElement>(
        &mut self,
        name: &str,
        items: &[A],
        value: impl Fn(&A) -> T,
    ) -> anyhow::Result<()> {
        let values: Array1<T> = items.iter().map(value).collect();
        Ok(self.file.add_array(name, &values)?)
    }
}

impl Answers {
    /// Writes the arrays; places and lengths are those of the world.
    pub(super) fn write(&self, frame: &Frame, file: &mut File) -> anyhow::Result<()> {
        let mut arrays = Arrays { file: NpzWriter::new(BufWriter::new(file)) };
        match self {
            Self::Closest(hits) => {
                let miss = Hit { t: f32::INFINITY, triangle: NONE, u: 0.0, v: 0.0 };
                write_hits(&mut arrays, hits, |hit| hit.unwrap_or(miss))?;
            }
            Self::Any(hit) => arrays.add("hit", hit)?,
            Self::All { offsets, hits } => {
                arrays.add("offsets", offsets)?;
                write_hits(&mut arrays, hits, |hit| *hit)?;
            }
            Self::Count(counts) => arrays.add("count", counts)?,
            Self::Contains(inside) => arrays.add("inside", inside)?,
            Self::ClosestPoint(closest) => write_closest_points(&mut arrays, closest, frame)?,
            Self::SignedDistance(distances) => {
                let distance = |distance: &Option<f32>| in_world(frame, *distance);
                arrays.map("distance", distances, distance)?;
            }
            Self::Within { offsets, triangles } => {
                arrays.add("offsets", offsets)?;
                arrays.add("triangle", triangles)?;
            }
        }
        let rest = arrays.file.finish()?.into_inner();
        rest.map_err(std::io::IntoInnerError::into_error)?;
        Ok(())
    }
}

fn write_hits<A>(arrays: &mut Arrays, hits: &[A], hit: impl Fn(&A) -> Hit) -> anyhow::Result<()> {
    arrays.map("t", hits, |it| hit(it).t)?;
    arrays.map("triangle", hits, |it| hit(it).triangle)?;
    arrays.map("u", hits, |it| hit(it).u)?;
    arrays.map("v", hits, |it| hit(it).v)
}

fn write_closest_points(
    arrays: &mut Arrays,
    closest: &[Option<ClosestPoint>],
    frame: &Frame,
) -> anyhow::Result<()> {
    let point = |found: &Option<ClosestPoint>| {
        found.map_or([f64::NAN; 3], |found| frame.world_point(found.point))
    };
    let points: Vec<[f64; 3]> = closest.iter().map(point).collect();
    arrays.file.add_array("point", &Array2::from(points))?;
    let distance = |found: &Option<ClosestPoint>| in_world(frame, found.map(|it| it.distance));
    arrays.map("distance", closest, distance)?;
    arrays.map("triangle", closest, |found| found.map_or(NONE, |found| found.triangle))?;
    arrays.map("u", closest, |found| found.map_or(0.0, |found| found.u))?;
    arrays.map("v", closest, |found| found.map_or(0.0, |found| found.v))
}

/// A length in world units; infinite for none.
fn in_world(frame: &Frame, length: Option<f32>) -> f64 {
    length.map_or(f64::INFINITY, |length| f64::from(length) * frame.scale)
}
