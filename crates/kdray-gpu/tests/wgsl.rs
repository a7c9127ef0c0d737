//! WGSL is accepted without a GPU: by naga always, and by Tint where its command is installed.

use std::path::Path;
use std::process::Command;

use kdray_gpu::float::Floats;
use kdray_gpu::record::{Binding, Kernel, TEAM, WORKGROUP};
use kdray_gpu::wgsl;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, StorageAccess};

const FLOATS: [Floats; 3] = [Floats::Hardware, Floats::SoftDivision, Floats::Soft];

/// Every kernel with every form of floats.
fn sources() -> impl Iterator<Item = (&'static Kernel, String)> {
    let kernels = wgsl::kernels().into_iter();
    kernels.flat_map(|kernel| FLOATS.map(|floats| (kernel, wgsl::compose(kernel.source, floats))))
}

#[test]
fn naga_accepts_every_kernel_and_finds_what_its_list_says() {
    let mut complaints = Vec::new();
    for (kernel, source) in sources() {
        match parse(&source) {
            Err(complaint) => complaints.push(format!("{}: {complaint}", kernel.name)),
            Ok(module) => complaints.extend(differences(kernel, &module)),
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

/// Every WGSL file of the crate: a kernel that is listed, or a part.
#[test]
fn no_file_is_left_out() {
    let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("src")];
    let mut found = 0;
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("the folder is there") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|end| end == "wgsl") {
                let text = std::fs::read_to_string(&path).expect("it is text");
                let stem = path.file_stem().expect("a name").to_string_lossy().into_owned();
                let is_kernel = |kernel: &Kernel| kernel.name == stem && kernel.source == text;
                let is_listed = wgsl::kernels().into_iter().any(is_kernel)
                    || wgsl::parts().any(|part| part.1 == text);
                assert!(is_listed, "{} is in no list of `wgsl`", path.display());
                found += 1;
            }
        }
    }
    assert_eq!(found, wgsl::kernels().len() + wgsl::parts().count());
}

fn parse(source: &str) -> Result<naga::Module, String> {
    let module = naga::front::wgsl::parse_str(source);
    let module = module.map_err(|error| error.emit_to_string(source))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let checked = validator.validate(&module);
    checked.map_err(|error| error.emit_to_string(source))?;
    Ok(module)
}

/// Where the WGSL of a kernel is not what its `Kernel` says.
fn differences(kernel: &Kernel, module: &naga::Module) -> Vec<String> {
    let mut found = Vec::new();
    match module.entry_points.as_slice() {
        [entry]
            if entry.name == kernel.name
                && [WORKGROUP, TEAM].map(|size| [size, 1, 1]).contains(&entry.workgroup_size) => {}
        entries => found.push(format!("{}: entry points {entries:?}", kernel.name)),
    }
    for (_, variable) in module.global_variables.iter() {
        let Some(binding) = variable.binding.filter(|binding| binding.group == 0) else { continue };
        let access = match variable.space {
            AddressSpace::Uniform => Binding::Uniform,
            AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => {
                Binding::Write
            }
            _ => Binding::Read,
        };
        if kernel.bindings.get(binding.binding as usize) != Some(&access) {
            found.push(format!("{}: binding {} is {access:?}", kernel.name, binding.binding));
        }
    }
    found
}

#[test]
fn tint_accepts_every_kernel() {
    let found = Command::new("tint").arg("--help").output();
    if found.is_err() {
        assert!(std::env::var_os("CI").is_none(), "CI needs the command `tint`");
        println!("skipped: there is no command `tint` here");
        return;
    }
    let folder = std::env::temp_dir();
    for (index, (kernel, source)) in sources().enumerate() {
        let path =
            folder.join(format!("kdray-{}-{index}-{}.wgsl", std::process::id(), kernel.name));
        std::fs::write(&path, source).expect("the folder can be written");
        let output = Command::new("tint").args(["--format", "wgsl"]).arg(&path).output();
        let output = output.expect("tint starts");
        std::fs::remove_file(&path).expect("it was written");
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{}: {said}", kernel.name);
    }
}
