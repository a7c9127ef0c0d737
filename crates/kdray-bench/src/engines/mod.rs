//! The engines by name.

mod embree;
mod kdray;
mod kdtree_ray;
mod obvhs;
#[cfg(test)]
mod tests;

use std::path::Path;

use anyhow::{Context, Result};

pub(crate) use self::embree::Embree;
use crate::definition::{EngineDefinition, Library};
use crate::engine::Engine;

/// Makes engines out of their definitions.
pub(crate) struct Engines<'a> {
    library: Option<&'a Path>,
}

impl<'a> Engines<'a> {
    /// With the path of Embree's shared library, if there is one.
    pub(crate) fn new(library: Option<&'a Path>) -> Self {
        Self { library }
    }

    /// The engine of a definition, or why it is missing.
    pub(crate) fn make(&self, definition: &EngineDefinition) -> Result<Box<dyn Engine>> {
        let engine: Box<dyn Engine> = match &definition.library {
            Library::Embree(options) => {
                let engine = Embree::open(self.library, options);
                Box::new(engine.with_context(|| format!("engine {} is missing", definition.name))?)
            }
            Library::Obvhs(tree) => Box::new(obvhs::Obvhs::new(*tree)),
            Library::KdtreeRay => Box::new(kdtree_ray::KdtreeRay),
            Library::Kdray(options) => Box::new(kdray::Kdray::new(options)),
        };
        Ok(engine)
    }
}
