//! The paper's scenes, and the meshes that stand for them.

use std::path::{Path, PathBuf};

use clap::ValueEnum;
use kdray_render::Camera;
use serde::Serialize;

use super::published::{self, Published};

/// A scene of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Scene {
    Bunny,
    Sibenik,
    Fairy,
    Explosion,
    Conference,
    Angel,
    Dragon,
    Happy,
}

/// From where a scene is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum View {
    /// From where all of it is seen, or so many times nearer.
    Outside { nearness: f32 },
    /// From its middle.
    Inside,
}

/// How a mesh stands to the one in the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Likeness {
    /// The mesh of the paper.
    Same,
    /// The same place or thing, modelled or cleaned up anew.
    Revision,
    /// Something else, of about the same size.
    Substitute,
}

/// A file that may stand for a scene, in the folder of the meshes.
pub(super) struct Candidate {
    file: &'static str,
    pub(super) likeness: Likeness,
    /// What it is, if it is not what the paper has.
    pub(super) what: &'static str,
    pub(super) up: [f32; 3],
}

impl Candidate {
    const fn new(file: &'static str, likeness: Likeness, what: &'static str) -> Self {
        Self { file, likeness, what, up: Camera::Y_UP }
    }

    const fn same(file: &'static str) -> Self {
        Self::new(file, Likeness::Same, "")
    }
}

const BUNNY: &[Candidate] = &[Candidate::same("bunny.ply")];
const SIBENIK: &[Candidate] =
    &[Candidate::new("sibenik.ply", Likeness::Revision, "the same cathedral in another revision")];
const FAIRY: &[Candidate] = &[Candidate::same("fairy_forest.ply")];
const EXPLOSION: &[Candidate] = &[
    Candidate::same("exploding_dragon.ply"),
    Candidate::new(
        "animated/exploding_dragon_substitute_f00.ply",
        Likeness::Substitute,
        "Stanford's dragon and bunny in rigid shards, for the exploding dragon of UNC; its first \
         frame",
    ),
];
const CONFERENCE: &[Candidate] = &[Candidate::new(
    "conference.ply",
    Likeness::Revision,
    "the same room in another revision, half of whose triangles lie in small clusters in one corner",
)];
const ANGEL: &[Candidate] = &[
    Candidate::same("angel.ply"),
    Candidate {
        up: Camera::Z_UP,
        ..Candidate::new(
            "angel_substitute.ply",
            Likeness::Substitute,
            "Stanford's Lucy, remeshed along a lattice, so that few triangles straddle",
        )
    },
];
const DRAGON: &[Candidate] = &[Candidate::same("dragon.ply")];
const HAPPY: &[Candidate] = &[
    Candidate::same("happy.ply"),
    Candidate::new(
        "happy_substitute.ply",
        Likeness::Substitute,
        "Stanford's Happy Buddha, remeshed along a lattice, so that few triangles straddle",
    ),
];

impl Scene {
    /// All of them, as the paper orders them.
    pub(super) const ALL: [Self; 8] = [
        Self::Bunny,
        Self::Sibenik,
        Self::Fairy,
        Self::Explosion,
        Self::Conference,
        Self::Angel,
        Self::Dragon,
        Self::Happy,
    ];

    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Bunny => "Bunny",
            Self::Sibenik => "Sibenik",
            Self::Fairy => "Fairy",
            Self::Explosion => "Explosion",
            Self::Conference => "Conference",
            Self::Angel => "Angel",
            Self::Dragon => "Dragon",
            Self::Happy => "Happy",
        }
    }

    /// From where it is seen.
    pub(super) fn view(self) -> View {
        match self {
            Self::Sibenik | Self::Conference => View::Inside,
            // Most of its floor is bare.
            Self::Fairy => View::Outside { nearness: 2.2 },
            _ => View::Outside { nearness: 1.0 },
        }
    }

    pub(super) fn published(self) -> Published {
        match self {
            Self::Bunny => published::BUNNY,
            Self::Sibenik => published::SIBENIK,
            Self::Fairy => published::FAIRY,
            Self::Explosion => published::EXPLOSION,
            Self::Conference => published::CONFERENCE,
            Self::Angel => published::ANGEL,
            Self::Dragon => published::DRAGON,
            Self::Happy => published::HAPPY,
        }
    }

    /// What may stand for it, the best first.
    pub(super) fn candidates(self) -> &'static [Candidate] {
        match self {
            Self::Bunny => BUNNY,
            Self::Sibenik => SIBENIK,
            Self::Fairy => FAIRY,
            Self::Explosion => EXPLOSION,
            Self::Conference => CONFERENCE,
            Self::Angel => ANGEL,
            Self::Dragon => DRAGON,
            Self::Happy => HAPPY,
        }
    }
}

/// The best candidate that is in `folder`, and its path.
pub(super) fn find(scene: Scene, folder: &Path) -> Option<(&'static Candidate, PathBuf)> {
    let located =
        scene.candidates().iter().map(|candidate| (candidate, folder.join(candidate.file)));
    located.into_iter().find(|(_, path)| path.exists())
}

/// The names of the files that would do.
pub(super) fn wanted(scene: Scene) -> String {
    let files: Vec<&str> = scene.candidates().iter().map(|candidate| candidate.file).collect();
    files.join(" or ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_paper_has_comes_before_what_stands_for_it() {
        let folder = tempfile::tempdir().expect("a folder");
        assert!(find(Scene::Angel, folder.path()).is_none());
        for (file, likeness) in
            [("angel_substitute.ply", Likeness::Substitute), ("angel.ply", Likeness::Same)]
        {
            std::fs::write(folder.path().join(file), "").expect("written");
            let (found, path) = find(Scene::Angel, folder.path()).expect("it is there");
            assert_eq!((found.likeness, path), (likeness, folder.path().join(file)));
        }
        assert_eq!(wanted(Scene::Angel), "angel.ply or angel_substitute.ply");
    }
}
