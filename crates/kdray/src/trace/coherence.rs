//! Which rays are best traced in turns, as packets, or one by one.

use super::hits::Counted;
use super::traverse::{Trip, traverse};
use crate::geometry::Ray;

/// What a few rays tell of the others.
pub(super) struct Sample {
    /// Those that may hit something.
    rays: u32,
    /// Wide nodes that they meet.
    steps: u32,
}

impl Sample {
    pub(super) fn new(trip: &Trip, rays: &[Ray]) -> Self {
        let mut sample = Self { rays: 0, steps: 0 };
        let may_hit = |ray: &&Ray| ray.is_valid() && !trip.hull.is_missed(ray);
        for ray in rays.iter().step_by(64).filter(may_hit) {
            sample.rays += 1;
            let mut counted = Counted::new(ray, |_| true);
            traverse(trip, ray, &mut counted);
            sample.steps += counted.counts.steps;
        }
        sample
    }

    /// Whether rays that take turns gain more by that than taking turns costs: where they go a long way, or
    /// are far from each other, so that each reads what is in no cache, and go some way.
    pub(super) fn is_worth_turns(&self, are_far: bool) -> bool {
        // Where both were about as fast: the first, when turns cost more, over thirteen scenes; the other lies
        // between what was measured for bounces in nine.
        let least = if are_far { 2 } else { 7 };
        self.steps > least * self.rays
    }
}

/// Whether most rays are beside the one before, all the way.
pub(super) fn go_together(trip: &Trip, rays: &[Ray]) -> bool {
    go_the_same_way(rays) && !start_apart(trip, rays)
}

/// Whether most rays start far from the one before.
pub(super) fn start_apart(trip: &Trip, rays: &[Ray]) -> bool {
    let is_far = |pair: &&[Ray]| {
        let [a, b] = [pair[0].origin, pair[1].origin];
        (0..3).any(|axis| (a[axis] - b[axis]).abs() > trip.hull.reach / 32.0)
    };
    let pairs = rays.windows(2).step_by(16);
    2 * pairs.clone().filter(is_far).count() >= pairs.count()
}

/// Whether most rays have about the direction of the one before.
fn go_the_same_way(rays: &[Ray]) -> bool {
    let is_alike = |pair: &&[Ray]| {
        let [a, b] = [pair[0].direction, pair[1].direction];
        let dot = |p: [f32; 3], q: [f32; 3]| p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
        // The angle between them is less than 18 degrees.
        let cosine = dot(a, b);
        cosine > 0.0 && cosine * cosine > 0.9 * dot(a, a) * dot(b, b)
    };
    // A sample will do: every 16th pair.
    let pairs = rays.windows(2).step_by(16);
    2 * pairs.clone().filter(is_alike).count() >= pairs.count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_compared_whatever_their_lengths() {
        let ray = |x: f32, length: f32| Ray::new([0.0; 3], [length * x, 0.0, length]);
        let alike: Vec<_> = (0..100).map(|i| ray(0.001 * i as f32, 1.0 + i as f32)).collect();
        let apart: Vec<_> =
            (0..100).map(|i| ray(if i % 2 == 0 { 1.0 } else { -1.0 }, 1.0)).collect();
        assert!(go_the_same_way(&alike) && !go_the_same_way(&apart));
        let opposite: Vec<_> =
            (0..100).map(|i| ray(0.0, if i % 2 == 0 { 1.0 } else { -1.0 })).collect();
        assert!(!go_the_same_way(&opposite));
    }
}
