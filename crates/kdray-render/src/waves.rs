//! Pictures whose rays are traced many at a time.
//!
//! Shading asks for a ray and goes on with the answer. Here every sample is shaded as far as its
//! answers go; the rays that all of them ask for next are traced together, and then each is shaded
//! anew with one answer more. Shading is cheap, and the same every time: so the picture is the
//! one that rays traced one by one give, bit for bit.

use kdray::Ray;
use rayon::prelude::*;

use crate::Cancelled;
use crate::caster::Casting;
use crate::film::{Film, Pixel, Sample, View};
use crate::probe::{Answer, Probe, Question};
use crate::sampler::Sampler;
use crate::scene::Scene;

/// Samples that are shaded at a time. More of them keep a device busy; fewer take less memory and let
/// a picture be cancelled sooner.
const WAVE: usize = 1 << 16;

/// A sample on its way.
struct Path {
    pixel: [u32; 2],
    sample: u32,
    answers: Vec<Answer>,
    state: State,
}

enum State {
    Asks(Question),
    Done(Sample),
}

/// Shades every sample of every pixel.
pub(crate) fn expose<S>(
    scene: &Scene,
    casting: &Casting,
    view: &View,
    shade: &S,
) -> Result<Film, Cancelled>
where
    S: Fn(&mut Probe, &Ray, &mut Sampler) -> Sample + Sync,
{
    let options = view.options;
    let (width, height, samples) = (options.width, options.height, options.samples());
    let count = width as usize * height as usize;
    let mut film = Film { width, height, pixels: Vec::with_capacity(count), rays: 0, hits: 0 };
    let pixels_a_wave = (WAVE / samples as usize).max(1);
    for first in (0..count).step_by(pixels_a_wave) {
        let pixels = first..(first + pixels_a_wave).min(count);
        let end = pixels.end;
        let wave = trace(scene, casting, view, shade, pixels)?;
        film.rays += wave.iter().map(|path| path.answers.len() as u64).sum::<u64>();
        film.hits +=
            wave.iter().flat_map(|path| &path.answers).filter(|it| it.is_hit()).count() as u64;
        let mut shaded = wave.into_iter().filter_map(|path| match path.state {
            State::Done(sample) => Some(sample),
            State::Asks(_) => None,
        });
        for _ in first..end {
            let of_pixel: Vec<Sample> = shaded.by_ref().take(samples as usize).collect();
            film.pixels.push(Pixel::mean(of_pixel.into_iter()));
        }
        if let Some(progress) = options.progress {
            progress(end as f32 / count as f32);
        }
    }
    Ok(film)
}

/// The samples of some pixels, all done.
fn trace<S>(
    scene: &Scene,
    casting: &Casting,
    view: &View,
    shade: &S,
    pixels: std::ops::Range<usize>,
) -> Result<Vec<Path>, Cancelled>
where
    S: Fn(&mut Probe, &Ray, &mut Sampler) -> Sample + Sync,
{
    let (width, samples) = (view.options.width as usize, view.options.samples());
    let advance = |path: &mut Path| {
        let (ray, mut sampler) = view.sample(path.pixel, path.sample);
        let mut probe = Probe::with_answers(scene, &path.answers);
        let sample = shade(&mut probe, &ray, &mut sampler);
        path.state = probe.missing().map_or(State::Done(sample), State::Asks);
    };
    let begin = |index: usize| {
        let (pixel, sample) = (index / samples as usize, (index % samples as usize) as u32);
        let pixel = [(pixel % width) as u32, (pixel / width) as u32];
        let state = State::Asks(Question::Closest(view.sample(pixel, sample).0));
        let mut path = Path { pixel, sample, answers: Vec::new(), state };
        advance(&mut path);
        path
    };
    let indices = pixels.start * samples as usize..pixels.end * samples as usize;
    let mut paths: Vec<Path> = indices.into_par_iter().map(begin).collect();
    loop {
        view.options.check_cancelled()?;
        if !answer(casting, &mut paths)? {
            return Ok(paths);
        }
        paths.par_iter_mut().filter(|path| path.is_asking()).for_each(advance);
    }
}

/// Answers what the paths ask. Gives whether any did.
fn answer(casting: &Casting, paths: &mut [Path]) -> Result<bool, Cancelled> {
    let (mut closest, mut any) = (Vec::new(), Vec::new());
    for path in paths.iter() {
        match path.state {
            State::Asks(Question::Closest(ray)) => closest.push(ray),
            State::Asks(Question::Any(ray)) => any.push(ray),
            State::Done(_) => {}
        }
    }
    let mut hits = casting.closest_hits(&closest)?.into_iter();
    let mut found = casting.any_hits(&any)?.into_iter();
    for path in paths.iter_mut() {
        let answer = match path.state {
            State::Asks(Question::Closest(_)) => hits.next().map(Answer::Closest),
            State::Asks(Question::Any(_)) => found.next().map(Answer::Any),
            State::Done(_) => None,
        };
        path.answers.extend(answer);
    }
    Ok(!closest.is_empty() || !any.is_empty())
}

impl Path {
    fn is_asking(&self) -> bool {
        matches!(self.state, State::Asks(_))
    }
}

impl Answer {
    fn is_hit(self) -> bool {
        match self {
            Self::Closest(hit) => hit.is_some(),
            Self::Any(hit) => hit,
        }
    }
}
