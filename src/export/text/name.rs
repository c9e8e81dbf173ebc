//! Names that programming languages take.

use std::collections::HashSet;

/// Names of one scope: letters, digits and underscores of ASCII, a letter first, none twice or reserved, whatever the case.
pub(in crate::export) struct Names {
    longest: usize,
    taken: HashSet<String>,
}

impl Names {
    /// No names yet; they may have so many characters, and be none of the words `reserved`, in lower case.
    pub(in crate::export) fn new(longest: usize, reserved: &str) -> Self {
        Self { longest, taken: reserved.split_whitespace().map(str::to_owned).collect() }
    }

    /// The name nearest to `wish` that is free; `otherwise`, a word, stands in front where `wish` has no letter first.
    pub(in crate::export) fn take(&mut self, wish: &str, otherwise: &str) -> String {
        let mut name = legal(wish);
        if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
            name = legal(&format!("{otherwise}_{name}"));
        }
        let mut free = self.cut(&name, "");
        let mut nth = 1;
        while !self.taken.insert(free.to_ascii_lowercase()) {
            nth += 1;
            free = self.cut(&name, &format!("_{nth}"));
        }
        free
    }

    fn cut(&self, name: &str, end: &str) -> String {
        let beginning = &name[..name.len().min(self.longest - end.len())];
        format!("{}{end}", beginning.trim_end_matches('_'))
    }
}

/// `text` with single underscores for all that is not a letter or digit of ASCII, none of them first or last.
fn legal(text: &str) -> String {
    let words = text.split(|c: char| !c.is_ascii_alphanumeric()).filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("_")
}

/// A file's name made of the plan's, with `ending`.
pub(in crate::export) fn file_name(name: &str, ending: &str) -> String {
    format!("{}.{ending}", Names::new(60, "").take(name, "tour"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_legal_short_and_unique() {
        let mut names = Names::new(8, "end");
        let wishes = ["pose 7", "Pose-7", "7", "日本", "END", "a very long name", "a very longer one", "__é__", ""];
        let taken = wishes.map(|wish| names.take(wish, "p"));
        assert_eq!(taken, ["pose_7", "Pose_7_2", "p_7", "p", "END_2", "a_very_l", "a_very_2", "p_2", "p_3"]);
    }

    #[test]
    fn files_are_named_after_the_plan() {
        assert_eq!(file_name("../Meine Fräse", "csv"), "Meine_Fr_se.csv");
    }
}
