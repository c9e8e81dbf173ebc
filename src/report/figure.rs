//! A plot, before it is drawn: what stands where, in which role.

use std::borrow::Cow;

/// A plot.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Name of its file, and its anchor on a page.
    pub name: Cow<'static, str>,
    /// Title.
    pub title: String,
    /// What to see in it, in a sentence or two.
    pub caption: String,
    /// Label of the horizontal axis.
    pub x: String,
    /// Label of the vertical axis.
    pub y: String,
    /// What is in it.
    pub content: Content,
}

/// What is in a plot.
#[derive(Debug, Clone, PartialEq)]
pub enum Content {
    /// Points and lines on axes, the vertical one by the logarithm.
    LogSeries(Vec<Series>),
    /// Points and lines on axes.
    Series(Vec<Series>),
    /// A drawing true to scale, of points and lines.
    Drawing(Vec<Series>),
    /// Points in rows, whose names stand where the vertical axis would be; the last row is at 1, the others above.
    Rows {
        /// The names, from the top.
        names: Vec<String>,
        /// The points.
        series: Vec<Series>,
    },
    /// The picture as a map: rows of numbers from its top to its bottom, coloured from 0 to `most`.
    Map {
        /// The numbers; none where there is nothing.
        rows: Vec<Vec<Option<f64>>>,
        /// Width and height of the picture, px.
        size: [f64; 2],
        /// The number of the last colour.
        most: f64,
        /// Unit of the numbers.
        unit: &'static str,
    },
    /// Numbers over a plane: rows from the lowest to the highest, coloured from the least to the greatest.
    Field {
        /// The numbers; none where there is nothing.
        rows: Vec<Vec<Option<f64>>>,
        /// Ends of the horizontal axis.
        x: [f64; 2],
        /// Ends of the vertical axis.
        y: [f64; 2],
        /// Unit of the numbers.
        unit: &'static str,
    },
    /// A symmetric matrix of numbers from −1 to 1.
    Matrix {
        /// Names of rows and columns.
        names: Vec<String>,
        /// The numbers, row by row.
        rows: Vec<Vec<f64>>,
    },
    /// Arrows on a picture, drawn longer than they are.
    Arrows {
        /// Tails and the vectors, px.
        arrows: Vec<([f64; 2], [f64; 2])>,
        /// Width and height of the picture, px.
        size: [f64; 2],
        /// Length drawn of a vector of 1 px, px.
        scale: f64,
    },
    /// Strips one above the other, of what changes with time.
    Strips {
        /// The strips, from the top.
        strips: Vec<Strip>,
        /// What takes its time, in a lane above the strips and behind them all.
        bands: Vec<Band>,
        /// Where the time ends, which begins at 0; s.
        end: f64,
    },
    /// How many of what becomes what.
    Flow(Vec<(String, String, f64)>),
    /// Numbers with their intervals, one a row, and what they should be.
    Intervals {
        /// The rows.
        rows: Vec<Interval>,
        /// What they should be.
        expected: f64,
    },
}

/// Lines and points over time, with a vertical axis of their own.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// What it is of, with its unit.
    pub name: String,
    /// Ends of the vertical axis.
    pub range: (f64, f64),
    /// How high it is, against the others.
    pub height: f64,
    /// What is in it.
    pub series: Vec<Series>,
}

/// What takes its time.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// When it begins and ends, s.
    pub time: (f64, f64),
    /// What it is.
    pub kind: BandKind,
    /// What stands above it, where there is room.
    pub label: String,
    /// What it is, in words.
    pub title: String,
}

/// What takes its time on a tour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BandKind {
    /// Pictures at a pose.
    Pictures,
    /// A move that goes round about.
    RoundAbout,
    /// A move that is not proven safe.
    NotSafe,
}

/// Points that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// Colour.
    pub hue: Hue,
    /// How they are drawn.
    pub mark: Mark,
    /// The points.
    pub points: Vec<(f64, f64)>,
    /// What each point is; as many as points, or none.
    pub titles: Vec<String>,
}

/// How points are drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mark {
    /// As small dots.
    Dots,
    /// As discs.
    Discs,
    /// As diamonds.
    Diamonds,
    /// As a line.
    Line(Line),
}

/// The stroke of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Line {
    /// Unbroken.
    Solid,
    /// Broken.
    Dashed,
}

/// The role of a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hue {
    /// Of the plan.
    Plan,
    /// Of another choice.
    Other,
    /// Of what there is to choose from.
    Views,
    /// Of a bound.
    Bound,
}

/// A number and its interval.
#[derive(Debug, Clone, PartialEq)]
pub struct Interval {
    /// Name.
    pub name: String,
    /// The number.
    pub value: f64,
    /// Its least and greatest likely value.
    pub range: (f64, f64),
}
