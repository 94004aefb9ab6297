//! Command lines with a random mistake: no message has a word of a library's own, and none is a panic.

use crate::command_line::{folder, run};

/// Mistakes that are made.
const MISTAKES: u64 = 120;

/// Words of serde and of the standard library, and those of a program that broke down.
const FOREIGN: [&str; 12] = [
    "invalid type",
    "invalid digit",
    "invalid float",
    "missing field",
    "unknown field",
    "unknown variant",
    "expected struct",
    "untagged",
    "ParseFloatError",
    "ParseIntError",
    " at line ",
    "panicked",
];

/// Sound command lines that end at once, had they no mistake.
const SOUND: [&str; 10] = [
    "run spinning_ring --until 1ms --every 1ms --step 10us --no-error",
    "run spinning_ring --until 1ms --record energy_kinetic --set chain.links=24",
    "sweep spinning_ring --until 1ms --every 1ms --step 10us --vary chain.links=20,24 --jobs 1",
    "check spinning_ring hanging_chain",
    "describe spinning_ring --until 1ms --json",
    "design --sprockets 19,38 --chain 16B-1 --links 80",
    "diff spinning_ring hanging_chain",
    "resolve spinning_ring --set chain.links=24",
    "catalogue 16B-1 --json",
    "schema catalogue",
];

/// Words that take the place of others.
const WORDS: [&str; 14] = [
    "-1",
    "0",
    "nan",
    "1e999",
    "many",
    "",
    "12 parsec",
    "--",
    "[1",
    "{",
    "chain.links=",
    "=3",
    "99999999999999999999",
    "--json",
];

/// Numbers without a pattern, the same in every run: splitmix64.
fn random(seed: u64) -> usize {
    let mut z = seed.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    usize::try_from((z ^ (z >> 31)) >> 33).expect("31 bits")
}

#[test]
fn no_message_about_a_command_line_speaks_of_a_library() {
    let folder = folder();
    let (mut wrong, mut complaints) = (0, Vec::new());
    for seed in 0..MISTAKES {
        let draw = |which: u64, bound: usize| random(seed * 8 + which) % bound;
        let mut words: Vec<String> = SOUND[draw(0, SOUND.len())]
            .split(' ')
            .map(str::to_owned)
            .collect();
        let at = draw(1, words.len());
        match draw(2, 4) {
            0 => WORDS[draw(3, WORDS.len())].clone_into(&mut words[at]),
            1 => drop(words.remove(at)),
            2 => words.insert(at, WORDS[draw(3, WORDS.len())].to_owned()),
            _ => drop(words[at].pop()),
        }
        let arguments: Vec<&str> = words.iter().map(String::as_str).collect();
        let (code, _, err) = run(folder.path(), &arguments);
        wrong += usize::from(code != 0);
        let told = code == 0 || !err.trim().is_empty();
        if !told || !(0..=4).contains(&code) || FOREIGN.iter().any(|word| err.contains(word)) {
            complaints.push(format!(
                "$ chaindrive {}\n{err}exit code {code}",
                words.join(" ")
            ));
        }
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n\n"));
    assert!(wrong > 60, "only {wrong} of {MISTAKES} were mistakes");
}

/// A mistake of the program: here of whoever watches a run.
#[test]
fn a_panic_has_an_exit_code_of_its_own() {
    for verb in ["run spinning_ring", "run spinning_ring --json"] {
        let more = ["--until", "1ms", "--no-error"];
        let arguments = ["chaindrive"]
            .into_iter()
            .chain(verb.split(' '))
            .chain(more);
        let code = chaindrive_cli::run(arguments, &|| panic!("as asked for"));
        assert_eq!(code, 70, "{verb}");
    }
}
