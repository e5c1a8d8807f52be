//! The repository's Rust files, and as much of their grammar as its rules need.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A Rust file.
pub struct Source {
    /// Path from the repository's root.
    pub path: PathBuf,
    pub text: String,
}

/// The repository's root.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All Rust files below a folder of the repository, sorted.
pub fn sources(folder: &str) -> Vec<Source> {
    let (mut folders, mut found) = (vec![root().join(folder)], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = fs::read_to_string(&path).unwrap();
                found.push(Source { path: path.strip_prefix(root()).unwrap().to_owned(), text });
            }
        }
    }
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found
}

/// The text with everything in comments, strings and characters blanked, byte for byte; lines stay where they are.
pub fn code(text: &str) -> String {
    let bytes = text.as_bytes();
    let (mut code, mut at) = (bytes.to_vec(), 0);
    while at < bytes.len() {
        let end = at + blank_length(&bytes[at..], at > 0 && is_word(bytes[at - 1]));
        code[at..end].iter_mut().filter(|byte| **byte != b'\n').for_each(|byte| *byte = b' ');
        at = end.max(at + 1);
    }
    String::from_utf8(code).unwrap()
}

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

/// Bytes of the comment, string or character that starts here; 0 where none does.
fn blank_length(rest: &[u8], after_word: bool) -> usize {
    let n = rest.len();
    let until = |from: usize, end: &[u8]| (from..n).find(|&i| rest[i..].starts_with(end)).map_or(n, |i| i + end.len());
    match rest {
        [b'/', b'/', ..] => until(2, b"\n"),
        [b'/', b'*', ..] => until(2, b"*/"),
        [b'"', ..] => quoted(rest),
        [b'r', b'#' | b'"', ..] if !after_word => {
            let hashes = rest[1..].iter().take_while(|byte| **byte == b'#').count();
            let is_string = rest.get(1 + hashes) == Some(&b'"');
            if is_string { until(2 + hashes, &[b"\"", "#".repeat(hashes).as_bytes()].concat()) } else { 0 }
        }
        [b'\'', b'\\', ..] => until(3, b"'"),
        [b'\'', ..] => {
            // A character has its second quote after one character; a lifetime has none.
            let width = std::str::from_utf8(&rest[1..n.min(5)]).map_or_else(|e| e.valid_up_to(), str::len);
            let text = std::str::from_utf8(&rest[1..1 + width]).unwrap_or_default();
            let first = text.chars().next().map_or(0, char::len_utf8);
            if first > 0 && rest.get(1 + first) == Some(&b'\'') { first + 2 } else { 0 }
        }
        _ => 0,
    }
}

/// Bytes of a string with escapes.
fn quoted(rest: &[u8]) -> usize {
    let mut at = 1;
    while at < rest.len() && rest[at] != b'"' {
        at += if rest[at] == b'\\' { 2 } else { 1 };
    }
    rest.len().min(at + 1)
}

/// Number of the line, from 1.
pub fn line(code: &str, at: usize) -> usize {
    1 + code[..at].matches('\n').count()
}

/// Where a word stands.
pub fn words<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let bytes = code.as_bytes();
    let is_whole = move |at: &usize| {
        let end = at + word.len();
        (*at == 0 || !is_word(bytes[at - 1])) && !bytes.get(end).copied().is_some_and(is_word)
    };
    code.match_indices(word).map(|(at, _)| at).filter(is_whole)
}

/// The name that starts here.
pub fn identifier(code: &str) -> &str {
    let end = code.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(code.len());
    &code[..end]
}

/// The block in braces that starts at or after a place, without the braces' outside.
pub fn block(code: &str, from: usize) -> Option<Range<usize>> {
    let (mut depth, mut start) = (0_usize, None);
    for (at, byte) in code.bytes().enumerate().skip(from) {
        match byte {
            b';' if start.is_none() && depth == 0 => return None,
            b'(' | b'[' if start.is_none() => depth += 1,
            b')' | b']' if start.is_none() => depth = depth.checked_sub(1)?,
            b'{' if start.is_none() => (start, depth) = (Some(at), 1),
            b'{' => depth += 1,
            b'}' if start.is_some() => {
                depth -= 1;
                if depth == 0 {
                    return start.map(|start| start..at + 1);
                }
            }
            _ => (),
        }
    }
    None
}

/// The code without its modules of tests.
pub fn production(code: &str) -> String {
    let mut code = code.to_owned();
    while let Some(at) = code.find("#[cfg(test)]") {
        let end = block(&code, at + "#[cfg(test)]".len()).map_or(at + "#[cfg(test)]".len(), |block| block.end);
        let blank: String = code[at..end].chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect();
        code.replace_range(at..end, &blank);
    }
    code
}

/// The functions with a body: name, line, number of lines.
pub fn functions(code: &str) -> Vec<(String, usize, usize)> {
    let of = |at: usize| {
        // Without a name it is the type of a function.
        let name = Some(identifier(code[at + 2..].trim_start())).filter(|name| !name.is_empty())?;
        let (body, first) = (block(code, at)?, line(code, at));
        Some((name.to_owned(), first, line(code, body.end) - first + 1))
    };
    words(code, "fn").filter_map(of).collect()
}

#[test]
fn comments_and_strings_are_blanked() {
    let blanked = |text: &str| {
        let code = code(text);
        assert_eq!(code.len(), text.len());
        code.split_whitespace().collect::<Vec<_>>().join(" ")
    };
    assert_eq!(blanked("a // crate::b\nc"), "a c");
    assert_eq!(blanked("a /* x\n y */ b"), "a b");
    assert_eq!(blanked(r#"f("http://x \" y", z)"#), "f( , z)");
    assert_eq!(blanked("g(r#\"say \"unsafe\"\"#, '\"', b)"), "g( , , b)");
    assert_eq!(blanked("fn f<'a>(x: &'a str) -> char { '\\'' }"), "fn f<'a>(x: &'a str) -> char { }");
    assert_eq!(blanked("a('\u{e9}', \"\u{e9}\") b"), "a( , ) b");
}

#[test]
fn functions_are_measured_without_tests() {
    let text = "impl A {\n    fn f(x: [u8; 3]) -> u8 {\n        x[0]\n    }\n}\nfn g();\n#[cfg(test)]\nmod tests {\n    fn h() {\n    }\n}\n";
    let of = |text: &str| functions(text);
    assert_eq!(of(text), [("f".to_owned(), 2, 3), ("h".to_owned(), 9, 2)]);
    assert_eq!(of(&production(text)), [("f".to_owned(), 2, 3)]);
    assert_eq!(of("fn f() -> impl Fn(u8) {\n}"), [("f".to_owned(), 1, 2)]);
    assert_eq!(of("let f = (1 as fn(u8) -> u8);\n{\n}"), []);
}
