//! Locations of resources.

use std::path::PathBuf;

use percent_encoding::percent_decode_str;

/// The path of a location such as `file:///drive/resources`; a path is taken as it is.
pub(super) fn path(location: &str) -> PathBuf {
    let Some(rest) = location.strip_prefix("file:") else {
        return PathBuf::from(location);
    };
    let rest = rest.strip_prefix("//").unwrap_or(rest);
    let rest = rest.strip_prefix("localhost").unwrap_or(rest);
    let decoded = percent_decode_str(rest).decode_utf8_lossy().into_owned();
    // file:///C:/… is C:/…
    match decoded.as_bytes() {
        [b'/', drive, b':', ..] if drive.is_ascii_alphabetic() => PathBuf::from(&decoded[1..]),
        _ => PathBuf::from(decoded),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn locations_of_all_importers_are_paths() {
        for (location, expected) in [
            ("file:///a%20drive/resources", "/a drive/resources"),
            ("file:/drive", "/drive"),
            ("file://localhost/drive", "/drive"),
            ("file:///C:/drive", "C:/drive"),
            ("/drive", "/drive"),
        ] {
            assert_eq!(path(location), PathBuf::from(expected), "{location}");
        }
    }
}
