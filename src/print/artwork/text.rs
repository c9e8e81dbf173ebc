//! Lines of text in Helvetica, which PDF readers have, and how wide they are.

use super::Rectangle;

/// A line of text.
#[derive(Debug, Clone, PartialEq)]
pub struct Text {
    /// Where it is anchored, on its baseline.
    pub at: [f64; 2],
    /// Which of its points that is.
    pub anchor: Anchor,
    /// Size of the font.
    pub size: f64,
    /// Whether it reads upwards.
    pub upwards: bool,
    /// What it says.
    pub words: String,
}

/// Where a text is anchored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// At its start.
    Start,
    /// In its middle.
    Middle,
}

/// Widths of Helvetica's characters from the space to `~`, in thousandths of the font's size (Adobe's metrics of the core fonts).
const WIDTHS: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556, 556, 556, 556, 556,
    556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833,
    722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556,
    556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334,
    260, 334, 584,
];

/// For characters beyond the table: those of other scripts are seldom wider.
const WIDE: u16 = 722;

impl Text {
    /// A text that starts at a point.
    pub(in crate::print) fn new(at: [f64; 2], size: f64, words: &str) -> Self {
        Self { at, anchor: Anchor::Start, size, upwards: false, words: words.to_owned() }
    }

    /// The same with its middle at the point.
    pub(in crate::print) fn centred(self) -> Self {
        Self { anchor: Anchor::Middle, ..self }
    }

    /// The same as small, down to half of its size, and then as short as fits into `room`.
    pub(in crate::print) fn fitted(mut self, room: f64) -> Self {
        let size = self.size;
        self.size = (size * room / self.width()).clamp(size / 2.0, size);
        let mut kept = self.words.chars().count();
        let full = self.words.clone();
        while self.width() > room && kept > 0 {
            kept -= 1;
            self.words = full.chars().take(kept).collect::<String>() + "...";
        }
        self
    }

    /// The rectangle around it, with what hangs below the baseline.
    pub(in crate::print) fn bounds(&self) -> Rectangle {
        /// Heights over the baseline of Helvetica's lowest and highest lines, of the font's size.
        const HEIGHTS: [f64; 2] = [-0.22, 0.75];
        let begin = match self.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -self.width() / 2.0,
        };
        let ([x, y], [low, high]) = (self.at, HEIGHTS.map(|height| height * self.size));
        let end = begin + self.width();
        if self.upwards {
            Rectangle::between([x - low, y + begin], [x - high, y + end])
        } else {
            Rectangle::between([x + begin, y + low], [x + end, y + high])
        }
    }

    /// How wide it is.
    pub(in crate::print) fn width(&self) -> f64 {
        let width = |character| {
            let index = u32::from(character).checked_sub(u32::from(' ')).map(|index| index as usize);
            f64::from(index.and_then(|index| WIDTHS.get(index)).copied().unwrap_or(WIDE))
        };
        self.words.chars().map(width).sum::<f64>() * self.size / 1e3
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_texts_shrink_and_then_lose_their_end() {
        let text = |room| Text::new([0.0, 0.0], 3.0, "Squares of 35 mm").fitted(room);
        assert!((text(99.0).width() - 24.51).abs() < 0.01, "{}", text(99.0).width());
        assert_eq!(text(99.0).size, 3.0);
        let shrunk = text(20.0);
        assert!((shrunk.width() - 20.0).abs() < 1e-9 && shrunk.words.ends_with("35 mm"));
        let cut = text(9.0);
        assert!(cut.size == 1.5 && cut.width() <= 9.0 && cut.words.ends_with("..."), "{cut:?}");
        assert_eq!(text(0.1).words, "...", "nothing is left to leave out");
    }
}
