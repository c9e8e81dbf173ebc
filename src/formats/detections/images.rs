//! Which images of a file of detections are meant, by their names.

use std::collections::BTreeMap;

/// Whether `name` is of the form `pattern`, in which `*` stands for any text and `?` for one character.
pub(super) fn matches(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    // Where to go on if the last star has to stand for one character more.
    let mut retry: Option<(usize, usize)> = None;
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => {
                retry = Some((p + 1, n));
                p += 1;
            }
            Some(c) if *c == '?' || *c == name[n] => (p, n) = (p + 1, n + 1),
            _ => match retry {
                Some((after, at)) => {
                    retry = Some((after, at + 1));
                    (p, n) = (after, at + 1);
                }
                None => return false,
            },
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}

/// The cameras that `names` tell, with their numbers of images; none unless every image is of one, there are several, and
/// each has several images.
///
/// A camera is `cam` or `camera` with a number, as in mrcal's `frame7-cam1.jpg`, or `left` and `right`.
pub(super) fn cameras<'a>(names: impl IntoIterator<Item = &'a str>) -> Vec<(&'a str, usize)> {
    let mut counts = BTreeMap::new();
    for name in names {
        let Some(camera) = camera_of(name) else { return Vec::new() };
        *counts.entry(camera).or_insert(0) += 1;
    }
    let are_cameras = counts.len() > 1 && counts.values().all(|&count| count > 1);
    if are_cameras { counts.into_iter().collect() } else { Vec::new() }
}

fn camera_of(name: &str) -> Option<&str> {
    let words = || {
        name.match_indices(char::is_alphabetic).filter_map(|(start, _)| {
            let before = name[..start].chars().next_back();
            before.is_none_or(|c| !c.is_alphabetic()).then_some(start)
        })
    };
    let mut numbered = words().filter_map(|start| {
        let rest = &name[start..];
        let word = ["camera", "cam"].into_iter().find(|word| starts_with(rest, word))?;
        let number = rest[word.len()..].trim_start_matches(['-', '_']);
        let skipped = rest.len() - number.len();
        let digits = number.bytes().take_while(u8::is_ascii_digit).count();
        (digits > 0).then(|| &rest[..skipped + digits])
    });
    let sided = || {
        words().find_map(|start| {
            let side = ["left", "right"].into_iter().find(|side| starts_with(&name[start..], side))?;
            let end = start + side.len();
            name[end..].chars().next().is_none_or(|c| !c.is_alphabetic()).then(|| &name[start..end])
        })
    };
    numbered.next_back().or_else(sided)
}

fn starts_with(text: &str, word: &str) -> bool {
    text.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_whole_names() {
        for (pattern, name, is) in [
            ("*cam0*", "frame1-cam0.jpg", true),
            ("*cam0*", "frame1-cam1.jpg", false),
            ("left??.jpg", "left07.jpg", true),
            ("left??.jpg", "left007.jpg", false),
            ("*", "", true),
            ("", "a", false),
            ("a*b*c", "a1b2b3c", true),
            ("a*b*c", "a1b2b3", false),
            ("*é?", "caméx", true),
        ] {
            assert_eq!(matches(pattern, name), is, "{pattern} {name}");
        }
    }

    #[test]
    fn names_tell_several_cameras_only_where_each_has_several_images() {
        let two = ["f1-cam0.jpg", "f1-cam1.jpg", "f2-cam0.jpg", "f2-cam1.jpg", "f3-cam1.jpg"];
        assert_eq!(cameras(two), [("cam0", 2), ("cam1", 3)]);
        assert_eq!(cameras(["camera_1/a.png", "camera_2/a.png", "camera_1/b.png", "camera_2/b.png"]).len(), 2);
        assert_eq!(cameras(["left1.png", "right1.png", "left2.png", "right2.png"]), [("left", 2), ("right", 2)]);
        for one in [
            &["cam1.png", "cam2.png", "cam3.png"][..],
            &["left1.png", "left2.png"],
            &["f1-cam0.jpg", "f2-cam0.jpg"],
            &["f1-cam0.jpg", "f1-cam1.jpg", "f2-cam0.jpg", "f2-cam1.jpg", "other.jpg"],
            &["webcam1a.png", "webcam1b.png", "leftover.png", "rightly.png"],
        ] {
            assert!(cameras(one.iter().copied()).is_empty(), "{one:?}");
        }
    }
}
