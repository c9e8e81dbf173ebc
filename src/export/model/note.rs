//! What a model says of itself, in comments.

use super::assembly::Assembly;
use super::assets::Assets;
use super::setup::Setup;
use crate::export::text::one_line;

const INERTIA: &str = "Masses and their centres are the problem's. It states no inertias: here they are those of balls of water around the centres.";

/// What every model says, then what the format adds.
pub(super) fn beginning(setup: &Setup, assembly: &Assembly, assets: Option<&Assets>, notes: &[&str]) -> Vec<String> {
    let [camera, board] = [assembly.camera, assembly.board].map(|link| &assembly.links[link].name);
    let mut sentences = vec![
        format!("Made by calipose {} from the plan \"{}\".", env!("CARGO_PKG_VERSION"), one_line(setup.program.name)),
        format!(
            "Link {camera} is the camera's optical frame, z forward, x right, y down. Link {board} is the board's, z out of its printed side."
        ),
    ];
    sentences.extend(assembly.links.iter().any(|link| link.mass.is_some()).then(|| INERTIA.to_owned()));
    sentences.extend(assets.and_then(Assets::note));
    sentences.extend(notes.iter().map(|&note| note.to_owned()));
    sentences
}
