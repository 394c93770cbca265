//! "did you mean": the nearest allowed name by edit distance (Levenshtein, 1966).
//!
//! Only a name within a third of its length is offered; a farther one would confuse. Tested by known
//! distances.

/// ` did you mean 'x'?` with a leading space, or nothing when no name is near.
pub fn did_you_mean<'a>(found: &str, allowed: impl IntoIterator<Item = &'a str>) -> String {
    let near = allowed
        .into_iter()
        .map(|name| (edit_distance(found, name), name))
        .filter(|(distance, name)| {
            let length = name.chars().count();
            // Of a name of one letter nothing would be left.
            *distance <= length.div_ceil(3) && *distance < length.max(found.chars().count())
        })
        .min_by_key(|(distance, _)| *distance);
    near.map_or(String::new(), |(_, name)| format!(" did you mean '{name}'?"))
}

/// Insertions, deletions and replacements of characters that make `b` of `a`.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, a_char) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, b_char) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(a_char != *b_char);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_distances() {
        assert_eq!(edit_distance("kitten", "sitting"), 3);
        assert_eq!(edit_distance("", "abc"), 3);
        assert_eq!(edit_distance("abc", ""), 3);
        assert_eq!(edit_distance("same", "same"), 0);
    }

    #[test]
    fn offers_only_what_is_near() {
        let names = ["albedo", "density"];
        assert_eq!(did_you_mean("albdo", names), " did you mean 'albedo'?");
        assert_eq!(did_you_mean("xyz", names), "");
        assert_eq!(did_you_mean("gg", ["g"]), " did you mean 'g'?");
        assert_eq!(did_you_mean("x", ["g"]), "");
    }
}
