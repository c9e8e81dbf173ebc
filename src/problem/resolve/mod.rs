//! From the problem file's schema to the models: every check, and every conversion of units.

mod camera;
mod check;
mod constraints;
mod estimate;
mod motion;
mod noise;
mod robot;
mod robust;
mod selection;
mod sweep;
mod target;
mod visibility;

use std::path::{Path, PathBuf};

use super::fault::{Allowed, Fault, Reason};
use super::text::{At, Document, key};
use super::{Problem, schema};
use crate::camera::{Camera, Lens};
pub(crate) use check::Check;

/// The problem that `file` states, or everything found wrong with it. `path` names a problem that has no name, and is where
/// other files are sought from.
pub(super) fn resolve(document: &Document, file: &schema::File, path: &Path) -> Result<Problem, Vec<Fault>> {
    let mut check = Check { document, faults: Vec::new(), notes: Vec::new() };
    let file = &At::root(file);
    let stem = path.file_stem().map(std::ffi::OsStr::to_string_lossy).unwrap_or_default();
    let name = check.name(&key!(file, name), &stem);
    let output = check.output(key!(file, output.folder), "plans", &name);
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut robot = check.robot(file, folder);
    check.scene(&key!(file, scene), robot.as_mut());
    let camera = check.camera(&key!(file, camera), folder);
    let target = check.target(&key!(file, target), folder);
    if let (Some(robot), Some(target)) = (&mut robot, &target) {
        Check::board(target, robot.board_link, &mut robot.tree);
    }
    let clearance = check.collision(&key!(file, collision), robot.as_mut().map(|robot| &mut robot.tree));
    let stability = key!(file, stability).given();
    let stability = stability.and_then(|test| check.stability(&test, robot.as_ref().map(|robot| &robot.tree)));
    let noise = check.noise(&key!(file, noise), camera.as_ref());
    let board = target.as_ref().map(|target| &target.board);
    let visibility = check.visibility(&key!(file, visibility), board, noise.model);
    // Without its camera file the names of the lens's intrinsics are not known.
    let lens = camera.as_ref().map(Camera::lens).or_else(|| file.value.camera.stated_lens());
    let estimate = key!(file, estimate);
    let estimated = lens.map(|lens| check.estimated(&estimate, lens)).unwrap_or_default();
    let names: Vec<&str> =
        lens.map(|lens| estimated.iter().map(|&i| lens.parameter_names()[i]).collect()).unwrap_or_default();
    let prior_sigma = check.prior_sigma(&estimate, camera.as_ref(), &estimated, &names, noise.sigma);
    let lens_names = lens.map(Lens::parameter_names).unwrap_or_default();
    let robust = key!(file, robust).given();
    let mut selection = check.selection(&key!(file, selection), &names);
    let robust = robust.map(|robust| check.robust(&robust, lens_names, &selection.goal));
    // Whether a pose is a view in enough set-ups takes too long to ask at every step of a search.
    selection.off_grid &= robust.is_none();
    // The size of the sweep means something only once the limits do.
    let sweep = key!(file, sweep);
    let space = robot.as_ref().and_then(|robot| check.space(&sweep, robot));
    if let (Some(robot), Some(space)) = (&mut robot, &space) {
        check.settable(&key!(file, robot), robot, space, selection.leaves_grid());
    }
    let told = robot.iter().flat_map(|robot| &robot.chain.joints).map(|joint| joint.resolution).collect();
    let space = space.map(|space| space.told(told));
    let published = check.published(&sweep);
    let joints = robot.as_ref().map(|robot| robot.chain.joints.as_slice()).unwrap_or_default();
    let constraints = check.constraints(&key!(file, constraints), joints);
    check.unconstrained_method(selection.goal.method(), &key!(file, constraints), &constraints);
    let motion = check.motion(&key!(file, motion), joints);
    let refinement = check.refinement(&sweep, joints);
    if let (Some(space), Some(count)) = (&space, selection.goal.count()) {
        let path = key!(file, selection.count).path;
        check.within(&path, count as f64, Allowed::between(1.0, space.len() as f64));
    }
    match (robot, camera, target, space) {
        (Some(robot), Some(camera), Some(target), Some(space)) if check.faults.is_empty() => Ok(Problem {
            name,
            sha256: document.sha256(),
            overrides: document.overrides.clone(),
            robot,
            camera,
            target,
            space,
            refinement,
            published,
            axis: file.value.sweep.axis.0,
            visibility,
            clearance,
            stability,
            noise,
            estimated,
            prior_sigma,
            robust,
            selection,
            constraints,
            motion,
            output,
            notes: check.notes,
        }),
        _ => Err(check.faults),
    }
}

impl Check<'_, '_> {
    /// The name that a file gives itself, or else its own without the extension.
    pub(crate) fn name(&mut self, name: &At<Option<String>>, stem: &str) -> String {
        let given = name.value.as_deref().unwrap_or(stem).trim();
        if given.is_empty() {
            self.fault(&name.path, Reason::Empty);
        }
        given.to_owned()
    }

    /// The folder that a file gives for its results, or else one of its name in `folders`.
    pub(crate) fn output(&mut self, folder: At<Option<String>>, folders: &str, name: &str) -> PathBuf {
        let Some(folder) = folder.given() else {
            return PathBuf::from(folders).join(slug(name));
        };
        if folder.value.trim().is_empty() {
            self.fault(&folder.path, Reason::Empty);
        }
        PathBuf::from(folder.value)
    }
}

/// `name` as a folder: lower-case letters and digits, everything else a hyphen.
pub(crate) fn slug(name: &str) -> String {
    let words = name.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty());
    let slug = words.map(str::to_lowercase).collect::<Vec<_>>().join("-");
    if slug.is_empty() { "plan".into() } else { slug }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slugs_are_safe_folder_names() {
        assert_eq!(slug("Servosila Engineer, 4-DoF"), "servosila-engineer-4-dof");
        assert_eq!(slug("../../etc"), "etc");
        assert_eq!(slug("°!"), "plan");
    }
}
