//! The kernels of queries, and how they are run over rays.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};

use super::recipe;
use super::scene::{Packed, Scene};
use crate::device::Buffer;
use crate::record::Binding::{Read, Uniform, Write};
use crate::record::{Count, Kernel, Moved, Recording, Work};

pub(crate) static CLOSEST: Kernel = Kernel {
    name: "closest",
    source: include_str!("closest.wgsl"),
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Write, Write],
};

pub(crate) static LOCATE: Kernel = Kernel {
    name: "locate",
    source: include_str!("locate.wgsl"),
    bindings: &[Uniform, Read, Read, Read, Read, Read, Write],
};

pub(crate) static ANY: Kernel = Kernel {
    name: "any",
    source: include_str!("any.wgsl"),
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Write],
};

pub(crate) static MEET: Kernel = Kernel {
    name: "meet",
    source: include_str!("meet.wgsl"),
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, Write, Write],
};

pub(crate) static LOCATE_MET: Kernel = Kernel {
    name: "locate_met",
    source: include_str!("locate_met.wgsl"),
    bindings: &[Uniform, Read, Read, Read, Read, Read, Write],
};

pub(crate) static ORDER: Kernel = Kernel {
    name: "order",
    source: include_str!("order.wgsl"),
    bindings: &[Uniform, Read, Read, Read, Write, Write],
};

/// Bytes of the private variables of `closest` and of `locate`; the test of layouts counts them.
pub(crate) const PRIVATE_BYTES: [u32; 2] = [997, 656];

/// What every kernel of a query is told.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub(crate) struct Params {
    pub(crate) count: u32,
    /// 1 if every ray has a triangle that it does not see.
    pub(crate) has_except: u32,
    /// 1 if what the rays meet is counted.
    pub(crate) is_counted: u32,
    /// The largest coordinate of the scene.
    pub(crate) reach: f32,
    pub(crate) lower: [f32; 3],
    pub(crate) unused: u32,
    pub(crate) upper: [f32; 3],
    pub(crate) unused_too: u32,
    pub(crate) steps: [[u32; 4]; recipe::WORDS.len()],
}

/// Rays in the memory of the device, in the form of [`kdray::Ray`].
#[derive(Clone, Debug)]
pub struct Rays {
    /// 8 words a ray.
    pub rays: Buffer,
    /// By ray, a triangle that it does not see, or `u32::MAX`.
    pub except: Option<Buffer>,
    /// How many they are at most.
    pub count: u32,
    /// How many they are, if only the device knows. Up to 255 rays behind them are traced too.
    pub live: Option<Count>,
}

impl Rays {
    fn params(&self, scene: &Scene, is_counted: bool) -> Params {
        Params {
            count: self.count,
            has_except: self.except.is_some().into(),
            is_counted: is_counted.into(),
            reach: scene.reach,
            lower: scene.bounds.lower,
            unused: 0,
            upper: scene.bounds.upper,
            unused_too: 0,
            steps: recipe::WORDS,
        }
    }

    /// What stands in for triangles that are not seen if there are none.
    fn except(&self) -> &Buffer {
        self.except.as_ref().unwrap_or(&self.rays)
    }

    /// Runs a kernel whose first bindings are the rays and the scene.
    pub(super) fn query(
        &self,
        recording: &mut Recording,
        (kernel, is_counted): (&'static Kernel, bool),
        scene: &Scene,
        answers: &[&Buffer],
    ) {
        let Scene { tree: Packed { nodes, references, .. }, positions, triangles, .. } = scene;
        let mut buffers = vec![&self.rays, self.except(), nodes, references, positions, triangles];
        buffers.extend(answers);
        let work = Work::each(&self.number());
        let params = self.params(scene, is_counted);
        // Without the scene: what is read of that, caches decide.
        recording.dispatch(kernel, &params, &buffers, &work, |rays| Moved {
            read: 32 * rays,
            written: 4 * rays,
        });
    }

    fn number(&self) -> Count {
        self.live.clone().unwrap_or_else(|| self.count.into())
    }

    /// Runs a kernel over `count` elements that come of the rays.
    pub(super) fn run(
        &self,
        recording: &mut Recording,
        (kernel, count): (&'static Kernel, Count),
        scene: &Scene,
        others: &[&Buffer],
    ) {
        let mut buffers = vec![&self.rays, self.except()];
        buffers.extend(others);
        let work = Work::each(&count);
        let params = Params { count: count.bound(), ..self.params(scene, false) };
        recording.dispatch(kernel, &params, &buffers, &work, |count| Moved {
            read: 84 * count,
            written: 16 * count,
        });
    }

    /// Works out where the rays hit their triangles.
    pub(super) fn locate(
        &self,
        recording: &mut Recording,
        scene: &Scene,
        [closest_triangles, hits]: [&Buffer; 2],
    ) {
        let others = [&scene.positions, &scene.triangles, closest_triangles, hits];
        self.run(recording, (&LOCATE, self.number()), scene, &others);
    }

    /// Parts of rays start at a multiple of this.
    pub(super) const ALIGNMENT: u32 = 64;

    /// Some of the rays.
    pub(super) fn part(&self, part: &Range<u32>) -> Self {
        let (first, count) = (u64::from(part.start), part.len() as u32);
        let except = |except: &Buffer| except.words(first, count.into());
        Self {
            rays: self.rays.words(8 * first, 8 * u64::from(count)),
            except: self.except.as_ref().map(except),
            count,
            live: None,
        }
    }
}
