//! Names that people mistype: the nearest right one, and lists short enough to read.

/// The candidate most like `name`, unless none is alike (similarity below one half).
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let name = name.to_lowercase();
    candidates
        .into_iter()
        .map(|c| (strsim::normalized_damerau_levenshtein(&name, &c.to_lowercase()), c))
        .filter(|(similarity, _)| *similarity >= 0.5)
        .reduce(|best, next| if next.0 > best.0 { next } else { best })
        .map(|(_, candidate)| candidate)
}

/// Advice for an unknown name: the nearest right one, and what there is.
pub fn advice<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> String {
    let all: Vec<&str> = candidates.into_iter().collect();
    let listed = match all.len() {
        0 => "There is none".to_owned(),
        _ => format!("There is: {}", list(&all)),
    };
    match nearest(name, all.iter().copied()) {
        Some(near) => format!("Did you mean {near:?}? {listed}"),
        None => listed,
    }
}

/// At most 24 names, separated by commas, and how many more there are.
pub fn list(names: &[&str]) -> String {
    const SHOWN: usize = 24;
    let shown = names[..names.len().min(SHOWN)].join(", ");
    match names.len().saturating_sub(SHOWN) {
        0 => shown,
        more => format!("{shown} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn swapped_letters_and_case_find_the_right_name() {
        assert_eq!(nearest("yuong", ["young", "poisson"]), Some("young"));
        assert_eq!(nearest("DISC_FACE", ["disc_face", "pad_face"]), Some("disc_face"));
        assert_eq!(nearest("caliper", ["young", "poisson"]), None);
    }

    #[test]
    fn long_lists_are_cut_with_a_count() {
        let many: Vec<String> = (0..30).map(|i| i.to_string()).collect();
        let many: Vec<&str> = many.iter().map(String::as_str).collect();
        assert!(list(&many).ends_with("22, 23 and 6 more"));
        assert_eq!(advice("x", []), "There is none");
    }
}
