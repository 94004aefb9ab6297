//! Reads scenes from files.

use std::fs;
use std::io::{ErrorKind, Read};
use std::path::Path;

use super::{Problem, Scene, SceneError};

/// Largest scene file \[bytes\]: room for the tables of a measured drive, not for a film.
const LARGEST: u64 = 16 * 1024 * 1024;

impl Scene {
    /// Reads a scene file, TOML or JSON.
    ///
    /// # Errors
    /// A file that is missing, empty, not text or larger than 16 MiB; otherwise those of
    /// [`Scene::from_text`].
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        let name = path.display().to_string();
        let text = text_of(path).map_err(|problem| SceneError::new(&name, vec![problem]))?;
        Self::from_text(&text, &name)
    }
}

fn text_of(path: &Path) -> Result<String, Problem> {
    let refuse = |message: String| Problem::new("", None, message);
    let unreadable = |error: std::io::Error| match error.kind() {
        ErrorKind::NotFound => refuse("there is no such file".into())
            .hint("check the path; the embedded scenes are named without `.toml`"),
        ErrorKind::IsADirectory => refuse("this is a folder, not a scene file".into()),
        _ => refuse(format!("the file cannot be read: {error}")),
    };
    if path.is_dir() {
        return Err(refuse("this is a folder, not a scene file".into()));
    }
    let file = fs::File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    file.take(LARGEST + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() as u64 > LARGEST {
        let message = format!("the file is larger than {} MiB", LARGEST >> 20);
        return Err(refuse(message).hint("a scene is a text of TOML or JSON"));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        refuse(format!("the file is not a text: byte {at} is not UTF-8"))
            .hint("a scene is TOML or JSON in UTF-8")
    })
}
