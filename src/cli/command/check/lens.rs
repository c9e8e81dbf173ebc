//! How much of the picture the lens reaches.

use serde_json::{Value, json};

use crate::camera::Camera;

/// From this share on the whole picture is meant: the share is counted on a grid.
const WHOLE: f64 = 0.995;

pub(super) fn lens(camera: &Camera) -> Value {
    json!({
        "model": camera.lens().name(),
        "picture_reached": camera.coverage(),
        "folds_back_at_deg": camera.fold().map(f64::to_degrees),
    })
}

pub(super) fn lens_text(camera: &Camera) -> String {
    let size = format!("Lens: {}, {} x {} px", camera.lens().name(), camera.width(), camera.height());
    let share = camera.coverage();
    if share >= WHOLE {
        return format!("{size}, and reaches the whole picture.");
    }
    let fold = camera.fold().map(|angle| format!(", up to {:.1}° off the optical axis", angle.to_degrees()));
    format!(
        "{size}, and reaches {:.0} % of the picture{}; beyond, nothing is seen, and no view has corners there.",
        100.0 * share,
        fold.unwrap_or_default()
    )
}
