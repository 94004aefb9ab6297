//! The identity of a build: two builds with the same one compute the same bits on the same instruction set.
//!
//! Every crate that computes has a build script of one line, [`emit`], which hashes the sources of the crate and the data beside
//! them. The core joins these hashes with [`versions`] of the libraries that compute, the compiler, the target and its features.
//! Comments, documentation and tests are left out, so that they change no identity; neither time nor place is in it, so that it
//! is the same from a checkout, a source distribution and a package.

#![expect(
    clippy::print_stdout,
    reason = "build scripts talk to Cargo by what they print"
)]

mod libraries;
mod tokens;

use std::env;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

use xxhash_rust::xxh3::Xxh3;

pub use libraries::versions;
pub use tokens::tokens;

/// A hash that is being made, of parts that are kept apart.
#[derive(Default)]
pub struct Hash(Xxh3);

impl std::fmt::Debug for Hash {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.digits())
    }
}

impl Hash {
    /// Takes in a part; its length goes first, so that no two lists of parts look alike.
    pub fn part(&mut self, bytes: &[u8]) {
        self.0.update(&(bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    /// The hash as sixteen hexadecimal digits.
    pub fn digits(&self) -> String {
        format!("{:016x}", self.0.digest())
    }
}

/// Gives the crate that is built the hash of its sources, as `env!("CHAINDRIVE_SOURCES")`.
///
/// `data` are files and folders beside `src` that are compiled in.
///
/// # Panics
/// If the sources of the crate cannot be read: there is nothing to build.
pub fn emit(data: &[&str]) {
    let root = PathBuf::from(variable("CARGO_MANIFEST_DIR"));
    let hash = sources(&root, data).unwrap_or_else(|error| panic!("{}: {error}", root.display()));
    println!("cargo::rerun-if-changed=src");
    for place in data {
        println!("cargo::rerun-if-changed={place}");
    }
    println!("cargo::rustc-env=CHAINDRIVE_SOURCES={hash}");
}

/// Tells the core, beside its own sources, what else decides about bits: `CHAINDRIVE_COMPILER`, `CHAINDRIVE_TARGET`,
/// `CHAINDRIVE_FEATURES` and `CHAINDRIVE_LIBRARIES`, the versions of the libraries that are named, as the lock file has them.
///
/// `CHAINDRIVE_PROFILE` is told beside them: the profile of Cargo decides about speed and about no bit.
///
/// # Panics
/// If there is no lock file: a build whose libraries are unknown has no identity.
pub fn emit_surroundings(libraries: &[&str]) {
    let compiler = Command::new(variable("RUSTC")).arg("--version").output();
    let compiler = compiler.expect("the compiler that builds this can be asked for its version");
    let compiler = String::from_utf8_lossy(&compiler.stdout);
    println!("cargo::rustc-env=CHAINDRIVE_COMPILER={}", compiler.trim());
    println!("cargo::rustc-env=CHAINDRIVE_TARGET={}", variable("TARGET"));
    let features = env::var("CARGO_CFG_TARGET_FEATURE").unwrap_or_default();
    println!("cargo::rustc-env=CHAINDRIVE_FEATURES={features}");
    let manifest = PathBuf::from(variable("CARGO_MANIFEST_DIR"));
    let output = PathBuf::from(variable("OUT_DIR"));
    let profile = profile(&output).map_or_else(|| variable("PROFILE"), str::to_owned);
    println!("cargo::rustc-env=CHAINDRIVE_PROFILE={profile}");
    let own = (variable("CARGO_PKG_NAME"), variable("CARGO_PKG_VERSION"));
    let lock = libraries::lock_file(&manifest, &output, &own).unwrap_or_else(|| {
        panic!(
            "no Cargo.lock lists {} {}: build in a folder that has one",
            own.0, own.1
        )
    });
    println!("cargo::rerun-if-changed={}", lock.display());
    let text = fs::read_to_string(&lock).expect("the lock file was found by reading it");
    let versions = versions(&text, libraries).join(" ");
    println!("cargo::rustc-env=CHAINDRIVE_LIBRARIES={versions}");
}

/// Name of the profile, by the folder `target/…/PROFILE/build/PACKAGE/out` of a build script: the variable `PROFILE` names only
/// which of `debug` and `release` a profile inherits.
fn profile(output: &Path) -> Option<&str> {
    let mut above = output.ancestors().skip(2);
    let build = above.next()?.file_name()?;
    let profile = above.next()?.file_name()?.to_str()?;
    (build == "build").then_some(if profile == "debug" { "dev" } else { profile })
}

fn variable(name: &str) -> String {
    env::var(name).unwrap_or_else(|_| panic!("{name} is not set: this is for build scripts"))
}

/// Hash of the sources below `root/src`, and of the files and folders in `data`.
///
/// Rust is taken as its [`tokens`], everything else as its text. Paths count, in their order and with `/`; line ends do not.
///
/// # Errors
/// An unreadable file, or a file that is not Rust.
pub fn sources(root: &Path, data: &[&str]) -> io::Result<String> {
    let mut files = Vec::new();
    for place in std::iter::once("src").chain(data.iter().copied()) {
        list(root, place, &mut files)?;
    }
    files.sort();
    let mut rust = Vec::new();
    let mut tests = Vec::new();
    let mut hash = Hash::default();
    for path in files {
        let text = fs::read_to_string(root.join(&path))
            .map_err(|error| io::Error::new(error.kind(), format!("{path}: {error}")))?
            .replace("\r\n", "\n");
        if Path::new(&path).extension().is_some_and(|it| it == "rs") {
            let found = tokens(&text).map_err(|error| {
                io::Error::new(io::ErrorKind::InvalidData, format!("{path}: {error}"))
            })?;
            let home = home(&path);
            tests.extend(
                found
                    .test_modules
                    .iter()
                    .map(|name| format!("{home}/{name}")),
            );
            rust.push((path, found.text));
        } else {
            hash.part(path.as_bytes());
            hash.part(text.as_bytes());
        }
    }
    let is_test = |path: &str| {
        tests.iter().any(|module| {
            let rest = path.strip_prefix(module.as_str());
            rest.is_some_and(|rest| rest == ".rs" || rest.starts_with('/'))
        })
    };
    for (path, text) in rust.iter().filter(|(path, _)| !is_test(path)) {
        hash.part(path.as_bytes());
        hash.part(text.as_bytes());
    }
    Ok(hash.digits())
}

/// The folder in which the modules of a file lie.
fn home(path: &str) -> &str {
    let stem = path.trim_end_matches(".rs");
    let own = ["/lib", "/main", "/mod"];
    own.iter()
        .find_map(|name| stem.strip_suffix(name))
        .unwrap_or(stem)
}

fn list(root: &Path, place: &str, files: &mut Vec<String>) -> io::Result<()> {
    if !root.join(place).is_dir() {
        files.push(place.to_owned());
        return Ok(());
    }
    for entry in fs::read_dir(root.join(place))? {
        let name = entry?.file_name();
        let name = name.to_str().ok_or_else(|| {
            io::Error::new(
                io::ErrorKind::InvalidData,
                format!("{place}: a name that is no text"),
            )
        })?;
        list(root, &format!("{place}/{name}"), files)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAW: &str = "//! A law.\n\n/// Stiffness.\nconst K: f64 = 1.2e9; // steel\n\n\
        pub fn force(x: f64) -> f64 {\n    K * x\n}\n\n#[cfg(test)]\nmod tests;\n";

    fn tree(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        for (path, text) in files {
            let path = folder.path().join(path);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        }
        folder
    }

    fn hash_of(law: &str, test: &str, data: &str) -> String {
        let folder = tree(&[
            ("src/lib.rs", "mod law;\n"),
            ("src/law.rs", law),
            ("src/law/tests.rs", test),
            ("src/law/tests/more.rs", test),
            ("data/chain.csv", data),
        ]);
        sources(folder.path(), &["data"]).unwrap()
    }

    /// Whatever cannot move a number leaves the identity; a digit of a constant, a word of the data or a name do not.
    #[test]
    fn what_computes_counts_and_what_explains_does_not() {
        let own = hash_of(LAW, "", "a,b\n");
        let same = [
            hash_of(
                &LAW.replace("// steel", "// hardened steel, μ = 0.1"),
                "",
                "a,b\n",
            ),
            hash_of(
                &LAW.replace("/// Stiffness.", "/// Stiffness \\[N/m\\].\n#[doc(hidden)]"),
                "",
                "a,b\n",
            ),
            hash_of(&LAW.replace('\n', "\r\n"), "", "a,b\r\n"),
            hash_of(&LAW.replace("    K * x", "        K\n    * x"), "", "a,b\n"),
            hash_of(LAW, "#[test]\nfn another() {}\n", "a,b\n"),
        ];
        for (case, hash) in same.iter().enumerate() {
            assert_eq!(*hash, own, "{case}");
        }
        let other = [
            hash_of(&LAW.replace("1.2e9", "1.3e9"), "", "a,b\n"),
            hash_of(&LAW.replace("K * x", "K + x"), "", "a,b\n"),
            hash_of(&LAW.replace("#[cfg(test)]\n", ""), "", "a,b\n"),
            hash_of(LAW, "", "a,c\n"),
        ];
        for (case, hash) in other.iter().enumerate() {
            assert_ne!(*hash, own, "{case}");
        }
    }

    #[test]
    fn the_profile_is_that_of_the_folder() {
        for (output, name) in [
            ("target/quick/build/chaindrive-1f/out", Some("quick")),
            (
                "target/aarch64-apple-darwin/release/build/chaindrive-1f/out",
                Some("release"),
            ),
            ("target/debug/build/chaindrive-1f/out", Some("dev")),
            ("elsewhere/chaindrive/1f/out", None),
            ("out", None),
        ] {
            assert_eq!(profile(Path::new(output)), name, "{output}");
        }
    }

    #[test]
    fn a_file_that_moves_is_another_source() {
        let [first, second] = ["src/a.rs", "src/b.rs"].map(|path| {
            let folder = tree(&[("src/lib.rs", ""), (path, "const A: u8 = 1;")]);
            sources(folder.path(), &[]).unwrap()
        });
        assert_ne!(first, second);
    }

    #[test]
    fn what_is_not_rust_is_told_with_its_place() {
        let folder = tree(&[("src/lib.rs", "fn broken( {")]);
        let error = sources(folder.path(), &[]).unwrap_err().to_string();
        assert!(error.starts_with("src/lib.rs: "), "{error}");
    }
}
