//! Which module of a crate names which, read off the sources.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Names of the modules that each module of a crate uses; the root of the crate, which names all, is left out.
pub(crate) type Arrows = BTreeMap<String, BTreeSet<String>>;

/// Reads the arrows between the modules of the crate in a folder `src`, its tests left out.
pub(crate) fn of(src: &Path) -> Arrows {
    let root = fs::read_to_string(src.join("lib.rs")).expect("every crate has a root");
    let homes = homes(&root);
    let mut arrows = Arrows::new();
    for file in super::sources(src) {
        let inside = file.strip_prefix(src).expect("a source of this crate");
        let mut path: Vec<String> = inside
            .with_extension("")
            .iter()
            .map(|part| part.to_string_lossy().into_owned())
            .collect();
        if path.last().is_some_and(|name| name == "mod") {
            path.pop();
        }
        let test = path.last().is_some_and(|name| name == "tests");
        if test || path == ["lib"] || path == ["main"] {
            continue;
        }
        let text = fs::read_to_string(&file).expect("sources are text");
        let uses = arrows.entry(path[0].clone()).or_default();
        for name in top_names(&code(&text), &path) {
            match homes.get(&name) {
                Some(Some(home)) if *home != path[0] => {
                    uses.insert(home.clone());
                }
                Some(_) => {}
                None => panic!("{}: nothing is known of `crate::{name}`", file.display()),
            }
        }
    }
    arrows
}

/// Module of every name at the root of a crate; none for what is of another crate or of the root itself.
fn homes(root: &str) -> BTreeMap<String, Option<String>> {
    let text = code(root);
    let mut homes = BTreeMap::new();
    for statement in text.split_inclusive([';', '}']) {
        let words: Vec<&str> = statement.split_whitespace().collect();
        if let Some(at) = words.iter().position(|word| *word == "mod")
            && let Some(name) = words.get(at + 1)
        {
            let name = name.trim_end_matches(';').to_owned();
            homes.insert(name.clone(), Some(name));
        }
    }
    for statement in text.split(';') {
        let Some((visibility, list)) = statement.rsplit_once("use ") else {
            for kind in ["type ", "const ", "static ", "fn ", "struct ", "enum "] {
                for (at, _) in statement.match_indices(kind) {
                    homes
                        .entry(word(&statement[at + kind.len()..]))
                        .or_insert(None);
                }
            }
            continue;
        };
        if !visibility.trim_end().ends_with("pub") && !visibility.trim_end().ends_with(')') {
            continue;
        }
        let list = list.trim();
        let first = word(list);
        let home = homes.get(&first).cloned().flatten();
        for name in leaves(list) {
            homes.insert(name, home.clone());
        }
    }
    homes
}

/// Names that a list of imports brings in: `a::{B, c::D as E}` brings B and E.
fn leaves(list: &str) -> Vec<String> {
    let mut names = Vec::new();
    let separators = ['{', '}', ','];
    for item in list.split(separators) {
        let item = item.trim();
        let item = item.rsplit_once(" as ").map_or(item, |(_, name)| name);
        let name = item.rsplit("::").next().unwrap_or_default().trim();
        if !name.is_empty() && !item.ends_with("::") {
            names.push(name.to_owned());
        }
    }
    names
}

/// The code without comments and tests.
pub(crate) fn code(text: &str) -> String {
    let mut kept = String::new();
    let mut lines = text.lines().peekable();
    while let Some(line) = lines.next() {
        let trimmed = line.trim();
        if trimmed.starts_with("#[cfg(test)]") {
            // Tests in the file stand last; those in a file of their own are named in one line.
            match lines.peek() {
                Some(next) if next.trim_end().ends_with(';') => {
                    lines.next();
                    continue;
                }
                _ => break,
            }
        }
        kept.push_str(line.split("//").next().unwrap_or_default());
        kept.push('\n');
    }
    kept
}

/// Names at the root of the crate that the code of a module at `path` uses.
fn top_names(code: &str, path: &[String]) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for (start, _) in code.match_indices("crate::") {
        let before = code[..start].chars().next_back();
        if !before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
            names.extend(heads(&code[start + "crate::".len()..]));
        }
    }
    for (start, _) in code.match_indices("super::") {
        if code[..start].ends_with("super::") || code[..start].ends_with("r#") {
            continue;
        }
        let mut rest = &code[start..];
        let mut depth = path.len();
        while let Some(further) = rest.strip_prefix("super::") {
            rest = further;
            depth = depth.saturating_sub(1);
        }
        if depth == 0 {
            names.extend(heads(rest));
        }
    }
    names
}

/// First words of a path or of a list of paths in braces.
fn heads(text: &str) -> Vec<String> {
    let Some(list) = text.trim_start().strip_prefix('{') else {
        return vec![word(text)];
    };
    let mut found = Vec::new();
    let (mut depth, mut begins) = (0, true);
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => begins = true,
            c if begins && !c.is_whitespace() => {
                found.push(word(&list[at..]));
                begins = false;
            }
            _ => {}
        }
    }
    found.retain(|name| name != "self");
    found
}

fn word(text: &str) -> String {
    let text = text.trim_start();
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_');
    text[..end.unwrap_or(text.len())].to_owned()
}
