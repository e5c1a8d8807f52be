//! The rooms of the house: what each may import, and where `unsafe` may stand.
//!
//! A room is a folder or file of `src/`. It may import the rooms of its row, all of which stand above it: so imports run one way,
//! and a newcomer can read the rooms from the top without meeting one that he has not seen.

use std::fs;
use std::path::{Path, PathBuf};

/// Each room with what it may import.
const ROOMS: [(&str, &[&str]); 21] = [
    ("error", &[]),
    ("hdf", &["error"]),
    ("algebra", &["error", "hdf"]),
    ("native", &["error", "hdf", "algebra"]),
    ("tracking", &["error", "hdf", "algebra", "native"]),
    ("element", &["error", "hdf", "algebra", "native", "tracking"]),
    ("mesh", &["error", "hdf", "algebra", "native", "tracking", "element"]),
    ("model", &["error", "hdf", "algebra", "native", "tracking", "element", "mesh"]),
    ("contact", &["error", "hdf", "algebra", "native", "tracking", "element", "mesh", "model"]),
    ("matrices", &["error", "hdf", "algebra", "native", "tracking", "element", "mesh", "model", "contact"]),
    ("assembly", &["error", "hdf", "algebra", "native", "tracking", "element", "mesh", "model", "contact", "matrices"]),
    (
        "equilibrium",
        &[
            "error", "hdf", "algebra", "native", "tracking", "element", "mesh", "model", "contact", "matrices",
            "assembly",
        ],
    ),
    (
        "stability",
        &[
            "error",
            "hdf",
            "algebra",
            "native",
            "tracking",
            "element",
            "mesh",
            "model",
            "contact",
            "matrices",
            "assembly",
            "equilibrium",
        ],
    ),
    (
        "reduction",
        &[
            "error",
            "hdf",
            "algebra",
            "native",
            "tracking",
            "element",
            "mesh",
            "model",
            "contact",
            "matrices",
            "assembly",
            "equilibrium",
            "stability",
        ],
    ),
    (
        "results",
        &[
            "error",
            "hdf",
            "algebra",
            "native",
            "tracking",
            "element",
            "mesh",
            "model",
            "contact",
            "matrices",
            "assembly",
            "equilibrium",
            "stability",
            "reduction",
        ],
    ),
    (
        "structure",
        &[
            "error",
            "hdf",
            "algebra",
            "native",
            "tracking",
            "element",
            "mesh",
            "model",
            "contact",
            "matrices",
            "assembly",
            "equilibrium",
            "stability",
            "reduction",
            "results",
        ],
    ),
    (
        "comparison",
        &[
            "error",
            "hdf",
            "algebra",
            "native",
            "tracking",
            "element",
            "mesh",
            "model",
            "contact",
            "matrices",
            "assembly",
            "equilibrium",
            "stability",
            "reduction",
            "results",
            "structure",
        ],
    ),
    (
        "output",
        &[
            "error",
            "hdf",
            "algebra",
            "native",
            "tracking",
            "element",
            "mesh",
            "model",
            "contact",
            "matrices",
            "assembly",
            "equilibrium",
            "stability",
            "reduction",
            "results",
            "structure",
            "comparison",
        ],
    ),
    (
        "analysis",
        &[
            "error",
            "hdf",
            "algebra",
            "native",
            "tracking",
            "element",
            "mesh",
            "model",
            "contact",
            "matrices",
            "assembly",
            "equilibrium",
            "stability",
            "reduction",
            "results",
            "structure",
            "comparison",
            "output",
        ],
    ),
    (
        "report",
        &[
            "error",
            "hdf",
            "algebra",
            "native",
            "tracking",
            "element",
            "mesh",
            "model",
            "contact",
            "matrices",
            "assembly",
            "equilibrium",
            "stability",
            "reduction",
            "results",
            "structure",
            "comparison",
            "output",
            "analysis",
        ],
    ),
    (
        "cli",
        &[
            "error",
            "hdf",
            "algebra",
            "native",
            "tracking",
            "element",
            "mesh",
            "model",
            "contact",
            "matrices",
            "assembly",
            "equilibrium",
            "stability",
            "reduction",
            "results",
            "structure",
            "comparison",
            "output",
            "analysis",
            "report",
        ],
    ),
];

/// The files at the root of the crate, which are no rooms.
const ROOT: [&str; 2] = ["lib", "main"];

/// The only room that may be unsafe, and know the bindings.
const UNSAFE: &str = "native";

#[test]
fn rooms_import_only_rooms_above_them() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut complaints = Vec::new();
    for file in files(&source) {
        let shown = file.strip_prefix(&source).unwrap();
        complaints.extend(complaints_about(shown, &fs::read_to_string(&file).unwrap()));
    }
    assert!(complaints.is_empty(), "\n{}\n", complaints.join("\n"));
}

#[test]
fn every_row_names_rooms_above_it() {
    for (i, (room, allowed)) in ROOMS.iter().enumerate() {
        for name in *allowed {
            assert!(ROOMS[..i].iter().any(|(above, _)| above == name), "{room} imports {name}, which is not above it");
        }
    }
}

