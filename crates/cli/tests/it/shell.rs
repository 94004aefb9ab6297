//! Completion and manual pages: what shells read, and what they then know.
#![expect(clippy::unwrap_used, reason = "a test may fail where it stands")]

use std::fs;
use std::process::Command;

/// The verbs that the help lists.
fn verbs() -> Vec<String> {
    let (_, help) = chaindrive(&["--help"]);
    let (_, list) = help.split_once("Commands:\n").unwrap();
    let (list, _) = list.split_once("\n\n").unwrap();
    // Continued lines are indented deeper.
    let entries = list.lines().filter_map(|line| line.strip_prefix("  "));
    let entries = entries.filter(|entry| !entry.starts_with(' '));
    let names = entries.filter_map(|entry| entry.split_whitespace().next());
    let found: Vec<String> = names
        .filter(|&it| it != "help")
        .map(str::to_owned)
        .collect();
    assert!(found.len() >= 14, "{found:?}");
    found
}

fn chaindrive(arguments: &[&str]) -> (i32, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_chaindrive"));
    let output = command.args(arguments).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    (output.status.code().unwrap(), text)
}

#[test]
fn every_shell_gets_a_script_that_names_every_verb() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let (code, script) = chaindrive(&["completion", shell]);
        assert_eq!(code, 0, "{shell}");
        for word in verbs() {
            assert!(script.contains(&word), "{shell}: {word}");
        }
        // The others complete options, but not what these take.
        if ["bash", "fish", "zsh"].contains(&shell) {
            for word in ["span_tension", "dormand-prince"] {
                assert!(script.contains(word), "{shell}: {word}");
            }
        }
    }
    assert_eq!(chaindrive(&["completion", "cmd"]).0, 2);
}

/// Bash itself is asked what it would offer.
#[test]
fn bash_completes_verbs_methods_and_channels() {
    let (_, script) = chaindrive(&["completion", "bash"]);
    let asked = |words: &[&str]| {
        let line = format!(
            "COMP_WORDS=({}); COMP_CWORD={}",
            words.join(" "),
            words.len() - 1
        );
        let (current, before) = (words[words.len() - 1], words[words.len() - 2]);
        let call = format!("_chaindrive chaindrive '{current}' '{before}'");
        let program = format!("{script}\n{line}\n{call}\nprintf '%s\\n' \"${{COMPREPLY[@]}}\"\n");
        let bash = Command::new("bash")
            .args(["--norc", "-c", &program])
            .output();
        let Ok(output) = bash else {
            // No bash on this machine: the scripts are looked at above.
            return None;
        };
        Some(
            String::from_utf8(output.stdout)
                .unwrap()
                .lines()
                .map(str::to_owned)
                .collect(),
        )
    };
    let Some(found): Option<Vec<String>> = asked(&["chaindrive", "descr"]) else {
        return;
    };
    assert_eq!(found, ["describe"]);
    assert_eq!(
        asked(&["chaindrive", "run", "--method", "dor"]).unwrap(),
        ["dormand-prince"]
    );
    assert_eq!(
        asked(&["chaindrive", "run", "--record", "sprocket_f"]).unwrap(),
        ["sprocket_force_x", "sprocket_force_y"]
    );
    assert_eq!(
        asked(&["chaindrive", "run", "--chec"]).unwrap(),
        ["--checkpoint-every"]
    );
}

/// Known channels are suggestions: what is not one is refused by whoever knows why.
#[test]
fn an_unknown_channel_is_refused_by_name() {
    let arguments = ["run", "spinning_ring", "--record", "tensions", "--no-error"];
    let mut command = Command::new(env!("CARGO_BIN_EXE_chaindrive"));
    let output = command.args(arguments).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(told.contains("tensions"), "{told}");
    assert!(!told.contains("possible values"), "{told}");
}

#[test]
fn every_verb_has_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("share/man1");
    assert_eq!(chaindrive(&["man", pages.to_str().unwrap()]).0, 0);
    let page = |name: &str| fs::read_to_string(pages.join(name)).unwrap();
    let first = page("chaindrive.1");
    assert!(first.contains("Exit codes"));
    for verb in verbs() {
        // A page writes every hyphen as one that does not break.
        let written = verb.replace('-', "\\-");
        assert!(
            first.contains(&format!("chaindrive\\-{written}(1)")),
            "{verb}"
        );
        assert!(
            page(&format!("chaindrive-{verb}.1")).contains(".SH SYNOPSIS"),
            "{verb}"
        );
    }
    assert!(page("chaindrive-run.1").contains("Channels to record"));
    // A file cannot be a folder.
    let taken = pages.join("chaindrive.1");
    assert_eq!(chaindrive(&["man", taken.to_str().unwrap()]).0, 3);
}
