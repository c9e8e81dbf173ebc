//! Sizes of paper.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

use crate::figures::trimmed;

/// A page's size in mm, as it lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paper {
    /// Name of a standard size; none of another.
    pub name: Option<&'static str>,
    /// Width and height in mm.
    pub size: [f64; 2],
}

/// Why a text names no paper.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum PaperError {
    /// There is no such size.
    #[error("there is no such page{}; known are {}, or a size in mm as in 400x300",
        likely.map_or(String::new(), |name| format!(" (did you mean {name}?)")), Paper::STANDARD.map(|paper| paper.0).join(", "))]
    Unknown {
        /// The size that may have been meant.
        likely: Option<&'static str>,
    },
    /// A size that no page has.
    #[error("width and height must be from {} to {} mm", Paper::LEAST, Paper::MOST)]
    Size,
}

impl Paper {
    /// The standard sizes, upright, in mm.
    pub const STANDARD: [(&'static str, [f64; 2]); 12] = [
        ("A5", [148.0, 210.0]),
        ("A4", [210.0, 297.0]),
        ("A3", [297.0, 420.0]),
        ("A2", [420.0, 594.0]),
        ("A1", [594.0, 841.0]),
        ("A0", [841.0, 1189.0]),
        ("letter", [215.9, 279.4]),
        ("legal", [215.9, 355.6]),
        ("tabloid", [279.4, 431.8]),
        ("ansi-c", [431.8, 558.8]),
        ("ansi-d", [558.8, 863.6]),
        ("ansi-e", [863.6, 1117.6]),
    ];

    /// Shortest side of a page in mm.
    pub const LEAST: f64 = 50.0;

    /// Longest side in mm: PDF's readers take 200 inches at most.
    pub const MOST: f64 = 5080.0;

    /// The standard size of that name, in capitals or not.
    pub fn named(name: &str) -> Option<Self> {
        let (name, size) = *Self::STANDARD.iter().find(|(known, _)| known.eq_ignore_ascii_case(name))?;
        Some(Self { name: Some(name), size })
    }

    /// The standard sizes of the same family, from the smallest; the A sizes unless this one is American. Smaller ones than a
    /// printer's usual paper are not among them.
    pub(super) fn family(self) -> impl Iterator<Item = Self> {
        let is_iso = |name: &str| name.starts_with('A');
        let own = self.name.is_none_or(is_iso);
        let usual = Self::STANDARD.into_iter().filter(move |&(name, _)| is_iso(name) == own && name != "A5");
        usual.map(|(name, size)| Self { name: Some(name), size })
    }

    /// The same sheet, turned by a quarter.
    #[must_use]
    pub fn turned(self) -> Self {
        let [width, height] = self.size;
        Self { size: [height, width], ..self }
    }
}

impl FromStr for Paper {
    type Err = PaperError;

    /// A standard size by its name, or `WIDTHxHEIGHT` in mm.
    fn from_str(text: &str) -> Result<Self, PaperError> {
        /// How similar a name must be to be proposed.
        const SIMILAR: f64 = 0.6;
        let text = text.trim();
        if let Some(paper) = Self::named(text) {
            return Ok(paper);
        }
        let plain = text.to_lowercase();
        let sides = plain.trim_end_matches("mm").split_once(['x', '×']);
        let number = |text: &str| text.trim().parse::<f64>().ok();
        if let Some(size) = sides.and_then(|(width, height)| Some([number(width)?, number(height)?])) {
            let is_possible = size.iter().all(|side| (Self::LEAST..=Self::MOST).contains(side));
            return if is_possible { Ok(Self { name: None, size }) } else { Err(PaperError::Size) };
        }
        let similarity = |name: &str| strsim::jaro_winkler(&plain, &name.to_lowercase());
        let names = Self::STANDARD.into_iter().map(|(name, _)| name);
        let likely = names.max_by(|a, b| similarity(a).total_cmp(&similarity(b)));
        Err(PaperError::Unknown { likely: likely.filter(|name| similarity(name) > SIMILAR) })
    }
}

impl fmt::Display for Paper {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [width, height] = self.size.map(|side| trimmed(side, 4));
        match self.name {
            Some(name) => write!(f, "{name} ({width} × {height} mm)"),
            None => write!(f, "{width} × {height} mm"),
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn papers_are_known_by_name_and_by_size() {
        let said = |text: &str| match text.parse::<Paper>() {
            Ok(paper) => paper.to_string(),
            Err(error) => error.to_string(),
        };
        assert_eq!(said("a3"), "A3 (297 × 420 mm)");
        assert_eq!(said("Letter"), "letter (215.9 × 279.4 mm)");
        assert_eq!(said("400x300"), "400 × 300 mm");
        assert_eq!(said("400 x 300.5 mm"), "400 × 300.5 mm");
        assert!(said("leter").contains("did you mean letter?"), "{}", said("leter"));
        assert!(said("A44").contains("did you mean A4?"), "{}", said("A44"));
        let known = "there is no such page; known are A5, A4, A3";
        assert!(said("folio").starts_with(known) && said("").starts_with(known), "{}", said("folio"));
        for size in ["49x300", "300x5081", "-300x400", "0x0", "infx400", "NaNx400"] {
            assert_eq!(said(size), "width and height must be from 50 to 5080 mm", "{size}");
        }
    }

    #[test]
    fn families_grow() {
        for name in ["A5", "letter"] {
            let family: Vec<Paper> = Paper::named(name).unwrap().family().collect();
            assert!(family.windows(2).all(|pair| pair[0].size[1] < pair[1].size[1]), "{family:?}");
        }
        assert_eq!(Paper { name: None, size: [90.0, 90.0] }.family().next(), Paper::named("A4"));
    }
}
