//! A study: means over each axis, and levels compared.

use crate::figures::short;
use crate::plan::document::{AxisMeans, ComparedLevels, Difference, Mean, OutcomeSummary, StudyDocument};
use crate::report::figure::{Content, Figure, Hue, Interval, Line, Mark, Series};

/// The strokes that tell series apart.
const STROKES: [(Hue, Line); 7] = [
    (Hue::Plan, Line::Solid),
    (Hue::Other, Line::Solid),
    (Hue::Bound, Line::Solid),
    (Hue::Views, Line::Solid),
    (Hue::Plan, Line::Dashed),
    (Hue::Other, Line::Dashed),
    (Hue::Bound, Line::Dashed),
];

/// Rows of a plot of levels; more cannot be read.
const MOST_ROWS: usize = 40;

/// Rows of a plot of intervals.
const MOST_INTERVALS: usize = 16;

/// Numbers that differ by more than this factor are drawn by their logarithms.
const WIDE: f64 = 8.0;

/// The figures of all outcomes.
pub(super) fn figures(study: &StudyDocument) -> Vec<Figure> {
    study.outcomes.iter().flat_map(of_outcome).collect()
}

fn of_outcome(summary: &OutcomeSummary) -> Vec<Figure> {
    let means = summary.means.iter().flat_map(|means| means_of(&summary.outcome, means));
    let ratios = summary.compared.iter().flat_map(|compared| ratios(&summary.outcome, compared));
    means.chain(ratios).collect()
}

/// An outcome as an axis of a plot names it.
fn label(outcome: &str) -> String {
    match outcome.strip_suffix("_px") {
        Some(name) => format!("{} [px]", name.replace('_', " ")),
        None => outcome.replace('_', " "),
    }
}

/// As the name of a file.
fn plain(name: &str) -> String {
    name.replace(|c: char| !c.is_ascii_alphanumeric(), "-")
}

fn series_names(means: &[Mean]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for mean in means {
        if !names.contains(&mean.series.as_str()) {
            names.push(&mean.series);
        }
    }
    names
}

/// The means over an axis: as lines where its levels are numbers, as rows where they are names. More series than there are strokes
/// are spread over several figures.
fn means_of(outcome: &str, AxisMeans { axis, means }: &AxisMeans) -> Vec<Figure> {
    let names = series_names(means);
    let parts = names.chunks(STROKES.len()).enumerate();
    parts
        .map(|(part, names)| {
            let of_part: Vec<&Mean> = means.iter().filter(|mean| names.contains(&mean.series.as_str())).collect();
            let is_numeric = of_part.iter().all(|mean| mean.number.is_some());
            let content = if is_numeric { lines(names, &of_part) } else { rows(names, &of_part) };
            let (x, y) = if is_numeric { (axis.clone(), label(outcome)) } else { (label(outcome), axis.clone()) };
            Figure {
                name: format!("{}-by-{}{}", plain(outcome), plain(axis), numbered(part)).into(),
                title: format!("{} by {axis}", label(outcome)),
                caption: if is_numeric {
                    "Means over all rows with the level, and their 95 % confidence intervals where there are several."
                } else {
                    "Means over all rows with the level."
                }
                .into(),
                x,
                y,
                content,
            }
        })
        .collect()
}

fn lines(names: &[&str], means: &[&Mean]) -> Content {
    let mut series = Vec::new();
    for (&name, (hue, line)) in names.iter().zip(STROKES) {
        let of_series = || means.iter().filter(|mean| mean.series == name);
        let mut points: Vec<(f64, f64)> = of_series().filter_map(|mean| Some((mean.number?, mean.mean?))).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        series.push(Series { name: name.into(), hue, mark: Mark::Line(line), points, titles: vec![] });
        // The ends of the intervals, as a line up or down.
        for mean in of_series() {
            if let (Some(number), Some([low, high])) = (mean.number, mean.interval)
                && low > 0.0
            {
                let points = vec![(number, low), (number, high)];
                series.push(Series { name: String::new(), hue, mark: Mark::Line(Line::Solid), points, titles: vec![] });
            }
        }
    }
    let values = || means.iter().filter_map(|mean| mean.mean);
    let least = values().fold(f64::INFINITY, f64::min);
    if least > 0.0 && values().fold(0.0, f64::max) > WIDE * least {
        Content::LogSeries(series)
    } else {
        Content::Series(series)
    }
}

fn rows(names: &[&str], means: &[&Mean]) -> Content {
    let mut levels: Vec<String> = Vec::new();
    for mean in means {
        if !levels.contains(&mean.level) && levels.len() < MOST_ROWS {
            levels.push(mean.level.clone());
        }
    }
    let series = names.iter().zip(STROKES).map(|(&name, (hue, line))| {
        let of_series = means.iter().filter(|mean| mean.series == name);
        let known = of_series.filter_map(|mean| {
            let row = levels.iter().position(|level| *level == mean.level)?;
            let interval =
                mean.interval.map_or(String::new(), |[low, high]| format!(" ({} to {})", short(low), short(high)));
            let title = format!("{}: {}{interval}", mean.level, short(mean.mean?));
            Some(((mean.mean?, (levels.len() - row) as f64), title))
        });
        let (points, titles) = known.unzip();
        let mark = if line == Line::Solid { Mark::Discs } else { Mark::Diamonds };
        Series { name: name.into(), hue, mark, points, titles }
    });
    let series = series.collect();
    Content::Rows { names: levels, series }
}

/// Levels against the first, as ratios, where levels are names: numbers are better seen along their axis.
fn ratios(outcome: &str, ComparedLevels { axis, against, differences }: &ComparedLevels) -> Vec<Figure> {
    let is_numeric = |difference: &Difference| difference.level.parse::<f64>().is_ok();
    if differences.iter().all(is_numeric) {
        return Vec::new();
    }
    let row = |difference: &Difference| {
        let ratio = difference.ratio?;
        let name = match difference.series.as_str() {
            "" => difference.level.clone(),
            series => format!("{}, {series}", difference.level),
        };
        let [low, high] = difference.ratio_interval.unwrap_or([ratio, ratio]);
        Some(Interval { name, value: ratio, range: (low, high) })
    };
    let rows: Vec<Interval> = differences.iter().filter_map(row).collect();
    let parts = rows.chunks(MOST_INTERVALS).enumerate();
    parts
        .map(|(part, rows)| Figure {
            name: format!("{}-ratio-by-{}{}", plain(outcome), plain(axis), numbered(part)).into(),
            title: format!("{} against {axis} {against}", label(outcome)),
            caption: format!(
                "Ratio of the outcome to that at {axis} {against}, all else being equal: geometric means and their 95 % confidence \
                 intervals."
            ),
            x: format!("ratio of {}", label(outcome)),
            y: axis.clone(),
            content: Content::Intervals { rows: rows.to_vec(), expected: 1.0 },
        })
        .collect()
}

/// What is added to the name of a figure that is not the first of its kind.
fn numbered(part: usize) -> String {
    if part == 0 { String::new() } else { format!("-{}", part + 1) }
}
