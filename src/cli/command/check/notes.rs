//! What was read otherwise than it stands in the files.

use crate::problem::Problem;

/// More lines would hide what comes after them; the document has all.
const MOST: usize = 12;

/// The notes, a line each.
pub(super) fn notes_text(problem: &Problem) -> String {
    let notes = problem.notes.iter();
    let mut text: String = notes.take(MOST).map(|note| format!("Note on `{}`: {}.\n", note.key, note.text)).collect();
    if problem.notes.len() > MOST {
        text += &format!("{} more notes; --json has them all.\n", problem.notes.len() - MOST);
    }
    text
}
