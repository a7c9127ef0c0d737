//! Collects the compiler's and the dependencies' versions for the records.

fn main() {
    built::write_built_file().expect("the build folder is writable");
}
