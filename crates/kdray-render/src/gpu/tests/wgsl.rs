//! WGSL is what its lists say.

use std::collections::BTreeSet;
use std::mem::offset_of;
use std::path::Path;

use kdray_gpu::record::{Binding, Kernel, WORKGROUP};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, StorageAccess, TypeInner};

use crate::gpu::film::Cell;
use crate::gpu::kernels::{KERNELS, PATH, POINT, Params, RAY, SAMPLED};

fn kernels() -> impl Iterator<Item = (&'static Kernel, naga::Module)> {
    let all = KERNELS.iter().copied().chain([&SAMPLED]);
    all.map(|kernel| {
        let module = naga::front::wgsl::parse_str(kernel.source);
        let complaint = |error: naga::front::wgsl::ParseError| error.emit_to_string(kernel.source);
        (kernel, module.map_err(complaint).unwrap_or_else(|error| panic!("{error}")))
    })
}

#[test]
fn kernels_are_valid_and_bind_what_their_list_says() {
    for (kernel, module) in kernels() {
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        let checked = validator.validate(&module);
        checked.unwrap_or_else(|error| panic!("{}", error.emit_to_string(kernel.source)));
        let entry = &module.entry_points[0];
        assert_eq!((entry.name.as_str(), module.entry_points.len()), (kernel.name, 1));
        assert_eq!(entry.workgroup_size, [WORKGROUP, 1, 1], "{}", kernel.name);
        let mut bindings = vec![Binding::Uniform; module.global_variables.len()];
        bindings.resize(kernel.bindings.len(), Binding::Uniform);
        for (_, variable) in module.global_variables.iter() {
            let Some(binding) = variable.binding else { continue };
            bindings[binding.binding as usize] = match variable.space {
                AddressSpace::Uniform => Binding::Uniform,
                AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => {
                    Binding::Write
                }
                _ => Binding::Read,
            };
        }
        assert_eq!(bindings, kernel.bindings, "{}", kernel.name);
    }
}

/// Every WGSL file is a kernel, or a part of one.
#[test]
fn no_file_is_left_out() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/gpu");
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("an entry").path();
        if path.extension().is_some_and(|end| end == "wgsl") {
            let text = std::fs::read_to_string(&path).expect("it is text");
            let is_used = kernels().any(|(kernel, _)| kernel.source.contains(&text));
            assert!(is_used, "{} is in no kernel", path.display());
        }
    }
}

/// Members of a struct, and its size.
fn layout(module: &naga::Module, name: &str) -> Option<(Vec<(String, usize)>, usize)> {
    let (_, found) = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name))?;
    let TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is no struct") };
    let place = |member: &naga::StructMember| {
        (member.name.clone().expect("members have names"), member.offset as usize)
    };
    Some((members.iter().map(place).collect(), *span as usize))
}

macro_rules! places {
    ($($field:ident)*) => { [$((stringify!($field).to_owned(), offset_of!(Params, $field))),*] };
}

#[test]
fn what_kernels_share_has_one_layout() {
    let expected = places![
        bound at width height samples sample_bits first_pixel first_sample samples_here film_pixel
        bounce bounces counters eye reach right has_ground up ground_height forward ground_radius
        ground_center has_sun ground_colour has_parts vertical colours zenith sun_cos horizon unused
        below unused_too sun unused_either strength
    ];
    for (kernel, module) in kernels() {
        let (members, size) = layout(&module, "Params").expect("every kernel has parameters");
        assert_eq!(members, expected, "{}", kernel.name);
        assert_eq!(size, size_of::<Params>(), "{}", kernel.name);
        for (name, words) in [("Ray", RAY), ("Point", POINT), ("Path", PATH)] {
            if let Some((_, size)) = layout(&module, name) {
                assert_eq!(size as u64, 4 * words, "{name} of {}", kernel.name);
            }
        }
    }
}

#[test]
fn constants_have_the_values_of_rust() {
    let mut found = BTreeSet::new();
    for (kernel, module) in kernels() {
        for (_, constant) in module.constants.iter() {
            let name = constant.name.as_deref().unwrap_or_default();
            let value = match module.global_expressions[constant.init] {
                naga::Expression::Literal(naga::Literal::U32(value)) => f64::from(value),
                naga::Expression::Literal(naga::Literal::F32(value)) => f64::from(value),
                _ => continue,
            };
            let expected = match (kernel.name, name) {
                (_, "WORKGROUP") => f64::from(WORKGROUP),
                (_, "NONE") => f64::from(crate::gpu::kernels::NONE),
                ("accumulate", "CELL") => size_of::<Cell>() as f64 / 4.0,
                ("accumulate", "RAYS") => offset_of!(Cell, rays) as f64 / 4.0,
                ("accumulate", "HITS") => offset_of!(Cell, hits) as f64 / 4.0,
                ("shade_normals", "BACKGROUND") => crate::shade::normals::BACKGROUND.x.into(),
                ("shade_ao", "OPEN") => crate::shade::ao::OPEN.x.into(),
                ("shade_ao", "BACKDROP") => crate::shade::ao::BACKDROP.x.into(),
                _ => continue,
            };
            assert_eq!(value, expected, "{name} of {}", kernel.name);
            found.insert(name.to_owned());
        }
    }
    assert_eq!(found.len(), 8, "{found:?}");
}
