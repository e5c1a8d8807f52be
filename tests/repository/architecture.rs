//! The order of the modules: the table in `src/lib.rs` is the rule. A module may import those above it; `unsafe` stands
//! in one alone.

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use super::source::{code, identifier, line, root, sources, words};

/// The files at the root of the crate that are no modules.
const ROOT: [&str; 2] = ["lib", "main"];

/// The only module that may be unsafe, and import the bindings.
const UNSAFE: &str = "native";

/// The modules in the order of the table in the crate's documentation: the first column, below the head `module`.
fn modules(lib: &str) -> Vec<String> {
    let rows = lib.lines().map_while(|line| line.strip_prefix("//!")).map(str::trim);
    let cell =
        |row: &str| row.strip_prefix('|').and_then(|row| row.split('|').next()).map(|cell| cell.trim().to_owned());
    let table = rows.map(cell).skip_while(|cell| cell.as_deref() != Some("module")).map_while(|cell| cell).skip(2);
    table.map(|cell| cell.trim_matches(['[', ']', '`']).to_owned()).collect()
}

/// The modules that the crate's root declares, sorted.
fn declared(lib: &str) -> Vec<String> {
    let code = code(lib);
    let mut names: Vec<String> =
        words(&code, "mod").map(|at| identifier(code[at + 3..].trim_start()).to_owned()).collect();
    names.sort();
    names
}

fn lib() -> String {
    fs::read_to_string(root().join("src/lib.rs")).unwrap()
}

#[test]
fn the_table_lists_each_module_once() {
    let lib = lib();
    let mut listed = modules(&lib);
    listed.sort();
    assert_eq!(listed, declared(&lib), "the table of src/lib.rs, and its modules");
}

/// Whether the documentation of a text has an example in Rust.
fn has_doctest(text: &str) -> bool {
    let comment = |line: &str| line.trim_start().strip_prefix("//").map(|rest| rest[1..].trim().to_owned());
    let fences = text.lines().filter_map(comment).filter(|line| line.starts_with("```"));
    // Every other fence closes a block.
    fences.step_by(2).any(|fence| ["```", "```no_run"].contains(&fence.as_str()))
}

#[test]
fn every_module_has_a_doctest() {
    let sources = sources("src");
    let is_documented = |module: &String| {
        let own = |path: &Path| {
            path.strip_prefix("src").is_ok_and(|path| {
                path.iter()
                    .next()
                    .is_some_and(|first| Path::new(first).file_stem().is_some_and(|stem| stem.to_str() == Some(module)))
            })
        };
        sources.iter().any(|source| own(&source.path) && has_doctest(&source.text))
    };
    let private = ["hdf", "algebra"];
    let public = modules(&lib()).into_iter().filter(|module| !private.contains(&module.as_str()));
    let without: Vec<String> = public.filter(|module| !is_documented(module)).collect();
    assert!(without.is_empty(), "{without:?}");
    assert!(has_doctest("/// ```\n/// f();\n/// ```\n") && !has_doctest("//! ```text\n//! f = p n\n//! ```\n"));
}

#[test]
fn modules_import_only_modules_above_them() {
    let rule = Rule::new(&lib());
    let complaints: Vec<String> = sources("src")
        .iter()
        .flat_map(|source| rule.complaints_about(source.path.strip_prefix("src").unwrap(), &source.text))
        .collect();
    assert!(complaints.is_empty(), "\n{}\n", complaints.join("\n"));
}

/// What the crate's root says.
struct Rule {
    /// The modules from the top of the table.
    order: Vec<String>,
    /// What stands at the root of the crate under its own name, and its module.
    exports: HashMap<String, String>,
}

impl Rule {
    fn new(lib: &str) -> Rule {
        Rule { order: modules(lib), exports: exports(lib) }
    }

    /// What is wrong with a file, given by its path in `src/`.
    fn complaints_about(&self, file: &Path, text: &str) -> Vec<String> {
        let names: Vec<&str> = file.iter().map(|name| name.to_str().unwrap().trim_end_matches(".rs")).collect();
        let (module, depth) = (names[0], names.iter().filter(|name| **name != "mod").count());
        let code = code(text);
        let complain = |at: usize, what: String| format!("src/{}:{}: {what}", file.display(), line(&code, at));
        let mut complaints = Vec::new();
        for word in ["unsafe", "squeal_sys"].into_iter().filter(|_| module != UNSAFE) {
            let what = format!("`{word}` belongs in src/{UNSAFE} alone");
            complaints.extend(words(&code, word).map(|at| complain(at, what.clone())));
        }
        if ROOT.contains(&module) {
            return complaints;
        }
        let Some(place) = self.order.iter().position(|name| name == module) else {
            return vec![format!("src/{}: the module `{module}` is not in the table of src/lib.rs", file.display())];
        };
        for (at, name) in imports(&code) {
            let import = self.exports.get(name).map_or(name, String::as_str);
            if import != module && !self.order[..place].iter().any(|above| above == import) {
                complaints.push(complain(at, format!("`{module}` imports `{import}`, which is not above it")));
            }
        }
        let outside = format!("\nuse {}", "super::".repeat(depth));
        if let Some(at) = format!("\n{code}").find(&outside) {
            complaints.push(complain(at, "a module is left by `crate::`, not by `super::`".to_owned()));
        }
        complaints
    }
}

