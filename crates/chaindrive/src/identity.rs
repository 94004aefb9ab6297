//! Origin of a result: the build of the program with the laws that are registered in it, and the instruction set in use.
//!
//! Two results are equal to the last bit where both agree and the scene is the same. Stores of sweeps, their workers, snapshots
//! and checkpoints are continued by nobody else. More laws than a result has are no hindrance: its scene names none of them.

use std::fmt;
use std::sync::LazyLock;

use chaindrive_integrate::{InstructionSet, Registers};
use serde::{Deserialize, Serialize};
use xxhash_rust::xxh3::xxh3_64;

use crate::laws;

/// Stands before each law of an identity.
const LAW: char = '+';

/// Everything of a build that decides about bits, but for the instruction set, which is a matter of the process.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Build {
    /// Version of the program, such as 0.2.0.
    pub version: &'static str,
    /// Crates that compute, each with the hash of its sources and of the data compiled in: tokens without comments,
    /// documentation and tests.
    pub sources: [(&'static str, &'static str); 6],
    /// Libraries that compute, as `name=version` with spaces between.
    pub libraries: &'static str,
    /// The compiler, as it tells its version.
    pub compiler: &'static str,
    /// Triple of the target.
    pub target: &'static str,
    /// Features of the processor that the compiler may use everywhere, with commas between.
    pub features: &'static str,
    /// Profile of Cargo, such as `release`: it decides about speed, and is no part of the identity.
    pub profile: &'static str,
    /// Laws of other crates with their revisions, such as `friction:stribeck=1`.
    pub laws: Vec<String>,
    /// The identity: version, a hash of all that stands above, and the laws, such as `0.2.0-5f3a9c01d2e47b66+friction:stribeck=1`.
    pub id: String,
}

impl Build {
    /// The build that runs here. No law can be registered afterwards.
    pub fn here() -> &'static Self {
        static HERE: LazyLock<Build> = LazyLock::new(|| {
            let mut build = Build {
                version: env!("CARGO_PKG_VERSION"),
                sources: [
                    ("quantities", chaindrive_quantities::SOURCES),
                    ("geometry", chaindrive_geometry::SOURCES),
                    ("contact", chaindrive_contact::SOURCES),
                    ("integrate", chaindrive_integrate::SOURCES),
                    ("mechanics", chaindrive_mechanics::SOURCES),
                    ("chaindrive", env!("CHAINDRIVE_SOURCES")),
                ],
                libraries: env!("CHAINDRIVE_LIBRARIES"),
                compiler: env!("CHAINDRIVE_COMPILER"),
                target: env!("CHAINDRIVE_TARGET"),
                features: env!("CHAINDRIVE_FEATURES"),
                profile: env!("CHAINDRIVE_PROFILE"),
                laws: Vec::new(),
                id: String::new(),
            };
            let whole = xxh3_64(build.to_string().as_bytes());
            build.id = format!("{}-{whole:016x}", build.version);
            build.laws = laws::revisions();
            for law in &build.laws {
                build.id.push(LAW);
                build.id.push_str(law);
            }
            build
        });
        &HERE
    }
}

/// Everything, a line each.
impl fmt::Display for Build {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.id.is_empty() {
            writeln!(f, "build         {}", self.id)?;
            writeln!(f, "profile       {}", self.profile)?;
        }
        for (name, hash) in self.sources {
            writeln!(f, "  {name:<12}{hash}")?;
        }
        for library in self.libraries.split(' ') {
            let (name, version) = library.split_once('=').unwrap_or((library, ""));
            writeln!(f, "  {name:<16}{version}")?;
        }
        writeln!(f, "compiler      {}", self.compiler)?;
        writeln!(f, "target        {}", self.target)?;
        write!(f, "features      {}", self.features)?;
        for law in &self.laws {
            write!(f, "\nlaw           {law}")?;
        }
        Ok(())
    }
}

/// The build and the instruction set that a result is of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Origin {
    /// Identity of the build ([`Build::id`]).
    pub build: String,
    /// Name of the instruction set.
    pub instruction_set: String,
}

impl Origin {
    /// Those of this process.
    pub fn here() -> Self {
        Self {
            build: Build::here().id.clone(),
            instruction_set: Registers::in_use().set().name().to_owned(),
        }
    }

