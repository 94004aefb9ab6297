//! The summary of a run and a description, word for word.
//!
//! After a change that is meant: `INSTA_UPDATE=always cargo test -p chaindrive-cli --test it told`, and look at what git shows.

use crate::command_line::{folder, run};

#[test]
fn the_summary_of_a_run() {
    let folder = folder();
    let line = "run marine_two_sprockets --until 50ms --every 1ms -o result.zarr";
    let arguments: Vec<&str> = line.split(' ').collect();
    let (code, out, err) = run(folder.path(), &arguments);
    assert_eq!(code, 0, "{err}");
    // The horizon of span tensions is about as long as the record: last bits decide whether it is told.
    let told = without_numbers(&out).replace(" to # ms for span tensions,", "");
    insta::assert_snapshot!(told);
}

#[test]
fn a_description() {
    let (code, out, err) = run(folder().path(), &["describe", "marine_engine"]);
    assert_eq!(code, 0, "{err}");
    // What a run-in costs is milliseconds on one machine and seconds on another.
    let told = without_numbers(&out).replace("about # ms", "about # s");
    insta::assert_snapshot!(told);
}

/// The text without the lines that tell of the clock, with a # for every number, and one space where columns are apart: numbers are judged elsewhere, and differ in their
/// last digits from processor to processor.
fn without_numbers(text: &str) -> String {
    let mut told = String::new();
    let mut inside = false;
    let clock = |line: &&str| {
        !["run time", "speed"]
            .iter()
            .any(|it| line.trim_start().starts_with(it))
    };
    let lines: Vec<&str> = text.lines().filter(clock).collect();
    for c in lines.join("\n").chars() {
        let digit = c.is_ascii_digit();
        if digit && !inside {
            told.push('#');
        }
        inside = digit || inside && c == '.';
        let repeated = c == ' ' && told.ends_with(' ');
        if !inside && !repeated {
            told.push(c);
        }
    }
    told
}
