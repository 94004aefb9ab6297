//! The files of the Python package, and what they import.
//!
//! Imports inside functions count, those for type checkers alone do not: nobody carries them out. What the package hands out on demand is
//! followed to where its stub says that it is defined. A folder's `__init__.py` is a file as any other, for it is carried out.

use std::fs;
use std::path::Path;

use super::super::sources;
use super::{File, Files, circles, graph, named};

pub(super) fn read(package: &Path) -> Files {
    let mut files = Files::new();
    for path in sources(package) {
        let inside = path.strip_prefix(package).expect("a file of the package");
        let inside = inside.with_extension("");
        let steps = inside.iter().map(|it| it.to_string_lossy().into_owned());
        let module: Vec<String> = steps.filter(|it| it != "__init__").collect();
        let mut text = fs::read_to_string(&path).expect("sources are text");
        text += &fs::read_to_string(path.with_extension("pyi")).unwrap_or_default();
        let mut file = File::default();
        for (name, path) in imports(&text) {
            // Functions may give one name to several things.
            let name = if file.names.get(&name).is_some_and(|it| *it != path) {
                path.join(".")
            } else {
                name
            };
            file.names.insert(name, path);
        }
        files.insert(module, file);
    }
    files
}

/// Names that imports bring in, and their paths in the package.
fn imports(text: &str) -> Vec<(String, Vec<String>)> {
    // Examples in docstrings import too.
    let code: String = text.split("\"\"\"").step_by(2).collect();
    let mut lines = code
        .lines()
        .map(|line| line.split('#').next().unwrap_or(""));
    let mut found = Vec::new();
    let mut for_types = None;
    while let Some(line) = lines.next() {
        let mut statement = line.trim().to_owned();
        let depth = line.len() - line.trim_start().len();
        if statement.is_empty() || for_types.is_some_and(|it| depth > it) {
            continue;
        }
        for_types = (statement == "if TYPE_CHECKING:").then_some(depth);
        if let Some(module) = statement.strip_prefix("import chaindrive") {
            let path = module.split(" as ").next().unwrap_or_default();
            found.push((module.to_owned(), steps(path)));
        }
        if !statement.starts_with("from chaindrive") {
            continue;
        }
        while statement.contains('(') && !statement.contains(')') {
            statement += lines.next().expect("an import ends").trim();
        }
        let (module, names) = statement.split_once(" import ").expect("an import");
        let path = steps(module.trim_start_matches("from chaindrive"));
        let names = names.trim_matches(['(', ')']).split(',').map(str::trim);
        for name in names.filter(|it| !it.is_empty()) {
            let (name, known) = name.split_once(" as ").unwrap_or((name, name));
            found.push((known.to_owned(), [&path[..], &[name.to_owned()]].concat()));
        }
    }
    found
}

fn steps(path: &str) -> Vec<String> {
    let steps = path.split('.').filter(|it| !it.is_empty());
    steps.map(str::to_owned).collect()
}

/// The reader sees imports of all kinds, on several lines and in functions; no examples, and nothing that is for type checkers.
#[test]
fn imports_of_python_are_read_off_the_sources() {
    let folder = std::env::temp_dir().join(format!("chaindrive-imports-{}", std::process::id()));
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().expect("inside")).expect("a folder");
        fs::write(path, text).expect("a file");
    };
    write("__init__.py", "");
    write("__init__.pyi", "from chaindrive.a import A as A\n");
    write(
        "a.py",
        "import chaindrive as cd\nimport chaindrive.deep.c\nfrom chaindrive import _core\nif TYPE_CHECKING:\n    from chaindrive.d import D\n",
    );
    write(
        "deep/__init__.py",
        "from chaindrive.deep.b import (\n    B,  # a bee\n)\n",
    );
    write(
        "deep/b.py",
        "\"\"\"Text.\n\nfrom chaindrive import d\n\"\"\"\ndef f():\n    from chaindrive import A as Other, d\n",
    );
    write("deep/c.py", "from chaindrive.deep import B\n");
    write("d.py", "from chaindrive import deep\n");
    let graph = graph(&read(&folder));
    fs::remove_dir_all(&folder).expect("it was there");
    let plain = named(&graph);
    let expected = [
        "a → deep/c",
        "deep → deep/b",
        "deep/b → a",
        "deep/b → d",
        "deep/c → deep/b",
        "d → deep",
    ];
    assert_eq!(plain.len(), expected.len(), "{plain:?}");
    assert!(
        expected.iter().all(|it| plain.contains(&(*it).to_owned())),
        "{plain:?}"
    );
    assert_eq!(circles(&graph).len(), 1);
}
