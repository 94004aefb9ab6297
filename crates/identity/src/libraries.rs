//! Versions of libraries, from the lock file of the build.

use std::fs;
use std::path::{Path, PathBuf};

/// `name version` of the libraries that are named, as often as a lock file has them, in its order.
pub fn versions(lock: &str, names: &[&str]) -> Vec<String> {
    packages(lock)
        .filter(|(name, _)| names.contains(name))
        .map(|(name, version)| format!("{name}={version}"))
        .collect()
}

/// Name and version of all packages in a lock file, which Cargo writes in one form, a line a key.
fn packages(lock: &str) -> impl Iterator<Item = (&str, &str)> {
    lock.split("[[package]]").skip(1).filter_map(|package| {
        let find = |key| package.lines().find_map(|line| value(line, key));
        Some((find("name")?, find("version")?))
    })
}

fn value<'a>(line: &'a str, key: &str) -> Option<&'a str> {
    let rest = line.strip_prefix(key)?.strip_prefix(" = \"")?;
    rest.strip_suffix('"')
}

/// The lock file that this build goes by: that of the workspace, or where the crate is a dependency, that of whoever builds it.
pub(crate) fn lock_file(manifest: &Path, output: &Path, own: &(String, String)) -> Option<PathBuf> {
    let lists_us = |lock: &PathBuf| {
        let text = fs::read_to_string(lock).unwrap_or_default();
        packages(&text).any(|(name, version)| (name, version) == (&own.0, &own.1))
    };
    // A package of a registry carries a lock file of its own, which nobody goes by.
    let packaged =
        manifest.join(".cargo_vcs_info.json").exists() || manifest.join(".cargo-ok").exists();
    let above = manifest.ancestors().filter(|_| !packaged);
    above
        .chain(output.ancestors())
        .map(|folder| folder.join("Cargo.lock"))
        .find(lists_us)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOCK: &str = "version = 4\n\n[[package]]\nname = \"pulp\"\nversion = \"0.22.3\"\nsource = \"registry\"\n\n\
        [[package]]\nname = \"glam\"\nversion = \"0.30.10\"\n\n[[package]]\nname = \"glam\"\nversion = \"0.33.12\"\n";

    #[test]
    fn all_versions_of_a_library_are_told() {
        assert_eq!(
            versions(LOCK, &["glam", "absent"]),
            ["glam=0.30.10", "glam=0.33.12"]
        );
        assert_eq!(versions(LOCK, &["pulp"]), ["pulp=0.22.3"]);
    }

    #[test]
    fn the_lock_of_the_workspace_goes_before_that_of_the_output() {
        let folder = tempfile::tempdir().unwrap();
        let [workspace, target] = ["work", "target"].map(|name| folder.path().join(name));
        let manifest = workspace.join("crates/core");
        let output = target.join("release/build/core/out");
        for place in [&manifest, &output] {
            fs::create_dir_all(place).unwrap();
        }
        let own = ("pulp".to_owned(), "0.22.3".to_owned());
        assert_eq!(lock_file(&manifest, &output, &own), None);
        fs::write(target.join("Cargo.lock"), LOCK).unwrap();
        assert_eq!(
            lock_file(&manifest, &output, &own),
            Some(target.join("Cargo.lock"))
        );
        fs::write(workspace.join("Cargo.lock"), LOCK).unwrap();
        assert_eq!(
            lock_file(&manifest, &output, &own),
            Some(workspace.join("Cargo.lock"))
        );
        // In a package of a registry.
        fs::write(manifest.join(".cargo-ok"), "").unwrap();
        assert_eq!(
            lock_file(&manifest, &output, &own),
            Some(target.join("Cargo.lock"))
        );
        let other = ("pulp".to_owned(), "0.22.4".to_owned());
        assert_eq!(lock_file(&manifest, &output, &other), None);
    }
}
