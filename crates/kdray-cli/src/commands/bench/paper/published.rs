//! What the paper says of its eight scenes \[WZL11], and of those it is compared with there.

use serde::Serialize;

/// The GPU of the paper, and its memory bandwidth in GB/s.
pub(super) const GPU: &str = "GTX 280";
pub(super) const BANDWIDTH: f64 = 141.7;

/// A scene's row in the paper.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Published {
    pub(super) triangles: u32,
    pub(super) build_s: f64,
    /// A picture of 1024 x 1024 pixels.
    pub(super) trace_s: f64,
    pub(super) peak_mb: f64,
    pub(super) final_mb: f64,
    /// Whom the paper compares itself with.
    pub(super) peer: Peer,
    pub(super) peer_build_s: f64,
    pub(super) peer_trace_s: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Peer {
    /// \[CKL+10]: a kd-tree without clipping, on 32 cores.
    Choi,
    /// \[LGS+09]: a bounding volume hierarchy by SAH, on a GPU.
    Lauterbach,
}

impl Published {
    const fn new(
        triangles: u32,
        [build_s, trace_s]: [f64; 2],
        [peak_mb, final_mb]: [f64; 2],
    ) -> Self {
        let (peer, peer_build_s, peer_trace_s) = (Peer::Choi, 0.0, None);
        Self { triangles, build_s, trace_s, peak_mb, final_mb, peer, peer_build_s, peer_trace_s }
    }

    const fn choi(self, peer_build_s: f64) -> Self {
        Self { peer: Peer::Choi, peer_build_s, ..self }
    }

    const fn lauterbach(self, peer_build_s: f64, pictures_per_s: f64) -> Self {
        let peer_trace_s = Some(1.0 / pictures_per_s);
        Self { peer: Peer::Lauterbach, peer_build_s, peer_trace_s, ..self }
    }
}

pub(super) const BUNNY: Published =
    Published::new(69_000, [0.059, 0.031], [33.96, 4.86]).choi(0.068);
pub(super) const SIBENIK: Published =
    Published::new(82_000, [0.091, 1.0 / 24.4], [39.34, 7.71]).lauterbach(0.144, 21.7);
pub(super) const FAIRY: Published =
    Published::new(174_000, [0.142, 1.0 / 31.2], [80.33, 14.91]).lauterbach(0.488, 21.7);
pub(super) const EXPLOSION: Published =
    Published::new(252_000, [0.161, 1.0 / 32.1], [86.48, 16.36]).lauterbach(0.403, 7.75);
pub(super) const CONFERENCE: Published =
    Published::new(284_000, [0.258, 1.0 / 32.2], [159.58, 28.74]).lauterbach(0.477, 24.5);
pub(super) const ANGEL: Published =
    Published::new(474_000, [0.311, 0.036], [218.26, 34.33]).choi(0.337);
pub(super) const DRAGON: Published =
    Published::new(871_000, [0.511, 0.041], [417.33, 69.76]).choi(0.654);
pub(super) const HAPPY: Published =
    Published::new(1_087_000, [0.645, 0.051], [512.65, 87.08]).choi(0.835);
