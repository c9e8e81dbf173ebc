//! What is said of a calibration: text and document.

use nalgebra::{DMatrix, Vector2};
use serde_json::{Value, json};

use super::fit::OtherLens;
use super::judgement::{Judgement, Wished, goal, lacks};
use super::{LossName, Wish};
use crate::calibration::{Calibration, residuals};
use crate::cli::output::{fixed, short, table};
use crate::formats::Detections;
use crate::plan::document::Pose;

/// Outliers and images without corners listed in the text; the document has all.
const LISTED: usize = 10;

/// Views listed in the text.
const LISTED_VIEWS: usize = 100;

/// What there is to say of a calibration.
pub(super) struct Report<'a> {
    detections: &'a Detections,
    calibration: &'a Calibration,
    map: MapErrors,
    residuals: ResidualStatistics,
    wished: Vec<Wished>,
    judgement: Judgement,
    verdict: String,
}

/// Predicted map errors, px; none where the lens does not reach.
struct MapErrors {
    centre: Option<f64>,
    edge: Option<f64>,
    corner: Option<f64>,
    rms: f64,
}

/// Lengths of the residuals and their mean, px.
struct ResidualStatistics {
    median: f64,
    percentile_95: f64,
    largest: f64,
    mean: Vector2<f64>,
}

impl MapErrors {
    fn new(calibration: &Calibration, W: &DMatrix<f64>) -> Self {
        let Calibration { camera, covariance, .. } = calibration;
        let (right, bottom) = (f64::from(camera.width()) - 1.0, f64::from(camera.height()) - 1.0);
        let (x, y) = (right / 2.0, bottom / 2.0);
        // The root mean square over the places of one kind, those that the lens reaches.
        let at = |places: &[(f64, f64)]| {
            let pixels: Vec<_> = places.iter().map(|&(u, v)| Vector2::new(u, v)).collect();
            let errors = calibration.unknowns().map_error_at(covariance, &pixels);
            let squares: Vec<f64> = errors.into_iter().flatten().map(|error| error * error).collect();
            (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
        };
        Self {
            centre: at(&[(x, y)]),
            edge: at(&[(0.0, y), (right, y), (x, 0.0), (x, bottom)]),
            corner: at(&[(0.0, 0.0), (right, 0.0), (0.0, bottom), (right, bottom)]),
            rms: (W * covariance).trace().sqrt(),
        }
    }
}

impl ResidualStatistics {
    fn new(residuals: &[Vector2<f64>]) -> Self {
        let mut lengths: Vec<f64> = residuals.iter().map(Vector2::norm).collect();
        lengths.sort_unstable_by(f64::total_cmp);
        let quantile = |share: f64| {
            let place = share * lengths.len().saturating_sub(1) as f64;
            lengths.get(place.round() as usize).copied().unwrap_or(f64::NAN)
        };
        Self {
            median: quantile(0.5),
            percentile_95: quantile(0.95),
            largest: quantile(1.0),
            mean: residuals.iter().sum::<Vector2<f64>>() / residuals.len() as f64,
        }
    }
}

impl<'a> Report<'a> {
    pub(super) fn new(
        detections: &'a Detections,
        calibration: &'a Calibration,
        other: Option<OtherLens>,
        wishes: &[Wish],
        loss: LossName,
    ) -> Self {
        let observations = &detections.observations;
        let Calibration { camera, estimated, covariance, .. } = calibration;
        let all = residuals(observations, camera, &calibration.poses).concat();
        let W = calibration.unknowns().map_error_weight();
        let map = MapErrors::new(calibration, &W);
        let wished: Vec<Wished> = wishes
            .iter()
            .map(|wish| match *wish {
                Wish::MapError(limit) => Wished { what: "map error [px]".into(), limit, reached: map.rms },
                Wish::Sigma { intrinsic, sigma } => {
                    let i = estimated.iter().position(|&j| j == intrinsic);
                    let reached = i.map_or(0.0, |i| covariance[(i, i)].sqrt());
                    let name = camera.lens().parameter_names().get(intrinsic).copied().unwrap_or_default();
                    Wished { what: format!("sigma of {name}"), limit: sigma, reached }
                }
            })
            .collect();
        let judgement = Judgement::new(calibration, observations.corner_count(), other, map.rms, &wished);
        let lacks = lacks(observations, calibration, &W, map.rms, goal(&wished));
        let verdict = judgement.text(calibration, map.rms, loss, &lacks);
        Self { detections, calibration, map, residuals: ResidualStatistics::new(&all), wished, judgement, verdict }
    }

    /// Whether the camera should not be used as it is.
    pub(super) fn is_bad(&self) -> bool {
        self.judgement.is_bad()
    }

    /// Standard deviation of each intrinsic; 0 for those that were not estimated.
    fn sigma(&self, intrinsic: usize) -> f64 {
        let Calibration { estimated, covariance, .. } = self.calibration;
        estimated.iter().position(|&j| j == intrinsic).map_or(0.0, |i| covariance[(i, i)].sqrt())
    }

    /// Column and row of a corner of the board.
    fn place(&self, index: usize) -> (usize, usize) {
        let columns = self.detections.observations.board().columns;
        (index % columns, index / columns)
    }

