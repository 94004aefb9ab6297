//! Writes the page of the lab: `chaindrive-lab GLUE MODULE PAGE`.

use std::error::Error;
use std::path::Path;
use std::{env, fs};

fn main() -> Result<(), Box<dyn Error>> {
    let given: Vec<String> = env::args().skip(1).collect();
    let [glue, module, page] = given.as_slice() else {
        return Err("three paths are needed: GLUE MODULE PAGE, as `make lab` gives them".into());
    };
    let read = |path: &str| fs::read(path).map_err(|error| format!("{path}: {error}"));
    let script = String::from_utf8(read(glue)?).map_err(|error| format!("{glue}: {error}"))?;
    let text = chaindrive_lab::page(&script, &read(module)?);
    if let Some(folder) = Path::new(page).parent() {
        fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    fs::write(page, text).map_err(|error| format!("{page}: {error}"))?;
    Ok(())
}
