//! `chaindrive replay`: pages of results, and what it refuses.

use std::fs;

use crate::command_line::{answer as run, folder, words};

#[test]
fn a_result_becomes_a_page_once() {
    let folder = folder();
    let at = folder.path();
    let short = words("run spinning_ring --until 5ms --no-error -q -o ring.zarr");
    let (code, told) = run(at, &short);
    assert_eq!(code, 0, "{told}");

    let (code, told) = run(at, &["replay", "ring.zarr"]);
    assert_eq!(code, 0, "{told}");
    assert!(
        told.starts_with("ring.html: 51 frames, every sample"),
        "{told}"
    );
    let page = fs::read_to_string(at.join("ring.html")).unwrap();
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    assert!(!page.contains("{{"), "nothing is left to fill in");

    let (code, told) = run(at, &["replay", "ring.zarr"]);
    assert_eq!(code, 3);
    assert!(told.contains("pass --overwrite"), "{told}");
    let (code, _) = run(at, &["replay", "ring.zarr", "--overwrite", "-q"]);
    assert_eq!(code, 0);
}

/// The movie's whereabouts, the channels to record, and results that are none.
#[test]
fn refusals_say_what_to_try() {
    let folder = folder();
    let at = folder.path();
    let short = "run spinning_ring --until 1ms --no-error -q --record energy_kinetic -o still.zarr";
    assert_eq!(run(at, &words(short)).0, 0);
    let movie = "pip install 'chaindrive[movie]'";
    for (arguments, hint) in [
        ("still.zarr", "--record roller_x,roller_y"),
        ("still.zarr --mp4", movie),
        ("still.zarr -o x.gif", movie),
        ("still.zarr -o x.pdf", "must end in .html"),
        ("still.zarr --frames 0", "1 or more"),
        ("gone.zarr", "nothing of this name"),
        (". -o x.html", "not a result of chaindrive"),
    ] {
        let (code, told) = run(at, &words(&format!("replay {arguments}")));
        assert!(
            code == 2 && told.contains(hint),
            "{arguments}: {code}, {told}"
        );
    }
    assert!(!at.join("still.html").exists());
}
