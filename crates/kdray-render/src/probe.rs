//! Rays that are asked for and counted.

use kdray::{Counts, Hit, Ray, Tracer};

use crate::point::Point;
use crate::scene::Scene;

/// Asks the scene and counts what the tree was asked.
pub(crate) struct Probe<'a> {
    scene: &'a Scene<'a>,
    answers: Answers<'a>,
    /// Rays that were traced through the tree.
    pub(crate) rays: u64,
    /// Those of them that hit a triangle.
    pub(crate) hits: u64,
}

/// Where a probe finds its answers.
enum Answers<'a> {
    /// It traces.
    Now(&'a Tracer),
    /// They were given in this order; what they are not enough for is noted down.
    Given { given: std::slice::Iter<'a, Answer>, missing: Option<Question> },
}

/// What became of a ray.
#[derive(Clone, Copy)]
pub(crate) enum Answer {
    Closest(Option<Hit>),
    Any(bool),
}

/// What is asked of a ray.
#[derive(Clone, Copy)]
pub(crate) enum Question {
    Closest(Ray),
    Any(Ray),
}

impl<'a> Probe<'a> {
    /// A probe that traces.
    pub(crate) fn new(scene: &'a Scene<'a>, tracer: &'a Tracer) -> Self {
        Self { scene, answers: Answers::Now(tracer), rays: 0, hits: 0 }
    }

    /// A probe that knows the first answers. Whatever it is asked beyond them has no hits.
    pub(crate) fn with_answers(scene: &'a Scene<'a>, given: &'a [Answer]) -> Self {
        let answers = Answers::Given { given: given.iter(), missing: None };
        Self { scene, answers, rays: 0, hits: 0 }
    }

    /// The first question to which it knew no answer.
    pub(crate) fn missing(&self) -> Option<Question> {
        match &self.answers {
            Answers::Now(_) => None,
            Answers::Given { missing, .. } => *missing,
        }
    }

    /// The first surface along the ray.
    pub(crate) fn closest(&mut self, ray: &Ray) -> Option<Point> {
        let hit = match &mut self.answers {
            Answers::Now(tracer) => tracer.closest_hit(ray),
            Answers::Given { given, missing } => match given.next() {
                Some(Answer::Closest(hit)) => *hit,
                _ => {
                    missing.get_or_insert(Question::Closest(*ray));
                    None
                }
            },
        };
        self.count(hit.is_some());
        let t_max = hit.map_or(ray.t_max, |hit| hit.t);
        let ground = self.scene.ground_point(&Ray { t_max, ..*ray });
        ground.or_else(|| Some(self.scene.mesh_point(ray, &hit?)))
    }

    /// Whether a surface is in the way.
    pub(crate) fn occluded(&mut self, ray: &Ray) -> bool {
        if self.scene.ground_point(ray).is_some() {
            return true;
        }
        let hit = match &mut self.answers {
            Answers::Now(tracer) => tracer.any_hit(ray),
            Answers::Given { given, missing } => match given.next() {
                Some(Answer::Any(hit)) => *hit,
                _ => {
                    missing.get_or_insert(Question::Any(*ray));
                    false
                }
            },
        };
        self.count(hit);
        hit
    }

    /// What the ray costs in the tree; nothing for a probe that does not trace.
    pub(crate) fn cost(&mut self, ray: &Ray) -> Counts {
        let Answers::Now(tracer) = self.answers else { return Counts::default() };
        let (hit, counts) = tracer.closest_hit_counted(ray);
        self.count(hit.is_some());
        counts
    }

    fn count(&mut self, hit: bool) {
        self.rays += 1;
        self.hits += u64::from(hit);
    }
}
