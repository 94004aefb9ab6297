//! Circles of files inside crates and in the Python package: files that name each other's items, directly or around.
//!
//! Rules. A file names a file if its code, tests left out, has a path or an import that ends at an item written there. Doors count for
//! nothing: a re-export is followed to where the item is written, and is an arrow only where the door uses the name itself. A file may name
//! what the door of its own folder defines: a family is written in the words of its table of contents. `mod` is no arrow, and neither is a
//! method that is called on a value. The roots of crates, which name all, are left out. So it is in Python, where what a user finds by its
//! name when he asks for it, `run.drive`, is as little an arrow as a method called on a value.

mod python;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use super::{arrows, root, sources};

const CRATES: [&str; 15] = [
    "identity",
    "quantities",
    "geometry",
    "contact",
    "integrate",
    "validation",
    "mechanics",
    "chaindrive",
    "couple",
    "fmu",
    "replay",
    "lab",
    "cli",
    "python",
    "wasm",
];

/// A file of a crate: what it defines, what its names stand for, and the paths that its code has.
#[derive(Debug, Default)]
struct File {
    defined: BTreeSet<String>,
    /// Names that imports bring in, and the paths they stand for, from the root of the crate.
    names: BTreeMap<String, Vec<String>>,
    /// Names that are handed on and not used.
    doors: BTreeSet<String>,
    /// Paths in the code, as written.
    paths: Vec<Vec<String>>,
}

/// The files of a crate by the paths of their modules.
type Files = BTreeMap<Vec<String>, File>;

/// Arrows between the files of a crate.
type Graph = BTreeMap<Vec<String>, BTreeSet<Vec<String>>>;

fn read(src: &Path) -> Files {
    let mut texts = BTreeMap::new();
    let mut tests = BTreeSet::new();
    for path in sources(src) {
        let inside = path.strip_prefix(src).expect("a source of this crate");
        let mut module: Vec<String> = inside
            .with_extension("")
            .iter()
            .map(|part| part.to_string_lossy().into_owned())
            .collect();
        if module.last().is_some_and(|name| name == "mod") {
            module.pop();
        }
        if module == ["lib"] || module == ["main"] {
            module.clear();
        }
        let text = fs::read_to_string(&path).expect("sources are text");
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            if line.trim() == "#[cfg(test)]"
                && let Some(name) = lines
                    .next()
                    .and_then(|next| next.trim().strip_prefix("mod "))
                && let Some(name) = name.strip_suffix(';')
            {
                tests.insert([&module[..], &[name.to_owned()]].concat());
            }
        }
        texts.insert(module, arrows::code(&text));
    }
    texts.retain(|module, _| !(1..=module.len()).any(|n| tests.contains(&module[..n])));
    let modules: BTreeSet<Vec<String>> = texts.keys().cloned().collect();
    let file = |(module, text): (Vec<String>, String)| {
        (module.clone(), File::of(&module, &text, &modules))
    };
    texts.into_iter().map(file).collect()
}

impl File {
    fn of(module: &[String], text: &str, modules: &BTreeSet<Vec<String>>) -> Self {
        let mut file = Self::default();
        let tokens = tokens(text);
        let word = |at: usize| tokens.get(at).map_or("", |it| it.as_str());
        let mut used: BTreeSet<String> = BTreeSet::new();
        let mut handed_on = BTreeSet::new();
        let mut at = 0;
        while at < tokens.len() {
            match word(at) {
                "use" => {
                    let end = (at..tokens.len())
                        .find(|it| word(*it) == ";")
                        .unwrap_or(tokens.len());
                    let open = at > 0 && matches!(word(at - 1), "pub" | ")");
                    let mut list = Vec::new();
                    imports(&tokens[at + 1..end], &[], &mut list);
                    for (name, path) in list {
                        let Some(path) = absolute(module, &path, modules, &file.names) else {
                            continue;
                        };
                        if open {
                            handed_on.insert(name.clone());
                        }
                        file.names.insert(name, path);
                    }
                    at = end;
                }
                "struct" | "enum" | "trait" | "fn" | "const" | "static" | "type" | "union"
                | "macro_rules" => {
                    let next = if word(at + 1) == "!" { at + 2 } else { at + 1 };
                    file.defined.insert(word(next).to_owned());
                    at += 1;
                }
                first if is_word(first) && (at == 0 || !matches!(word(at - 1), "." | "::")) => {
                    let mut path = vec![first.to_owned()];
                    while word(at + 1) == "::" && is_word(word(at + 2)) {
                        path.push(word(at + 2).to_owned());
                        at += 2;
                    }
                    used.insert(path[0].clone());
                    file.paths.push(path);
                }
                _ => {}
            }
            at += 1;
        }
        file.doors = handed_on.difference(&used).cloned().collect();
        file
    }
}