/// The names that the crate's root re-exports, `pub use module::...;`, each with its module.
fn exports(lib: &str) -> HashMap<String, String> {
    let code = code(lib);
    let mut all = HashMap::new();
    for statement in code.split("pub use ").skip(1).map(|rest| rest.split(';').next().unwrap_or_default()) {
        let mut names = statement.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|name| !name.is_empty());
        let module = names.next().unwrap_or_default();
        all.extend(names.map(|name| (name.to_owned(), module.to_owned())));
    }
    all
}

/// The names that `crate::name` and `crate::{name, name::...}` import, each with its place.
fn imports(code: &str) -> Vec<(usize, &str)> {
    let mut found = Vec::new();
    for at in words(code, "crate") {
        let Some(path) = code[at + 5..].strip_prefix("::") else { continue };
        match path.strip_prefix('{') {
            Some(list) => found.extend(listed(list).into_iter().map(|(offset, name)| (at + 8 + offset, name))),
            None => found.push((at, identifier(path))),
        }
    }
    found
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

const LIB: &str = "//! Text.\n//!\n//! | symbol | meaning |\n//! |---|---|\n//! | `x` | place |\n//!\n\
                   //! | module | what it does |\n//! |---|---|\n//! | `error` | errors |\n//! | [`mesh`] | meshes |\n\
                   //! | [`model`] | models |\n//! | [`native`] | MPI |\n//!\n//! After.\n\nmod error;\npub mod mesh;\n\
                   pub mod model;\n// mod none;\npub mod native;\npub use error::{Error, Result};\npub use model::Model;\n";

#[test]
fn the_table_is_found_among_others() {
    assert_eq!(modules(LIB), ["error", "mesh", "model", "native"]);
    assert_eq!(declared(LIB), ["error", "mesh", "model", "native"]);
    assert!(modules("//! No table.\n").is_empty());
}

#[test]
fn what_is_forbidden_is_found() {
    let rule = Rule::new(LIB);
    let message = |file: &str, text: &str| rule.complaints_about(Path::new(file), text).join("\n");
    assert_eq!(message("model/read.rs", "// crate::cli\nuse crate::mesh::Mesh;\nuse crate::{Error, Result};\n"), "");
    assert_eq!(message("model/read.rs", "fn f() { g(\"crate::native // x\"); crate::mesh::read() }"), "");
    let upwards = message("mesh/tets.rs", "use super::Point;\n\nuse crate::model::Model;\n");
    assert_eq!(upwards, "src/mesh/tets.rs:3: `mesh` imports `model`, which is not above it");
    assert!(message("mesh/read.rs", "use crate::Model;").contains("`mesh` imports `model`"));
    let in_a_list = message("mesh/read.rs", "use crate::{\n    Error,\n    model::{Model, Part},\n    native,\n};\n");
    assert!(in_a_list.contains(":3: `mesh` imports `model`"), "{in_a_list}");
    assert!(in_a_list.contains(":4: `mesh` imports `native`"), "{in_a_list}");
    assert!(message("mesh/law/mod.rs", "fn f() { crate::native::init() }").contains("imports `native`"));
    assert!(
        message("mesh/law/mod.rs", "use super::super::native::Comm;")
            .contains("src/mesh/law/mod.rs:1: a module is left")
    );
    assert!(message("kitchen.rs", "").contains("`kitchen` is not in the table"));
    assert!(message("model/mod.rs", "fn f() {\n    unsafe {}\n}").contains("src/model/mod.rs:2: `unsafe`"));
    assert!(message("lib.rs", "unsafe {}").contains("src/lib.rs:1: `unsafe`"));
    assert!(message("model/mod.rs", "use squeal_sys as sys;").contains("src/model/mod.rs:1: `squeal_sys`"));
    assert_eq!(message("native/petsc/vector.rs", "use squeal_sys as sys;\nunsafe {}"), "");
}
