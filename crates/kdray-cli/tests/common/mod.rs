//! What all tests of the command need.

use std::fs;
use std::path::PathBuf;

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

/// A folder with meshes in it, and the command run in it.
pub(crate) struct Bench {
    folder: TempDir,
}

impl Bench {
    pub(crate) fn new() -> Self {
        let bench = Self { folder: tempfile::tempdir().expect("a temporary folder") };
        bench.write("knot.off", &off(&kdray_mesh::generate::torus_knot([2, 3], 60, 12)));
        bench.write("cube.off", &off(&kdray_mesh::generate::cube()));
        bench
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: &str) {
        fs::write(self.path(name), content).expect("the folder can be written");
    }

    /// The names of all files, in order.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path()).expect("the folder can be read");
        let name = |entry: fs::DirEntry| entry.file_name().into_string().expect("a plain name");
        let mut names: Vec<String> = entries.map(|entry| name(entry.expect("an entry"))).collect();
        names.sort();
        names
    }

    /// The command, with arguments that spaces part.
    pub(crate) fn kdray(&self, arguments: &str) -> Command {
        let mut command = Command::new(assert_cmd::cargo::cargo_bin!("kdray"));
        command.current_dir(self.folder.path()).args(arguments.split_whitespace());
        // Mesa complains on standard error where this is not set.
        command.env("XDG_RUNTIME_DIR", self.folder.path());
        command
    }

    /// The one JSON object that a successful command prints.
    pub(crate) fn json(&self, arguments: &str) -> Value {
        let output = self.kdray(arguments).assert().success().get_output().stdout.clone();
        let value: Value = serde_json::from_slice(&output).expect("one JSON value and no more");
        assert!(value.is_object(), "{value}");
        value
    }

    /// The one line that a failing command says on standard error.
    pub(crate) fn error(&self, arguments: &str) -> String {
        let output = self.kdray(arguments).assert().code(1).get_output().stderr.clone();
        let text = String::from_utf8(output).expect("text");
        assert_eq!(text.lines().count(), 1, "{text}");
        text.strip_prefix("kdray: error: ").expect(&text).trim_end().to_owned()
    }
}

/// The text of an OFF file.
fn off(mesh: &kdray_mesh::Loaded) -> String {
    let mut text = format!("OFF\n{} {} 0\n", mesh.positions.len(), mesh.triangles.len());
    for [x, y, z] in &mesh.positions {
        text += &format!("{x} {y} {z}\n");
    }
    for [a, b, c] in &mesh.triangles {
        text += &format!("3 {a} {b} {c}\n");
    }
    text
}
