//! How much of the picture the lens reaches.

use crate::camera::Camera;
use crate::plan::document::LensDocument;

/// From this share on the whole picture is meant: the share is counted on a grid.
const WHOLE: f64 = 0.995;

pub(super) fn lens_text(camera: &Camera, lens: &LensDocument) -> String {
    let size = format!("Lens: {}, {} x {} px", lens.model, camera.width(), camera.height());
    let share = lens.picture_reached;
    if share >= WHOLE {
        return format!("{size}, and reaches the whole picture.");
    }
    let fold = lens.folds_back_at_deg.map(|angle| format!(", up to {angle:.1}° off the optical axis"));
    format!(
        "{size}, and reaches {:.0} % of the picture{}; views have no corners beyond.",
        100.0 * share,
        fold.unwrap_or_default()
    )
}