    pub(super) fn text(&self) -> String {
        let Self { detections: Detections { observations, names, skipped }, calibration, map, residuals, .. } = self;
        let Calibration { camera, rms, sigma, view_rms, outliers, .. } = calibration;
        let intrinsics = camera.lens().parameter_names().iter().zip(camera.intrinsics()).enumerate();
        let all = camera.lens().parameter_names();
        let deviation = |i| match calibration.ties.leader(i) {
            _ if !calibration.estimated.contains(&i) => "fixed".into(),
            leader if leader != i => format!("{} = {}", short(self.sigma(i)), all[leader]),
            _ => short(self.sigma(i)),
        };
        let intrinsics: Vec<Vec<String>> =
            intrinsics.map(|(i, (name, value))| vec![(*name).into(), format!("{value:.6}"), deviation(i)]).collect();
        let views = names.iter().zip(view_rms).zip(observations.views()).take(LISTED_VIEWS);
        let mut views: Vec<Vec<String>> =
            views.map(|((name, rms), view)| vec![name.clone(), view.len().to_string(), short(*rms)]).collect();
        if names.len() > LISTED_VIEWS {
            views.push(vec![format!("and {} more", names.len() - LISTED_VIEWS), "-".into(), "-".into()]);
        }
        let optional = |error: Option<f64>| error.map_or("-".into(), short);
        let mut text = format!(
            "{} views, {} corners; lens {}, {} x {} px.",
            names.len(),
            observations.corner_count(),
            camera.lens().name(),
            camera.width(),
            camera.height(),
        );
        if !skipped.is_empty() {
            let more = if skipped.len() > LISTED { ", ..." } else { "" };
            let listed = skipped[..skipped.len().min(LISTED)].join(", ");
            text += &format!(" No corners in {} images, which are left out: {listed}{more}.", skipped.len());
        }
        text += &format!(
            "\n\n{}\n\n{}\n\nResiduals [px]: RMS {}, sigma of a coordinate {}; lengths: median {}, 95 % below {}, largest {}; mean \
             ({}, {}).\nPredicted map error [px]: centre {}, edge {}, corner {}; RMS over the image {}.\n",
            table(&["intrinsic", "value", "sigma"], &intrinsics),
            table(&["view", "corners", "RMS [px]"], &views),
            short(*rms),
            short(*sigma),
            short(residuals.median),
            short(residuals.percentile_95),
            short(residuals.largest),
            fixed(residuals.mean.x, 4),
            fixed(residuals.mean.y, 4),
            optional(map.centre),
            optional(map.edge),
            optional(map.corner),
            short(map.rms),
        );
        for outlier in outliers.iter().take(LISTED) {
            let (column, row) = self.place(outlier.index);
            text += &format!(
                "Outlier: {}, column {column}, row {row}: {} px, {:.0} sigma.\n",
                names[outlier.view],
                short(outlier.residual.norm()),
                outlier.standardised,
            );
        }
        if outliers.len() > LISTED {
            text += &format!("... and {} outliers more; --json lists them.\n", outliers.len() - LISTED);
        }
        text + &format!("\n{}", self.verdict)
    }

    pub(super) fn document(&self) -> Value {
        let Self { detections: Detections { observations, names, skipped }, calibration, map, residuals, .. } = self;
        let Calibration { camera, estimated, covariance, convergence, .. } = calibration;
        let all = camera.lens().parameter_names();
        let views = names.iter().enumerate().map(|(i, name)| {
            let Pose { position_m, quaternion_xyzw } = Pose::new(&calibration.poses[i]);
            json!({
                "name": name,
                "corners": observations.views()[i].len(),
                "rms_px": calibration.view_rms[i],
                "position_m": position_m,
                "quaternion_xyzw": quaternion_xyzw,
            })
        });
        let outliers = calibration.outliers.iter().map(|outlier| {
            let (column, row) = self.place(outlier.index);
            json!({
                "view": names[outlier.view],
                "column": column,
                "row": row,
                "residual_px": [outlier.residual.x, outlier.residual.y],
                "standardised": outlier.standardised,
            })
        });
        json!({
            "format": "calipose.calibration",
            "version": 1,
            "calipose": env!("CARGO_PKG_VERSION"),
            "lens": camera.lens().name(),
            "image": { "width_px": camera.width(), "height_px": camera.height() },
            "intrinsics": {
                "names": all,
                "values": camera.intrinsics(),
                "sigma": (0..all.len()).map(|i| self.sigma(i)).collect::<Vec<_>>(),
            },
            "estimated": estimated.iter().map(|&i| all[i]).collect::<Vec<_>>(),
            "tied": calibration.ties.followers().map(|(j, leader)| [all[leader], all[j]]).collect::<Vec<_>>(),
            "covariance": covariance.row_iter().map(|row| row.iter().copied().collect()).collect::<Vec<Vec<f64>>>(),
            "converged": convergence.converged,
            "rms_px": calibration.rms,
            "sigma_px": calibration.sigma,
            "residuals_px": {
                "median": residuals.median,
                "percentile_95": residuals.percentile_95,
                "largest": residuals.largest,
                "mean": [residuals.mean.x, residuals.mean.y],
            },
            "views": views.collect::<Vec<_>>(),
            "skipped": skipped,
            "outliers": outliers.collect::<Vec<_>>(),
            "map_error_px": { "centre": map.centre, "edge": map.edge, "corner": map.corner, "rms": map.rms },
            "wished": self.wished.iter().map(|w| json!({ "what": w.what, "wished": w.limit, "reached": w.reached })).collect::<Vec<_>>(),
            "judgement": self.judgement.name(),
            "verdict": self.verdict,
        })
    }
}
