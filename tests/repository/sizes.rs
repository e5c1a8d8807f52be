//! Lines that fit, functions and files that can be read at one go.

use super::source::{Source, code, functions, production, sources};

/// Columns of a line.
const WIDTH: usize = 120;
/// Lines of a function.
const LONGEST_FUNCTION: usize = 45;
/// Lines of a file.
const LONGEST_FILE: usize = 400;

/// Folders with comments that are wider still, to be wrapped.
const TOO_WIDE: &[&str] = &[];

#[test]
fn lines_fit() {
    // Formatting leaves strings as they are, so that of a line of code only indentation and code count.
    let fits = |(line, code): (&str, &str)| {
        let start = line.trim_start();
        let rest: usize = code.split_whitespace().map(|word| word.len() + 1).sum();
        line.chars().count() <= WIDTH || (!start.starts_with("//") && line.len() - start.len() + rest <= WIDTH)
    };
    let too_wide = |source: &Source| -> Vec<String> {
        let code = code(&source.text);
        let lines = source.text.lines().zip(code.lines()).enumerate().filter(|(_, pair)| !fits(*pair));
        lines.map(|(i, _)| format!("{}:{}", source.path.display(), i + 1)).collect()
    };
    let all: Vec<String> = ["src", "tests", "examples", "benches", "sys"]
        .iter()
        .flat_map(|folder| sources(folder))
        .filter(|source| !TOO_WIDE.iter().any(|known| source.path.starts_with(known)))
        .flat_map(|source| too_wide(&source))
        .collect();
    assert!(all.is_empty(), "more than {WIDTH} columns:\n{}", all.join("\n"));
}

/// Whether a file has nothing but tests.
fn is_test(source: &Source) -> bool {
    let name = |part: &std::ffi::OsStr| ["tests", "testing", "tests.rs", "testing.rs"].iter().any(|test| part == *test);
    source.path.iter().any(name)
}

#[test]
fn functions_are_short() {
    let mut wrong = Vec::new();
    for source in sources("src").iter().filter(|source| !is_test(source)) {
        for (name, line, n) in functions(&production(&code(&source.text))) {
            if n > LONGEST_FUNCTION {
                wrong.push(format!("{}:{line}: {name} has {n} lines", source.path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "longer than {LONGEST_FUNCTION} lines:\n{}", wrong.join("\n"));
}

#[test]
fn files_are_short() {
    let is_long = |source: &Source| source.text.lines().count() > LONGEST_FILE;
    let wrong: Vec<String> = sources("src")
        .iter()
        .filter(|source| is_long(source))
        .map(|source| format!("{}: {} lines", source.path.display(), source.text.lines().count()))
        .collect();
    assert!(wrong.is_empty(), "longer than {LONGEST_FILE} lines:\n{}", wrong.join("\n"));
}