    /// The build without laws, and these.
    fn parts(&self) -> (&str, Vec<&str>) {
        let mut parts = self.build.split(LAW);
        (parts.next().unwrap_or_default(), parts.collect())
    }

    /// Why this process does not go on with what is of this origin, and what to do; none where it may.
    pub fn refusal(&self) -> Option<String> {
        let here = Self::here();
        let [(build, laws), (own, known)] = [self, &here].map(Self::parts);
        if build != own {
            return Some(format!(
                "it is of chaindrive {}, and here is {}: another build computes other bits; go on with the build that \
                 began it, or begin anew",
                self.build, here.build
            ));
        }
        if let Some(law) = laws.iter().find(|law| !known.contains(law)) {
            let name = law.split('=').next();
            let other = known.iter().find(|own| own.split('=').next() == name);
            let other = other.map_or("no law of that name".to_owned(), |own| format!("`{own}`"));
            return Some(format!(
                "it has the law `{law}`, and here is {other}: go on with a program that registers `{law}`, or begin anew"
            ));
        }
        if self.instruction_set == here.instruction_set {
            return None;
        }
        let available = InstructionSet::available().any(|set| set.name() == self.instruction_set);
        let remedy = if available {
            format!("set {}={}", InstructionSet::VARIABLE, self.instruction_set)
        } else {
            "go on with a processor that has it".to_owned()
        };
        Some(format!(
            "it is of the instruction set {}, and here is {}: bits differ between them; {remedy}, or begin anew",
            self.instruction_set, here.instruction_set
        ))
    }
}

/// The origin of stores and bytes from before builds had identities.
impl Default for Origin {
    fn default() -> Self {
        Self {
            build: "0.1.0".to_owned(),
            instruction_set: String::new(),
        }
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} on {}", self.build, self.instruction_set)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn this_process_goes_on_with_its_own() {
        assert_eq!(Origin::here().refusal(), None);
        let id = &Build::here().id;
        let hash = id
            .strip_prefix(concat!(env!("CARGO_PKG_VERSION"), "-"))
            .unwrap();
        assert!(
            hash.len() == 16 && u64::from_str_radix(hash, 16).is_ok(),
            "{id}"
        );
    }

    #[test]
    fn the_profile_is_told_and_is_no_part_of_the_identity() {
        let here = Build::here();
        assert!(
            here.to_string()
                .contains(&format!("\nprofile       {}\n", here.profile))
        );
        let hashed = Build {
            id: String::new(),
            laws: Vec::new(),
            ..here.clone()
        };
        let hash = xxh3_64(hashed.to_string().as_bytes());
        assert!(here.id.contains(&format!("-{hash:016x}")), "{}", here.id);
        assert!(!hashed.to_string().contains("profile"));
    }

    #[test]
    fn another_build_or_set_is_refused_with_both_and_what_to_do() {
        let here = Origin::here();
        let other = Origin {
            build: "0.2.0-0123456789abcdef".to_owned(),
            ..here.clone()
        };
        let told = other.refusal().unwrap();
        assert!(
            told.contains(&other.build) && told.contains(&here.build),
            "{told}"
        );
        assert!(
            Origin::default()
                .refusal()
                .unwrap()
                .contains("chaindrive 0.1.0,")
        );
        let law = "friction:stribeck=2";
        let other = Origin {
            build: format!("{}+{law}", here.build),
            ..here.clone()
        };
        let told = other.refusal().unwrap();
        assert!(
            told.contains(&format!("`{law}`, and here is no law of that name")),
            "{told}"
        );
        for set in InstructionSet::available().filter(|set| set.name() != here.instruction_set) {
            let other = Origin {
                instruction_set: set.name().to_owned(),
                ..here.clone()
            };
            let told = other.refusal().unwrap();
            assert!(
                told.contains(&format!("set CHAINDRIVE_INSTRUCTION_SET={set}")),
                "{told}"
            );
        }
        let other = Origin {
            instruction_set: "avx1024".to_owned(),
            ..here
        };
        assert!(other.refusal().unwrap().contains("a processor that has it"));
    }
}
