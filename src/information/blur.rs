//! What defocus and motion take of what edges tell.
//!
//! A sharp edge has the width s₀ in the picture, the standard deviation of its slope. The disc of a point out of focus, c
//! across, and a path of the length L in an unknown direction widen it:
//!
//! ```text
//!     s² = s₀² + (c/4)² + L²/24        c = f D |1/z − 1/z_f|        L² = f² τ² (ω² + (v/z)²)
//! ```
//!
//! An edge's gradient knows of its place `∫ g² ∝ 1/s`. Where two edges meet, their gradients vanish over lengths of some s
//! along both, and `cornerSubPix` follows its own window there, which multiplies its error. Both grow with `u = s/r`, where
//! r is half the window's side times the sine of the edges' angle: what T keeps is
//!
//! ```text
//!     s₀/s · exp(−a (u − u₀) − b (u² − u₀²))
//! ```

use crate::camera::Camera;

/// Defocus and motion, which widen the edges in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Blur {
    /// The camera's focal length f in px.
    pub focal_length: f64,
    /// Diameter D of the aperture in m.
    pub aperture: f64,
    /// Vergence in focus, `1/z_f`, in 1/m.
    pub focus: f64,
    /// Angle `τ ω` by which the camera turns during the exposure, in rad.
    pub turning: f64,
    /// Length `τ v` of its way during the exposure, in m.
    pub moving: f64,
}

/// Width of a sharp edge in px, s₀: a lens's blur of 0.6 px and the pixels' own area, 1/√12 px.
const SHARP: f64 = 2.0 / 3.0;

/// What a corner of blurred edges loses, a and b.
const CORNER: [f64; 2] = [3.0, 8.0];

impl Blur {
    /// Of a camera in focus and at rest.
    pub const NONE: Self = Self { focal_length: 1.0, aperture: 0.0, focus: 0.0, turning: 0.0, moving: 0.0 };

    /// The same lens and motion through a camera.
    #[must_use]
    pub fn through(self, camera: &Camera) -> Self {
        Self { focal_length: (camera.intrinsics()[0] * camera.intrinsics()[1]).sqrt(), ..self }
    }

    /// Of the same camera at rest.
    #[must_use]
    pub fn at_rest(self) -> Self {
        Self { turning: 0.0, moving: 0.0, ..self }
    }

    /// Whether no edge is wider than a sharp one, wherever it is seen.
    #[inline]
    pub(crate) fn is_sharp(&self) -> bool {
        self.aperture == 0.0 && self.turning == 0.0 && self.moving == 0.0
    }

    /// Share that is left of what an edge tells at a `vergence`, in 1/m.
    pub(crate) fn edge(&self, vergence: f64) -> f64 {
        SHARP / self.width(vergence)
    }

    /// The same of what a corner's two edges tell, where `reach` is r, in px.
    pub(crate) fn corner(&self, vergence: f64, reach: f64) -> f64 {
        let [a, b] = CORNER;
        let s = self.width(vergence);
        let lost = (s - SHARP) / reach * (a + b * (s + SHARP) / reach);
        SHARP / s * (-lost).exp()
    }

    /// Width of an edge in px, s; exactly s₀ without blur.
    fn width(&self, vergence: f64) -> f64 {
        let disc = self.aperture * (vergence - self.focus);
        let path = [self.turning, self.moving * vergence];
        let variance = disc * disc / 16.0 + path.map(|length| length * length).iter().sum::<f64>() / 24.0;
        SHARP.hypot(self.focal_length * variance.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// f = 1000 px, an aperture of 2 mm, and what is 0.5 m away in focus.
    const LENS: Blur = Blur { focal_length: 1000.0, aperture: 0.002, focus: 2.0, ..Blur::NONE };

    #[test]
    fn a_disc_widens_edges_by_a_quarter_of_its_diameter() {
        // At 0.25 m it is 4 px across: s² = 4/9 + 1.
        assert!((LENS.edge(4.0) - 2.0 / 13f64.sqrt()).abs() < 1e-15);
        // s = 1.201850, and of u = s/5: exp(−0.107037 (3 + 8 · 0.373703)).
        assert!((LENS.corner(4.0, 5.0) - 0.292_165).abs() < 1e-6, "{}", LENS.corner(4.0, 5.0));
        // As far from focus in 1/m, at infinity.
        assert!((LENS.edge(0.0) - LENS.edge(4.0)).abs() < 1e-15);
    }

    #[test]
    fn a_path_widens_edges_by_its_length_over_the_root_of_24() {
        let blur = Blur { focal_length: 1000.0, turning: 0.002, moving: 0.0005, ..Blur::NONE };
        // Of 2 px by turning, and of 1 px by moving past what is 0.5 m away.
        assert!((blur.edge(2.0) - SHARP / (SHARP * SHARP + 5.0 / 24.0).sqrt()).abs() < 1e-15);
        assert_eq!(blur.at_rest(), Blur { focal_length: 1000.0, ..Blur::NONE });
    }

    #[test]
    fn what_is_in_focus_and_at_rest_loses_nothing() {
        for (blur, vergence) in [(LENS, 2.0), (Blur::NONE, 7.0), (Blur::NONE, 0.0)] {
            assert_eq!([blur.edge(vergence), blur.corner(vergence, 1e-6)], [1.0, 1.0]);
        }
        let moving = Blur { moving: 0.001, ..Blur::NONE };
        let turning = Blur { turning: 0.001, ..Blur::NONE };
        let sharp = [Blur::NONE, Blur { focal_length: 900.0, focus: 2.0, ..Blur::NONE }, LENS, moving, turning];
        assert_eq!(sharp.map(|blur| blur.is_sharp()), [true, true, false, false, false]);
    }
}