/// Names that a list of imports brings in, and their paths.
fn imports(tokens: &[String], before: &[String], list: &mut Vec<(String, Vec<String>)>) {
    let mut path = before.to_vec();
    let mut at = 0;
    while at < tokens.len() {
        match tokens[at].as_str() {
            "{" => {
                let mut depth = 0;
                let mut from = at + 1;
                for (end, token) in tokens.iter().enumerate().skip(at) {
                    match token.as_str() {
                        "{" => depth += 1,
                        "}" => depth -= 1,
                        "," if depth == 1 => {
                            imports(&tokens[from..end], &path, list);
                            from = end + 1;
                        }
                        _ => {}
                    }
                    if depth == 0 {
                        imports(&tokens[from..end], &path, list);
                        return;
                    }
                }
            }
            "as" => {
                list.push((tokens[at + 1].clone(), path));
                return;
            }
            "self" if !before.is_empty() => {}
            word if is_word(word) || word == "*" => path.push(word.to_owned()),
            _ => {}
        }
        at += 1;
    }
    if let Some(name) = path
        .last()
        .filter(|_| path.len() > before.len() || tokens.iter().any(|it| it == "self"))
    {
        list.push((name.clone(), path.clone()));
    }
}

/// A path from the root of the crate; none for what is of another crate.
fn absolute(
    module: &[String],
    path: &[String],
    modules: &BTreeSet<Vec<String>>,
    names: &BTreeMap<String, Vec<String>>,
) -> Option<Vec<String>> {
    let first = path.first()?.as_str();
    let (base, rest): (Vec<String>, &[String]) = match first {
        "crate" => (Vec::new(), &path[1..]),
        "self" => (module.to_vec(), &path[1..]),
        "super" => {
            let up = path.iter().take_while(|it| *it == "super").count();
            (
                module[..module.len().checked_sub(up)?].to_vec(),
                &path[up..],
            )
        }
        _ => {
            let child = [module, &path[..1]].concat();
            if modules.contains(&child) {
                (child, &path[1..])
            } else {
                (names.get(first)?.clone(), &path[1..])
            }
        }
    };
    Some([&base[..], rest].concat())
}

/// The file where a path from the root ends.
fn home(files: &Files, path: &[String], depth: usize) -> Option<Vec<String>> {
    let mut module: Vec<String> = Vec::new();
    for (at, step) in path.iter().enumerate() {
        let child = [&module[..], std::slice::from_ref(step)].concat();
        if files.contains_key(&child) {
            module = child;
            continue;
        }
        let file = &files[&module];
        if !file.defined.contains(step)
            && let Some(elsewhere) = file.names.get(step)
            && depth < 8
        {
            return home(files, &[elsewhere, &path[at + 1..]].concat(), depth + 1);
        }
        break;
    }
    (!module.is_empty()).then_some(module)
}

fn graph(files: &Files) -> Graph {
    let modules: BTreeSet<Vec<String>> = files.keys().cloned().collect();
    let mut graph = Graph::new();
    for (module, file) in files.iter().filter(|(module, _)| !module.is_empty()) {
        let arrows = graph.entry(module.clone()).or_default();
        let imported = file
            .names
            .iter()
            .filter(|(name, _)| !file.doors.contains(*name))
            .map(|(_, path)| path.clone());
        let written = file.paths.iter().filter_map(|path| {
            let known = matches!(path[0].as_str(), "crate" | "self" | "super") || path.len() > 1;
            absolute(module, path, &modules, &file.names).filter(|_| known)
        });
        for path in imported.chain(written) {
            if let Some(home) = home(files, &path, 0).filter(|home| !module.starts_with(home)) {
                arrows.insert(home);
            }
        }
    }
    graph
}

