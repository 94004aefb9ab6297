//! Values as bytes that say what they are, of which origin, and whether they are whole.
//!
//! ```text
//! chaindrive checkpoint, build 0.2.0-5f3a9c01d2e47b66, instruction set avx2, checksum 5f3a9c01↵
//! the value, by postcard: every number to its last bit
//! ```
//!
//! The layout of a value changes with the program, and another build goes on with other bits, so that only the build that
//! wrote a value reads it.

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::Origin;

/// Words before the parts of the origin.
const BUILD: &str = "build ";
const INSTRUCTION_SET: &str = "instruction set ";

/// Values that can be written down.
pub trait SealedValue: Serialize + DeserializeOwned {
    /// Its name in messages and in the first line.
    const KIND: &'static str;
}

/// Why bytes cannot be read back.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[expect(missing_docs, reason = "each message names its fields")]
pub enum SealError {
    /// They are something else.
    #[error("this is no {kind} of chaindrive")]
    Foreign { kind: &'static str },

    /// Another build has written them, or one on another instruction set.
    #[error("the {kind} cannot be read: {refusal}")]
    Origin { kind: &'static str, refusal: String },

    /// They are not all there, or not what was written.
    #[error("the {kind} is damaged: its content is not what was written")]
    Damaged { kind: &'static str },
}

/// A value as bytes.
///
/// # Panics
/// Never: the values are plain data, and the memory takes them.
pub fn sealed<T: SealedValue>(value: &T) -> Vec<u8> {
    let content = postcard::to_stdvec(value).expect("plain data has a length known beforehand");
    let mut bytes = heading::<T>(&Origin::here(), &content).into_bytes();
    bytes.extend(content);
    bytes
}

/// The value that bytes were made of.
///
/// # Errors
/// [`SealError`]: something else, damaged, or of another build or instruction set.
pub fn opened<T: SealedValue>(bytes: &[u8]) -> Result<T, SealError> {
    let kind = T::KIND;
    let foreign = || SealError::Foreign { kind };
    let end = bytes.iter().position(|byte| *byte == b'\n');
    let (line, content) = bytes.split_at(end.ok_or_else(foreign)?);
    let content = &content[1..];
    let line = str::from_utf8(line).map_err(|_| foreign())?;
    let parts: Vec<&str> = line.split(", ").collect();
    let &[what, build, instruction_set, _] = parts.as_slice() else {
        return Err(foreign());
    };
    if what != format!("chaindrive {kind}") {
        return Err(foreign());
    }
    let origin = match (
        build.strip_prefix(BUILD),
        instruction_set.strip_prefix(INSTRUCTION_SET),
    ) {
        (Some(build), Some(instruction_set)) => Origin {
            build: build.to_owned(),
            instruction_set: instruction_set.to_owned(),
        },
        // Before builds had identities, a layout and a version stood there.
        _ => Origin::default(),
    };
    if let Some(refusal) = origin.refusal() {
        return Err(SealError::Origin { kind, refusal });
    }
    if format!("{line}\n") != heading::<T>(&origin, content) {
        return Err(SealError::Damaged { kind });
    }
    postcard::from_bytes(content).map_err(|_| SealError::Damaged { kind })
}

fn heading<T: SealedValue>(origin: &Origin, content: &[u8]) -> String {
    let (kind, checksum) = (T::KIND, crc32fast::hash(content));
    let Origin {
        build,
        instruction_set,
    } = origin;
    format!(
        "chaindrive {kind}, {BUILD}{build}, {INSTRUCTION_SET}{instruction_set}, checksum {checksum:08x}\n"
    )
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Serialize, Deserialize)]
    struct Numbers(Vec<f64>);

    impl SealedValue for Numbers {
        const KIND: &'static str = "list";
    }

    #[derive(Debug, Serialize, Deserialize)]
    struct Others(Vec<f64>);

    impl SealedValue for Others {
        const KIND: &'static str = "table";
    }

    #[test]
    fn every_bit_comes_back() {
        let odd = [f64::NAN, -0.0, f64::NEG_INFINITY, 0.1, f64::from_bits(1)];
        let numbers = Numbers([&odd[..], &[f64::from_bits(0x7ff8_dead_beef_0001)]].concat());
        let Numbers(back) = opened(&sealed(&numbers)).unwrap();
        let bits = |values: &[f64]| values.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&back), bits(&numbers.0));
    }

    /// Any byte changed and any length cut is noticed, and nothing else is taken for it.
    #[test]
    fn what_is_not_whole_is_refused() {
        let bytes = sealed(&Numbers(vec![1.0, 2.0]));
        for place in 0..bytes.len() {
            let mut wrong = bytes.clone();
            wrong[place] ^= 1;
            opened::<Numbers>(&wrong).unwrap_err();
            opened::<Numbers>(&bytes[..place]).unwrap_err();
        }
        let kind = "table";
        assert_eq!(
            opened::<Others>(&bytes).unwrap_err(),
            SealError::Foreign { kind }
        );
        let text = String::from_utf8_lossy(&bytes).into_owned();
        let old = "chaindrive list, layout 2, version 0.1.0, checksum 00000000\n";
        for other in [text.replace("build 0", "build 9"), old.to_owned()] {
            let error = opened::<Numbers>(other.as_bytes()).unwrap_err();
            assert!(matches!(error, SealError::Origin { .. }), "{error}");
        }
    }
}
