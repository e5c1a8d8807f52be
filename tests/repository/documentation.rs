//! The documents keep their word: links lead somewhere, lines fit, and what a page tells the reader to type works.
//!
//! `docs/validation.md` is written by the program and is only searched for links.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::support::data;
use crate::support::program::Place;

const WIDTH: usize = 120;
const README_LINES: usize = 130;

/// A page of text.
struct Page {
    path: PathBuf,
    text: String,
}

impl Page {
    fn read(path: &Path) -> Page {
        let text = fs::read_to_string(path).unwrap_or_else(|reason| panic!("{}: {reason}", path.display()));
        Page { path: path.to_owned(), text }
    }

    fn name(&self) -> String {
        self.path.strip_prefix(root()).unwrap().display().to_string()
    }

    /// Lines outside fenced blocks, with their numbers.
    fn prose(&self) -> impl Iterator<Item = (usize, &str)> {
        let mut fenced = false;
        (1..).zip(self.text.lines()).filter(move |(_, line)| {
            let is_fence = line.trim_start().starts_with("```");
            fenced ^= is_fence;
            !fenced && !is_fence
        })
    }

    /// The fenced blocks in one language.
    fn blocks(&self, language: &str) -> Vec<String> {
        let opening = format!("\n```{language}\n");
        self.text.split(&opening).skip(1).map(|rest| rest.split("```").next().unwrap_or_default().to_owned()).collect()
    }

    /// What follows `](` in prose, and the files that mdBook includes.
    fn links(&self) -> Vec<String> {
        let of_prose = self.prose().flat_map(|(_, line)| line.split("](").skip(1).map(|rest| until(rest, ')')));
        let included = self.text.split("{{#include ").skip(1).map(|rest| until(rest, '}'));
        of_prose.chain(included).collect()
    }

    /// Indented lines that call the program, without what starts it.
    fn commands(&self) -> Vec<String> {
        let called = |line: &str| -> Option<String> {
            let line = line.strip_prefix("    ")?.split(" | ").next()?;
            let line = line.strip_prefix("mpirun -n 2 ").unwrap_or(line);
            let line = line.strip_prefix("target/release/").unwrap_or(line);
            line.strip_prefix("squeal ").map(str::to_owned)
        };
        self.prose().filter_map(|(_, line)| called(line)).collect()
    }
}

fn until(text: &str, end: char) -> String {
    text.split(end).next().unwrap_or_default().to_owned()
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All Markdown files at the top and in `docs/` and `meshes/`.
fn pages() -> Vec<Page> {
    let mut found = Vec::new();
    let mut folders = vec![root().join("docs"), root().join("meshes")];
    found.extend(["README.md", "CHANGELOG.md"].map(|name| root().join(name)));
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                found.push(path);
            }
        }
    }
    found.iter().map(|path| Page::read(path)).collect()
}

fn manual(name: &str) -> Page {
    Page::read(&root().join("docs/manual/src").join(name))
}

#[test]
fn every_link_leads_to_a_file() {
    for page in pages() {
        for link in page.links() {
            // Help texts are written by `make docs`.
            if link.contains("://") || link.starts_with('#') || link.starts_with("generated/") {
                continue;
            }
            let target = page.path.parent().unwrap().join(until(&link, '#'));
            assert!(target.exists(), "{}: {link} leads nowhere", page.name());
        }
    }
}

#[test]
fn lines_fit() {
    for page in pages().iter().filter(|page| page.name() != "docs/validation.md") {
        for (number, line) in page.prose().filter(|(_, line)| !line.trim_start().starts_with('|')) {
            let fits = line.chars().count() <= WIDTH || line.contains("](");
            assert!(fits, "{}:{number}: more than {WIDTH} columns", page.name());
        }
    }
}

#[test]
fn the_readme_is_short() {
    let n = Page::read(&root().join("README.md")).text.lines().count();
    assert!(n <= README_LINES, "{n} lines, not {README_LINES}");
}

/// The program reads a command line from its left: an option that it does not have comes before the help that is asked
/// for.
#[test]
fn every_command_line_is_understood() {
    let place = Place::empty();
    let mut n = 0;
    for page in pages() {
        for command in page.commands() {
            let message = place.run(&command.split_whitespace().chain(["--help"]).collect::<Vec<_>>());
            assert_eq!(message.code, 0, "{}: squeal {command}\n{}", page.name(), message.err);
            n += 1;
        }
    }
    assert!(n > 20, "{n} command lines found");
}

#[test]
fn every_command_has_its_help_in_the_manual() {
    let help = Place::empty().run(&["--help"]).out;
    let list = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let names =
        list.lines().filter_map(|line| line.strip_prefix("  ")?.split(' ').next().filter(|name| !name.is_empty()));
    let text = manual("commands.md").text;
    for name in names.filter(|name| *name != "help") {
        assert!(text.contains(&format!("## {name}\n")), "commands.md: {name} is missing");
    }
}

