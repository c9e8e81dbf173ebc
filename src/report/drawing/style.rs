//! Sizes and colours of drawings.

use kuva::render::theme::Theme;

use crate::report::figure::Hue;

/// Px of SVG to an inch.
pub(super) const PX_PER_INCH: f64 = 96.0;

/// Size and colours of a drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct Style {
    /// Width, px.
    pub width: f64,
    /// Height, px.
    pub height: f64,
    /// Size of the text, px.
    pub text: u32,
    pub(super) colours: Colours,
}

/// The colours of roles, as SVG has them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Colours {
    pub(super) ink: &'static str,
    pub(super) grid: &'static str,
    pub(super) paper: &'static str,
    pub(super) plan: &'static str,
    pub(super) other: &'static str,
    pub(super) views: &'static str,
    pub(super) bound: &'static str,
}

impl Style {
    /// For paper: `width` by `height` mm with text of `text` pt.
    pub fn paper(width: f64, height: f64, text: f64) -> Self {
        let px = |mm: f64| mm / 25.4 * PX_PER_INCH;
        Self::print(px(width), px(height), (text / 72.0 * PX_PER_INCH).round().max(1.0) as u32)
    }

    /// In px, on white, in colours that the colour-blind tell apart (Okabe and Ito).
    fn print(width: f64, height: f64, text: u32) -> Self {
        let colours = Colours {
            ink: "#1a1a1a",
            grid: "#d9d9d9",
            paper: "#ffffff",
            plan: "#0072b2",
            other: "#d55e00",
            views: "#9a9a9a",
            bound: "#1a1a1a",
        };
        Self { width, height, text, colours }
    }

    /// For a page, which has the colours as properties of its style sheet, light and dark.
    pub fn page(width: f64, height: f64) -> Self {
        let colours = Colours {
            ink: "var(--ink)",
            grid: "var(--line)",
            paper: "none",
            plan: "var(--series-1)",
            other: "var(--series-2)",
            views: "var(--muted)",
            bound: "var(--ink)",
        };
        Self { width, height, text: 12, colours }
    }

    pub(super) fn hue(&self, hue: Hue) -> &'static str {
        match hue {
            Hue::Plan => self.colours.plan,
            Hue::Other => self.colours.other,
            Hue::Views => self.colours.views,
            Hue::Bound => self.colours.bound,
        }
    }

    pub(super) fn theme(&self) -> Theme {
        let Colours { ink, grid, paper, .. } = self.colours;
        Theme {
            background: paper.into(),
            axis_color: ink.into(),
            grid_color: grid.into(),
            tick_color: ink.into(),
            text_color: ink.into(),
            legend_bg: paper.into(),
            legend_border: "none".into(),
            colorbar_border: grid.into(),
            ..Theme::light()
        }
    }
}