/// The arrows of a graph, as `a/b → c`.
fn named(graph: &Graph) -> Vec<String> {
    let arrows = graph
        .iter()
        .flat_map(|(from, to)| to.iter().map(move |to| (from, to)));
    arrows
        .map(|(from, to)| format!("{} → {}", from.join("/"), to.join("/")))
        .collect()
}

/// Strongly connected components of more than one file.
fn circles(graph: &Graph) -> Vec<Vec<Vec<String>>> {
    let reached = |from: &Vec<String>| {
        let (mut seen, mut next) = (BTreeSet::new(), vec![from.clone()]);
        while let Some(file) = next.pop() {
            for to in &graph[&file] {
                if seen.insert(to.clone()) {
                    next.push(to.clone());
                }
            }
        }
        seen
    };
    let reach: BTreeMap<&Vec<String>, BTreeSet<Vec<String>>> =
        graph.keys().map(|it| (it, reached(it))).collect();
    let mut found = BTreeSet::new();
    for (file, reached) in &reach {
        let own: Vec<Vec<String>> = reached
            .iter()
            .filter(|it| reach[it].contains(*file))
            .cloned()
            .collect();
        if own.len() > 1 {
            found.insert(own);
        }
    }
    found.into_iter().collect()
}

fn is_word(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Words, `::`, and other signs one by one; texts and characters are left out.
fn tokens(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let length = if first.is_alphabetic() || first == '_' {
            rest.find(|c: char| !c.is_alphanumeric() && c != '_')
                .unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else if first == '"' {
            let mut escaped = false;
            let end = rest[1..].find(|c| {
                let ends = c == '"' && !escaped;
                escaped = c == '\\' && !escaped;
                ends
            });
            rest = &rest[end.map_or(rest.len(), |end| end + 2)..];
            continue;
        } else {
            first.len_utf8()
        };
        if !first.is_whitespace() {
            found.push(rest[..length].to_owned());
        }
        rest = &rest[length..];
    }
    found
}

/// Whoever closes a circle meets this test: move what both need below both.
#[test]
fn files_stand_in_no_circle() {
    let mut problems = Vec::new();
    let crates = CRATES.map(|it| (it, read(&root().join("crates").join(it).join("src"))));
    let package = python::read(&root().join("python/chaindrive"));
    for (place, files) in crates.into_iter().chain([("python/chaindrive", package)]) {
        let graph = graph(&files);
        for circle in circles(&graph) {
            problems.push(format!("{place}:"));
            for file in &circle {
                let to = graph[file].iter().filter(|it| circle.contains(it));
                let to: Vec<String> = to.map(|it| it.join("/")).collect();
                problems.push(format!("    {} names {}", file.join("/"), to.join(", ")));
            }
        }
    }
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// The reader of files sees imports, lists, new names, doors, paths in the code; no tests, no texts, and no way to the folder's own door.
#[test]
fn circles_are_read_off_the_sources() {
    let folder = std::env::temp_dir().join(format!("chaindrive-circles-{}", std::process::id()));
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().expect("inside")).expect("a folder");
        fs::write(path, text).expect("a file");
    };
    write("lib.rs", "mod a;\nmod b;\nmod c;\npub use b::Bee;\n");
    write(
        "a.rs",
        "mod deep;\npub use deep::Deep;\nuse crate::{Bee as Insect, c::{see}};\npub struct A(Insect);\n#[cfg(test)]\nmod tests;\n",
    );
    write(
        "a/deep.rs",
        "use super::A;\nuse crate::c;\npub struct Deep(A);\nfn f() { c::see(\"crate::b\") }\n",
    );
    write("a/tests.rs", "use crate::b::Bee;\n");
    write(
        "b.rs",
        "pub struct Bee;\nfn f(a: crate::a::Deep) {}\n#[cfg(test)]\nmod tests { use crate::a::A; }\n",
    );
    write("c.rs", "use crate::b;\npub fn see() { b::Bee; }\n");
    let graph = graph(&read(&folder));
    fs::remove_dir_all(&folder).expect("it was there");
    let plain = named(&graph);
    assert_eq!(
        plain,
        ["a → b", "a → c", "a/deep → c", "b → a/deep", "c → b"]
    );
    let found: Vec<Vec<String>> = circles(&graph)
        .iter()
        .map(|circle| circle.iter().map(|file| file.join("/")).collect())
        .collect();
    assert_eq!(found, [["a/deep", "b", "c"]]);
}
