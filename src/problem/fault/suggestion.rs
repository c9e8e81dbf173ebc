//! What may have been meant by a name that does not exist.

use crate::camera::Lens;

/// "did you mean" the name that other tools have `found` for, the most similar name, or all there are.
pub(super) fn suggestion(found: &str, allowed: &[String], list: &str) -> String {
    const SIMILAR: f64 = 0.8;
    let same = |a: &str| a.replace('-', "_").eq_ignore_ascii_case(&found.replace('-', "_"));
    let known_as = |lens: &&Lens| lens.known_as().iter().any(|&other| same(other));
    if let Some(lens) = Lens::ALL.iter().find(known_as).filter(|lens| allowed.iter().any(|name| name == lens.name())) {
        return format!("did you mean `{}`, which other tools call {found}? {list}: {}", lens.name(), quoted(allowed));
    }
    // Case and the sign between words are no part of a name's meaning.
    let plain = |name: &str| name.to_lowercase().replace(['_', ' '], "-");
    let found = plain(found);
    let similarity = |name: &String| strsim::jaro_winkler(&found, &plain(name));
    match allowed.iter().max_by(|a, b| similarity(a).total_cmp(&similarity(b))) {
        Some(name) if similarity(name) > SIMILAR => format!("did you mean `{name}`? {list}: {}", quoted(allowed)),
        Some(_) => format!("{list}: {}", quoted(allowed)),
        None => "there is nothing to choose from".into(),
    }
}

pub(super) fn quoted(names: &[String]) -> String {
    /// Robots may have a hundred links.
    const MOST: usize = 40;
    let quoted: Vec<String> = names.iter().take(MOST).map(|name| format!("`{name}`")).collect();
    let more = if names.len() > MOST { format!(" and {} more", names.len() - MOST) } else { String::new() };
    format!("{}{more}", quoted.join(", "))
}
