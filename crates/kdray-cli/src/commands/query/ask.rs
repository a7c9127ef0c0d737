//! Asks.

use std::ops::ControlFlow;

use kdray::{Batch, BatchError, Frame, Hit, Lists, Ray, Sign};

use super::Kind;
use super::answers::Answers;

/// What is asked about.
pub(super) enum Queries {
    Rays(Vec<Ray>),
    Points(Vec<[f32; 3]>),
}

impl Queries {
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Rays(rays) => rays.len(),
            Self::Points(points) => points.len(),
        }
    }
}

/// What is asked.
pub(super) struct Question<'a> {
    pub(super) kind: Kind,
    pub(super) sign: Sign<'a>,
    /// In world units.
    pub(super) radius: Option<f64>,
    pub(super) frame: Frame,
}

/// What receives lists.
type Sink<'a> = &'a mut dyn FnMut(Lists<Hit>) -> ControlFlow<()>;

/// Queries of rays, wherever they are answered.
trait Rays {
    fn closest(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> anyhow::Result<()>;
    fn any(&self, rays: &[Ray], found: &mut [bool]) -> anyhow::Result<()>;
    fn count(&self, rays: &[Ray], counts: &mut [u32]) -> anyhow::Result<()>;
    fn all(&self, rays: &[Ray], sink: Sink) -> anyhow::Result<()>;
}

macro_rules! answered_by {
    ($batch:ty) => {
        impl Rays for $batch {
            fn closest(&self, rays: &[Ray], hits: &mut [Option<Hit>]) -> anyhow::Result<()> {
                Ok(self.closest_hits(rays, hits)?)
            }

            fn any(&self, rays: &[Ray], found: &mut [bool]) -> anyhow::Result<()> {
                Ok(self.any_hits(rays, found)?)
            }

            fn count(&self, rays: &[Ray], counts: &mut [u32]) -> anyhow::Result<()> {
                Ok(self.count_hits(rays, counts)?)
            }

            fn all(&self, rays: &[Ray], sink: Sink) -> anyhow::Result<()> {
                Ok(self.all_hits(rays, sink)?)
            }
        }
    };
}

answered_by!(Batch<'_>);
answered_by!(kdray_gpu::Batch<'_>);

impl Question<'_> {
    pub(super) fn ask(&self, batch: &Batch, queries: &Queries) -> anyhow::Result<Answers> {
        match queries {
            Queries::Rays(rays) => self.ask_rays(batch, rays),
            Queries::Points(points) => Ok(self.ask_points(batch, points)?),
        }
    }

    /// Asks a GPU, which knows rays only.
    pub(super) fn ask_gpu(
        &self,
        batch: &kdray_gpu::Batch,
        queries: &Queries,
    ) -> anyhow::Result<Answers> {
        match queries {
            Queries::Rays(rays) => self.ask_rays(batch, rays),
            Queries::Points(_) => anyhow::bail!("only rays can be asked on a GPU"),
        }
    }

    fn ask_rays(&self, batch: &impl Rays, rays: &[Ray]) -> anyhow::Result<Answers> {
        match self.kind {
            Kind::Any => {
                let mut hit = vec![false; rays.len()];
                batch.any(rays, &mut hit)?;
                Ok(Answers::Any(hit))
            }
            Kind::Count => {
                let mut counts = vec![0; rays.len()];
                batch.count(rays, &mut counts)?;
                Ok(Answers::Count(counts))
            }
            Kind::All => {
                let (offsets, hits): (_, Vec<Hit>) = gathered(|sink| batch.all(rays, sink))?;
                Ok(Answers::All { offsets, hits })
            }
            _ => {
                let mut hits = vec![None; rays.len()];
                batch.closest(rays, &mut hits)?;
                Ok(Answers::Closest(hits))
            }
        }
    }

    fn ask_points(&self, batch: &Batch, points: &[[f32; 3]]) -> Result<Answers, BatchError> {
        let radius = (self.radius.unwrap_or(f64::INFINITY) / self.frame.scale) as f32;
        match self.kind {
            Kind::Contains => {
                let mut inside = vec![false; points.len()];
                batch.contains(points, self.sign, &mut inside)?;
                Ok(Answers::Contains(inside))
            }
            Kind::SignedDistance => {
                let mut distances = vec![None; points.len()];
                batch.signed_distances(points, self.sign, &mut distances)?;
                Ok(Answers::SignedDistance(distances))
            }
            Kind::Within => {
                let (offsets, triangles) =
                    gathered(|sink| batch.within_spheres(points, radius, sink))?;
                Ok(Answers::Within { offsets, triangles })
            }
            _ => {
                let mut closest = vec![None; points.len()];
                batch.closest_points(points, radius, &mut closest)?;
                Ok(Answers::ClosestPoint(closest))
            }
        }
    }
}

/// All lists of a stream: where each begins, and their items.
fn gathered<T: Copy, E>(
    ask: impl FnOnce(&mut dyn FnMut(Lists<T>) -> ControlFlow<()>) -> Result<(), E>,
) -> Result<(Vec<u64>, Vec<T>), E> {
    let (mut offsets, mut items) = (vec![0], Vec::new());
    ask(&mut |lists| {
        let start = items.len();
        offsets.extend(lists.offsets[1..].iter().map(|offset| (start + offset) as u64));
        items.extend_from_slice(lists.items);
        ControlFlow::Continue(())
    })?;
    Ok((offsets, items))
}
