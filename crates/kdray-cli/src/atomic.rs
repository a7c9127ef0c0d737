//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::path::{Path, PathBuf};

use anyhow::Context;

/// Has `write` fill a temporary file beside `target`, then renames it. Whatever fails or is
/// cancelled leaves `target` as it was and no other file. Links are followed, and what is no plain
/// file, such as a pipe, is written to directly.
pub(crate) fn write(
    target: &Path,
    write: impl FnOnce(&mut File, &Path) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    write_inner(target, write).with_context(|| format!("cannot write {}", target.display()))
}

fn write_inner(
    target: &Path,
    write: impl FnOnce(&mut File, &Path) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    if fs::metadata(target).is_ok_and(|data| !data.is_file() && !data.is_dir()) {
        return write(&mut File::options().write(true).open(target)?, target);
    }
    let target = fs::canonicalize(target).unwrap_or_else(|_| target.to_path_buf());
    let mut temporary = builder().tempfile_in(folder(&target))?;
    let path = temporary.path().to_path_buf();
    write(temporary.as_file_mut(), &path)?;
    temporary.as_file().sync_all()?;
    temporary.persist(target)?;
    Ok(())
}

/// Fails if no file could be written at `target`: better now than after a long build.
pub(crate) fn check_writable(target: &Path) -> anyhow::Result<()> {
    let check = || {
        anyhow::ensure!(!target.is_dir(), "it is a folder");
        builder().tempfile_in(folder(target))?;
        Ok(())
    };
    check().with_context(|| format!("cannot write {}", target.display()))
}

/// The folder a file is in.
fn folder(file: &Path) -> PathBuf {
    match file.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_path_buf(),
        _ => PathBuf::from("."),
    }
}

/// Temporary files with the permissions of ordinary ones.
fn builder() -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".kdray-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn a_failure_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("file");
        fs::write(&target, "old").expect("written");
        let result = write(&target, |file, _| {
            file.write_all(b"half")?;
            anyhow::bail!("the disk is full")
        });
        let message = format!("{:#}", result.unwrap_err());
        assert!(message.ends_with("file: the disk is full"), "{message}");
        assert_eq!(fs::read(&target).expect("read"), b"old");
        assert_eq!(fs::read_dir(folder.path()).expect("listed").count(), 1);
    }

    #[test]
    fn success_replaces_the_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let target = folder.path().join("file");
        fs::write(&target, "old").expect("written");
        write(&target, |file, _| Ok(file.write_all(b"new")?)).expect("written");
        assert_eq!(fs::read(&target).expect("read"), b"new");
        assert_eq!(fs::read_dir(folder.path()).expect("listed").count(), 1);
    }
}
