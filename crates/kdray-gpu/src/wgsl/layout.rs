//! The uniforms and constants of kernels are those of Rust.

use std::mem::offset_of;

use naga::{AddressSpace, Literal, TypeInner};

use super::compose;
use crate::build::{KERNELS, PIECE, Params as BuildParams, ROOM, SMALL, WAITING, Worker};
use crate::float::Floats;
use crate::primitives::{arg_min, compact, radix, scan, segmented};
use crate::record::{CountParams, Kernel, MEASURE, ROW, TEAM, TILE, WORKGROUP};
use crate::trace::{self, KERNELS as TRACE_KERNELS, Params as TraceParams, recipe};

fn parse(kernel: &Kernel) -> naga::Module {
    let source = compose(kernel.source, Floats::Soft);
    naga::front::wgsl::parse_str(&source).expect("kernels are valid")
}

/// Members of the kernel's uniform, and its size.
fn uniform(kernel: &Kernel) -> (Vec<(String, usize)>, usize) {
    let module = parse(kernel);
    let is_params = |variable: &naga::GlobalVariable| {
        variable.space == AddressSpace::Uniform
            && variable.binding.is_some_and(|binding| binding.group == 0)
    };
    let mut variables = module.global_variables.iter().map(|(_, variable)| variable);
    let params = variables.find(|variable| is_params(variable)).expect("it has parameters");
    let TypeInner::Struct { members, span } = &module.types[params.ty].inner else {
        panic!("the parameters of {} are no struct", kernel.name);
    };
    let named = |member: &naga::StructMember| {
        (member.name.clone().expect("members have names"), member.offset as usize)
    };
    (members.iter().map(named).collect(), *span as usize)
}

/// Fails unless the kernel's uniform has just the named fields of a Rust struct, where that has
/// them.
macro_rules! same_layout {
    ($kernel:expr, $params:ty { $($field:ident),* }) => {
        let fields = [$((stringify!($field).to_owned(), offset_of!($params, $field))),*];
        let (members, size) = uniform($kernel);
        assert_eq!(members, fields, "{}", $kernel.name);
        assert!(size <= size_of::<$params>(), "{}: {size} bytes", $kernel.name);
    };
}

#[test]
fn uniforms_have_the_layout_of_their_structs() {
    for kernel in [&MEASURE, &scan::REDUCE, &segmented::BASES] {
        same_layout!(kernel, CountParams { bound, at, per, unused });
    }
    same_layout!(&scan::APPLY, scan::ApplyParams { count, total_at, has_sums });
    same_layout!(&compact::COMPACT, compact::Params { count, total_at });
    same_layout!(&segmented::APPLY, segmented::Params { count, segments });
    for kernel in [&radix::COUNT, &radix::SCATTER] {
        same_layout!(kernel, radix::Params { count, tiles, shift });
    }
    same_layout!(&arg_min::REDUCE, arg_min::ReduceParams { count, level, below, to, width });
    same_layout!(&arg_min::QUERY, arg_min::QueryParams { count, levels, width, unused, starts });
    for kernel in TRACE_KERNELS {
        same_layout!(
            kernel,
            TraceParams { count, has_except, is_counted, reach, lower, unused, upper, steps }
        );
    }
    for kernel in KERNELS {
        same_layout!(
            &kernel.shader,
            BuildParams {
                count,
                nodes,
                next_nodes,
                events,
                next_events,
                fresh_events,
                straddlers,
                left,
                right,
                leaf,
                gone,
                records,
                next_records,
                finished,
                run,
                may_split,
                max_leaf,
                clip,
                traversal,
                intersect,
                empty_factor,
                triangles,
                first_node,
                depth_left,
                piece_words,
                axis,
                base_axis,
                has_bounds
            }
        );
    }
}

#[test]
fn workgroups_have_the_size_of_who_works_on_an_element() {
    for kernel in KERNELS {
        let size = match kernel.by {
            Worker::Invocation => WORKGROUP,
            Worker::Team => TEAM,
        };
        let entry = &parse(&kernel.shader).entry_points[0];
        assert_eq!(entry.workgroup_size, [size, 1, 1], "{}", kernel.shader.name);
    }
}

#[test]
fn constants_have_the_values_of_rust() {
    let mut of_build = KERNELS.iter().map(|kernel| &kernel.shader);
    let finish = of_build.find(|shader| shader.name == "finish").expect("it is listed");
    let expected = [
        (&MEASURE, "WORKGROUP", WORKGROUP),
        (finish, "TEAM", TEAM),
        (finish, "SMALL", SMALL),
        (finish, "ROOM", ROOM as u32),
        (finish, "WAITING", WAITING as u32),
        (finish, "PIECE", PIECE),
        (&MEASURE, "TILE", TILE),
        (&MEASURE, "ROW", ROW),
        (&scan::APPLY, "NOWHERE", scan::NOWHERE),
        (&radix::COUNT, "DIGITS", radix::DIGITS as u32),
        (&arg_min::QUERY, "BLOCK", arg_min::BLOCK),
        (&arg_min::QUERY, "NONE", arg_min::NONE),
    ];
    let recipe = recipe_constants().map(|(name, value)| (&trace::LOCATE, name, value));
    for (kernel, name, value) in expected.into_iter().chain(recipe) {
        assert_eq!(constant(kernel, name), value, "{name} of {}", kernel.name);
    }
}

fn constant(kernel: &Kernel, name: &str) -> u32 {
    let module = parse(kernel);
    let mut constants = module.constants.iter().map(|(_, constant)| constant);
    let found = constants.find(|constant| constant.name.as_deref() == Some(name));
    let found = found.unwrap_or_else(|| panic!("{} has no {name}", kernel.name));
    match module.global_expressions[found.init] {
        naga::Expression::Literal(Literal::U32(value)) => value,
        ref other => panic!("{name} of {} is {other:?}", kernel.name),
    }
}

#[test]
fn private_memory_is_what_is_said() {
    let bytes = [&trace::CLOSEST, &trace::LOCATE].map(|kernel| {
        let module = parse(kernel);
        let variables = module.global_variables.iter().map(|(_, variable)| variable);
        let own = variables.filter(|variable| variable.space == AddressSpace::Private);
        own.map(|variable| module.types[variable.ty].inner.size(module.to_ctx())).sum::<u32>()
    });
    assert_eq!(bytes, trace::PRIVATE_BYTES);
}

macro_rules! named {
    ($($name:ident)*) => { [$((stringify!($name), recipe::$name)),*] };
}

/// What the shader must know of the recipe.
fn recipe_constants() -> [(&'static str, u32); 23] {
    named![
        SUB MUL DIV ONE MINUS_ONE DIRECTION ORIGIN T_PER_Z SHEAR CORNERS ENDS EDGES SHARE DISTANCE
        RESULT CELLS SLOPES_END POINTS_END EDGE_END WEIGHTS_END NEAREST_END FOOT_END STEPS_END
    ]
}