/// The tutorial's commands up to `check`, which takes its model and that of the README.
#[test]
fn the_first_brake_is_meshed_and_checked() {
    let place = Place::empty();
    for name in ["cad.geo", "brake.geo", "brake.toml"] {
        fs::copy(root().join("docs/manual/first-brake").join(name), place.path(name)).unwrap();
    }
    for arguments in [vec!["-parse_and_exit", "cad.geo"], vec!["-3", "brake.geo", "-o", "brake.msh"]] {
        let made = Command::new("gmsh").args(&arguments).current_dir(place.path("")).output().unwrap();
        assert!(made.status.success(), "gmsh {arguments:?}: {}", String::from_utf8_lossy(&made.stderr));
    }
    let models = Page::read(&root().join("README.md")).blocks("toml");
    assert_eq!(models.len(), 1);
    place.write("readme.toml", &models[0]);
    for model in ["brake.toml", "readme.toml"] {
        let message = place.run(&["check", model]);
        assert_eq!(message.code, 0, "{model}: {}", message.err);
        assert!(message.out.contains("disc"), "{}", message.out);
    }
}

#[test]
fn the_family_of_matrices_becomes_unstable_at_three_quarters() {
    let place = Place::empty();
    for name in ["identity_2.mtx", "hoffmann_k0.mtx", "hoffmann_k1.mtx"] {
        fs::copy(data("matrices").join(name), place.path(name)).unwrap();
    }
    let page = manual("matrices.md");
    place.write("hoffmann.toml", &page.blocks("toml")[0]);
    let command = page.commands().into_iter().find(|command| command.contains("hoffmann.toml")).unwrap();
    let message = place.run(&command.split_whitespace().collect::<Vec<_>>());
    assert_eq!(message.code, 0, "{}", message.err);
    let hopf = place.read("hoffmann-modes/hopf.csv");
    let friction: f64 = hopf.lines().nth(1).unwrap().split(',').next().unwrap().parse().unwrap();
    assert!((friction - 0.75).abs() < 1e-3, "{hopf}");
}

/// The headings of the tables that README and tutorial quote are those that the program prints.
#[test]
fn quoted_tables_have_the_headings_of_the_program() {
    let place = Place::blocks();
    let run = |command: &str| place.run(&[command, "brake.toml", "--friction", "0.4"]).out;
    let printed = words([place.run(&["check", "brake.toml"]).out, run("static"), run("stability")].concat());
    let quoting = [Page::read(&root().join("README.md")), manual("first-brake.md")];
    let quoted: Vec<String> = quoting.iter().flat_map(|page| page.text.lines()).map(words).collect();
    for (heading, n) in [("part elements", 1), ("pair kind", 1), ("pair open", 1), ("friction modes", 2)] {
        let lines: Vec<&String> = quoted.iter().filter(|line| line.starts_with(heading)).collect();
        assert_eq!(lines.len(), n, "{heading}");
        assert!(lines.iter().all(|line| printed.contains(*line)), "{lines:?} is not in: {printed}");
    }
}

/// A text with single spaces.
fn words(text: impl AsRef<str>) -> String {
    text.as_ref().split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn python_reads_json() {
    let place = Place::blocks();
    let programs = assert_cmd::cargo::cargo_bin("squeal").parent().unwrap().display().to_string();
    let path = format!("{programs}:{}", std::env::var("PATH").unwrap());
    let mut python = Command::new("/usr/bin/python3");
    let script = &manual("json.md").blocks("python")[0];
    let run = python.args(["-c", script]).env("PATH", path).current_dir(place.path("")).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&run.stdout), String::from_utf8_lossy(&run.stderr));
    assert!(run.status.success() && out.ends_with(" kg\n"), "{out}{err}");
}

/// Every key of a JSON document and every column of a table has a place in the manual.
#[test]
fn keys_and_columns_are_documented() {
    let place = Place::blocks();
    let known = manual("json.md").text + &manual("files.md").text;
    let require = |name: &str, source: &str| assert!(known.contains(&format!("`{name}`")), "{source}: {name}");
    for command in ["check", "stability"] {
        let message = place.run(&[command, "brake.toml", "--json"]);
        assert_eq!(message.code, 0, "{}", message.err);
        let document: serde_json::Value = serde_json::from_str(&message.out).unwrap();
        keys(&document).iter().for_each(|key| require(key, command));
    }
    for table in place.list("brake-stability").iter().filter(|name| name.ends_with(".csv")) {
        let text = place.read(&format!("brake-stability/{table}"));
        text.lines().next().unwrap().split(',').for_each(|column| require(column, table));
    }
}

/// The keys of all objects in a document.
fn keys(document: &serde_json::Value) -> Vec<String> {
    match document {
        serde_json::Value::Object(map) => {
            map.iter().flat_map(|(key, value)| std::iter::once(key.clone()).chain(keys(value))).collect()
        }
        serde_json::Value::Array(list) => list.iter().flat_map(keys).collect(),
        _ => Vec::new(),
    }
}