#[test]
fn what_is_forbidden_is_found() {
    let said = |file: &str, text: &str| complaints_about(Path::new(file), text).join("\n");
    assert_eq!(said("model/read.rs", "// crate::cli\nuse crate::mesh::Mesh;\nuse crate::{Error, Result};\n"), "");
    let upwards = said("element/tri6.rs", "use super::Point;\n\nuse crate::mesh::Mesh;\n");
    assert_eq!(
        upwards,
        "src/element/tri6.rs:3: `element` may not import `mesh`, only error, hdf, algebra, native, tracking"
    );
    let in_a_list = said("mesh/read.rs", "use crate::{\n    Error,\n    model::{Model, Part},\n    cli,\n};\n");
    assert!(in_a_list.contains(":3: `mesh` may not import `model`"), "{in_a_list}");
    assert!(in_a_list.contains(":4: `mesh` may not import `cli`"), "{in_a_list}");
    assert!(said("contact/law/mod.rs", "fn f() { crate::assembly::init() }").contains("may not import `assembly`"));
    assert!(
        said("contact/law/mod.rs", "use super::super::native::Comm;")
            .contains("src/contact/law/mod.rs:1: a room is left")
    );
    assert!(said("kitchen.rs", "").contains("`kitchen` is not in the table"));
    assert!(said("analysis/mod.rs", "fn f() {\n    unsafe {}\n}").contains("src/analysis/mod.rs:2: `unsafe`"));
    assert!(said("lib.rs", "unsafe {}").contains("src/lib.rs:1: `unsafe`"));
    assert!(said("assembly/mod.rs", "use squeal_sys as sys;").contains("src/assembly/mod.rs:1: `squeal_sys`"));
    assert_eq!(said("native/petsc/vector.rs", "use squeal_sys as sys;\nunsafe {}"), "");
}

/// All Rust files below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// What is wrong with a file, given by its path in `src/`.
fn complaints_about(file: &Path, text: &str) -> Vec<String> {
    let names: Vec<&str> = file.iter().map(|name| name.to_str().unwrap().trim_end_matches(".rs")).collect();
    let (room, depth) = (names[0], names.iter().filter(|name| **name != "mod").count());
    let code = without_comments(text);
    let complain = |at: usize, what: String| {
        let line = 1 + code[..at].matches('\n').count();
        format!("src/{}:{line}: {what}", file.display())
    };
    let mut complaints = Vec::new();
    for word in ["unsafe", "squeal_sys"].into_iter().filter(|_| room != UNSAFE) {
        let what = format!("`{word}` belongs in src/{UNSAFE} alone");
        complaints.extend(words(&code, word).map(|at| complain(at, what.clone())));
    }
    if ROOT.contains(&room) {
        return complaints;
    }
    let Some((_, allowed)) = ROOMS.iter().find(|(name, _)| *name == room) else {
        return vec![format!("src/{}: the room `{room}` is not in the table of tests/architecture.rs", file.display())];
    };
    for (at, import) in imports(&code) {
        if import != room && !allowed.contains(&import) {
            let list = allowed.join(", ");
            complaints.push(complain(at, format!("`{room}` may not import `{import}`, only {list}")));
        }
    }
    let root = format!("\nuse {}", "super::".repeat(depth));
    if let Some(at) = format!("\n{code}").find(&root) {
        complaints.push(complain(at, "a room is left by `crate::`, not by `super::`".to_owned()));
    }
    complaints
}

/// The text with comments taken out of its lines.
fn without_comments(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap_or_default()).collect::<Vec<_>>().join("\n")
}

/// Where a word stands.
fn words<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_inner = |c: char| c.is_alphanumeric() || c == '_';
    let is_word = move |at: usize| !code[..at].ends_with(is_inner) && !code[at + word.len()..].starts_with(is_inner);
    code.match_indices(word).map(|(at, _)| at).filter(move |&at| is_word(at))
}

/// The rooms that `crate::room` and `crate::{room, room::...}` name, each with its place.
fn imports(code: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    for (at, start) in code.match_indices("crate::") {
        let at = at + start.len();
        match code[at..].strip_prefix('{') {
            Some(list) => found.extend(listed(list).into_iter().map(|(offset, name)| (at + 1 + offset, name))),
            None => found.push((at, identifier(&code[at..]))),
        }
    }
    // The error room's types are known to the whole crate by their own names.
    found
        .into_iter()
        .map(|(at, name)| (at, if ["Error", "ErrorKind", "Result"].contains(&name) { "error" } else { name }))
        .collect()
}

/// First names of the items of a list up to its closing brace.
fn listed(list: &str) -> Vec<(usize, &str)> {
    let (mut nesting, mut is_first, mut found) = (0, true, Vec::new());
    for (at, c) in list.char_indices() {
        match c {
            '}' if nesting == 0 => break,
            '{' => nesting += 1,
            '}' => nesting -= 1,
            ',' if nesting == 0 => is_first = true,
            _ if is_first && !c.is_whitespace() => {
                found.push((at, identifier(&list[at..])));
                is_first = false;
            }
            _ => {}
        }
    }
    found
}

fn identifier(code: &str) -> &str {
    let end = code.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(code.len());
    &code[..end]
}
