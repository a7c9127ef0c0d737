//! WGSL: the parts that kernels share, and how a kernel's text is put together.

#[cfg(test)]
mod layout;

use crate::build;
use crate::float::{Floats, probe};
use crate::primitives;
use crate::record::{Kernel, MEASURE};
use crate::trace;

/// A part's name and text.
pub type Part = (&'static str, &'static str);

/// The parts that a line `//#import name` stands for. `float` is several, as the device has it.
pub fn parts() -> impl Iterator<Item = Part> {
    PARTS.iter().chain(build::PARTS).chain(trace::PARTS).copied()
}

const PARTS: &[Part] = &[
    ("count", include_str!("count.wgsl")),
    ("arg_min_tree", include_str!("../primitives/arg_min_tree.wgsl")),
    ("arg_min_value", include_str!("../primitives/arg_min_value.wgsl")),
    ("radix_tile", include_str!("../primitives/radix_tile.wgsl")),
    ("scan_tile", include_str!("../primitives/scan_tile.wgsl")),
    ("double", include_str!("../float/double.wgsl")),
    ("double_product", include_str!("../float/double_product.wgsl")),
    ("float_pack", include_str!("../float/pack.wgsl")),
    ("float_hardware", include_str!("../float/hardware.wgsl")),
    ("float_hardware_div", include_str!("../float/hardware_div.wgsl")),
    ("float_soft", include_str!("../float/soft.wgsl")),
    ("float_probe", include_str!("../float/probe_body.wgsl")),
    ("float_soft_div", include_str!("../float/soft_div.wgsl")),
];

/// Every kernel.
#[must_use]
pub fn kernels() -> Vec<&'static Kernel> {
    let mut kernels = vec![&MEASURE, &probe::HARDWARE, &probe::SOFT, &probe::DOUBLE];
    kernels.extend(primitives::kernels());
    kernels.extend(build::KERNELS.iter().map(|kernel| &kernel.shader));
    kernels.extend(trace::KERNELS);
    kernels
}

/// `source` with its imports, each once, ahead of it.
///
/// # Panics
///
/// If a part is not one of [`parts`]; the tests compose every kernel.
#[must_use]
pub fn compose(source: &str, floats: Floats) -> String {
    let mut text = String::new();
    import(source, floats, &mut Vec::new(), &mut text);
    text
}

/// Whether `source`, or a part that it imports, has the floats that depend on the device.
pub(crate) fn has_floats(source: &str) -> bool {
    let mut imports = source.lines().filter_map(|line| line.strip_prefix("//#import "));
    imports.any(|name| name == "float" || parts().any(|part| part.0 == name && has_floats(part.1)))
}

fn import<'a>(source: &'a str, floats: Floats, known: &mut Vec<&'a str>, text: &mut String) {
    for line in source.lines() {
        match line.strip_prefix("//#import ") {
            Some("float") => {
                floats.parts().into_iter().for_each(|part| import_part(part, floats, known, text));
            }
            Some(name) => import_part(name, floats, known, text),
            None => {
                text.push_str(line);
                text.push('\n');
            }
        }
    }
}

fn import_part<'a>(name: &'a str, floats: Floats, known: &mut Vec<&'a str>, text: &mut String) {
    if known.contains(&name) {
        return;
    }
    known.push(name);
    let part = parts().find(|part| part.0 == name);
    let (_, source) = part.unwrap_or_else(|| panic!("no part is called {name:?}"));
    import(source, floats, known, text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_imported_once_and_floats_as_asked() {
        let source = "//#import count\n//#import count\n//#import float\nlast";
        let part = |name| parts().find(|part| part.0 == name).expect("a part").1;
        let floats: String = Floats::SoftDivision.parts().into_iter().map(part).collect();
        let expected = format!("{}{floats}last\n", part("count"));
        assert_eq!(compose(source, Floats::SoftDivision), expected);
    }

    #[test]
    fn kernels_whose_parts_have_floats_are_compiled_for_the_device() {
        for kernel in kernels() {
            let [hardware, soft] =
                [Floats::Hardware, Floats::Soft].map(|floats| compose(kernel.source, floats));
            assert_eq!(has_floats(kernel.source), hardware != soft, "{}", kernel.name);
        }
    }
}
