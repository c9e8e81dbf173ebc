//! Zhang's closed form (*A flexible new technique for camera calibration*, PAMI 2000, §3.1 and appendix B).

use nalgebra::{DMatrix, Matrix2, Matrix3, Rotation3, SymmetricEigen, UnitQuaternion, Vector2, Vector3, Vector6};

use crate::spatial::Pose;

/// The five numbers of a pinhole camera: `K = [fx s cx; 0 fy cy; 0 0 1]`, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    /// Focal length along the image's rows.
    pub fx: f64,
    /// Focal length along its columns.
    pub fy: f64,
    /// Principal point, column.
    pub cx: f64,
    /// Principal point, row.
    pub cy: f64,
    /// Skew of the pixel axes.
    pub skew: f64,
}

/// A row of the system `V b = 0`, with `b = (B₁₁, B₁₂, B₂₂, B₁₃, B₂₃, B₃₃)` of the image `B = K⁻ᵀK⁻¹` of the absolute
/// conic.
type Row = Vector6<f64>;

/// Eigenvalues of `VᵀV` below this share of the greatest are zero but for rounding.
const RANK_TOLERANCE: f64 = 1e-13;

impl Pinhole {
    /// All five numbers from at least three homographies board → pixel; `None` when the views do not fix them or
    /// noise made the conic's image indefinite.
    ///
    /// Pixels are brought to order one by `centre` and `scale`, both px.
    pub fn with_skew(homographies: &[Matrix3<f64>], centre: Vector2<f64>, scale: f64) -> Option<Self> {
        let b = null_vector(homographies, centre, scale, &[0, 1, 2, 3, 4, 5])?;
        Self::of_conic(&b)?.in_pixels(centre, scale)
    }

    /// The four numbers of a camera without skew, from at least two homographies.
    pub fn without_skew(homographies: &[Matrix3<f64>], centre: Vector2<f64>, scale: f64) -> Option<Self> {
        let b = null_vector(homographies, centre, scale, &[0, 2, 3, 4, 5])?;
        Self::of_conic(&b)?.in_pixels(centre, scale)
    }

    /// One focal length for both axes, the principal point known.
    pub fn with_principal_point(homographies: &[Matrix3<f64>], point: Vector2<f64>, scale: f64) -> Option<Self> {
        // Each row reads a·(1/f²) + c = 0 in coordinates about the principal point.
        let (mut aa, mut ac) = (0.0, 0.0);
        for H in homographies {
            for v in constraints(&normalised(H, point, scale)) {
                let (a, c) = (v[0] + v[2], v[5]);
                aa += a * a;
                ac += a * c;
            }
        }
        let f = (aa / -ac).sqrt();
        (ac < 0.0 && f.is_finite()).then(|| {
            let f = f * scale;
            Self { fx: f, fy: f, cx: point.x, cy: point.y, skew: 0.0 }
        })
    }

    /// Appendix B: the intrinsics from `b`, known up to a factor.
    fn of_conic(b: &Row) -> Option<Self> {
        let b = if b[0] < 0.0 { -b } else { *b };
        let (B11, B12, B22, B13, B23, B33) = (b[0], b[1], b[2], b[3], b[4], b[5]);
        let minor = B11 * B22 - B12 * B12;
        let cy = (B12 * B13 - B11 * B23) / minor;
        let λ = B33 - (B13 * B13 + cy * (B12 * B13 - B11 * B23)) / B11;
        if !(minor > 0.0 && λ > 0.0) {
            return None;
        }
        let fx = (λ / B11).sqrt();
        let fy = (λ * B11 / minor).sqrt();
        let skew = -B12 * fx * fx * fy / λ;
        let cx = skew * cy / fy - B13 * fx * fx / λ;
        Some(Self { fx, fy, cx, cy, skew })
    }

    fn in_pixels(self, centre: Vector2<f64>, scale: f64) -> Option<Self> {
        let Self { fx, fy, cx, cy, skew } = self;
        let pixels = Self {
            fx: fx * scale,
            fy: fy * scale,
            cx: cx * scale + centre.x,
            cy: cy * scale + centre.y,
            skew: skew * scale,
        };
        [fx, fy, cx, cy, skew].iter().all(|x| x.is_finite()).then_some(pixels)
    }

    /// `K⁻¹`.
    pub fn inverse_matrix(&self) -> Matrix3<f64> {
        let Self { fx, fy, cx, cy, skew } = *self;
        let s = -skew / (fx * fy);
        Matrix3::new(1.0 / fx, s, -cx / fx - s * cy, 0.0, 1.0 / fy, -cy / fy, 0.0, 0.0, 1.0)
    }
}

/// The pose `X_CT` whose homography board → normalised image is `H ~ [r₁ r₂ t]`: the rotation nearest to its first
/// two columns, the board's origin in front of the camera.
pub fn pose_of_homography(H: &Matrix3<f64>) -> Option<Pose> {
    // A positive depth of the board's origin fixes the sign.
    let H = if H[(2, 2)] < 0.0 { -H } else { *H };
    let A = H.fixed_columns::<2>(0);
    // Polar decomposition A = U S of a 3×2 matrix: S = (AᵀA)^½ in closed form by Cayley–Hamilton.
    let AtA = A.transpose() * A;
    let root_det = AtA.determinant().sqrt();
    let trace = (AtA.trace() + 2.0 * root_det).sqrt();
    let S = (AtA + Matrix2::identity() * root_det) / trace;
    let U = A * S.try_inverse()?;
    let (r_1, r_2): (Vector3<f64>, Vector3<f64>) = (U.column(0).into(), U.column(1).into());
    let R = Matrix3::from_columns(&[r_1, r_2, r_1.cross(&r_2)]);
    let t = H.column(2) * (2.0 / S.trace());
    if !(R.iter().all(|x| x.is_finite()) && t.iter().all(|x| x.is_finite())) {
        return None;
    }
    let rotation = Rotation3::from_matrix_unchecked(R);
    Some(Pose::from_parts(t.into(), UnitQuaternion::from_rotation_matrix(&rotation)))
}

/// `H` with its pixels brought to order one and its first two columns to unit length on average, so that the rows of
/// all views weigh alike.
fn normalised(H: &Matrix3<f64>, centre: Vector2<f64>, scale: f64) -> Matrix3<f64> {
    let s = 1.0 / scale;
    let N = Matrix3::new(s, 0.0, -s * centre.x, 0.0, s, -s * centre.y, 0.0, 0.0, 1.0);
    let H = N * H;
    H / H.fixed_columns::<2>(0).norm()
}

/// The rows `v₁₂` and `v₁₁ − v₂₂` (eqs. 7 and 8).
fn constraints(H: &Matrix3<f64>) -> [Row; 2] {
    let v = |i: usize, j: usize| {
        let (a, b) = (H.column(i), H.column(j));
        Row::from([
            a[0] * b[0],
            a[0] * b[1] + a[1] * b[0],
            a[1] * b[1],
            a[2] * b[0] + a[0] * b[2],
            a[2] * b[1] + a[1] * b[2],
            a[2] * b[2],
        ])
    };
    [v(0, 1), v(0, 0) - v(1, 1)]
}

/// The unit vector `b` that the rows map nearest to zero, its entries off `columns` zero; `None` where more than one
/// does.
fn null_vector(homographies: &[Matrix3<f64>], centre: Vector2<f64>, scale: f64, columns: &[usize]) -> Option<Row> {
    let n = columns.len();
    let mut VtV = DMatrix::zeros(n, n);
    for H in homographies {
        for v in constraints(&normalised(H, centre, scale)) {
            for (i, &a) in columns.iter().enumerate() {
                for (j, &b) in columns.iter().enumerate() {
                    VtV[(i, j)] += v[a] * v[b];
                }
            }
        }
    }
    let eigen = SymmetricEigen::new(VtV);
    let (least, _) = eigen.eigenvalues.argmin();
    let greatest = eigen.eigenvalues.max();
    let second = (0..n).filter(|&i| i != least).map(|i| eigen.eigenvalues[i]).fold(f64::INFINITY, f64::min);
    (second > RANK_TOLERANCE * greatest).then(|| {
        let mut b = Row::zeros();
        for (i, &column) in columns.iter().enumerate() {
            b[column] = eigen.eigenvectors[(i, least)];
        }
        b
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Zhang's simulation (§5.1): α 1250, β 900, γ 1.09083, u₀ = v₀ = 255, three planes at 50 cm.
    fn paper() -> (Matrix3<f64>, Vec<Pose>) {
        let K = Matrix3::new(1250.0, 1.090_83, 255.0, 0.0, 900.0, 255.0, 0.0, 0.0, 1.0);
        let turns = [
            Vector3::new(20.0, 0.0, 0.0),
            Vector3::new(0.0, 20.0, 0.0),
            Vector3::new(-30.0, -30.0, -15.0) / 5f64.sqrt(),
        ];
        let poses = turns
            .iter()
            .zip([0.5, 0.51, 0.525])
            .map(|(ω, z)| Pose::new(Vector3::new(-0.09, -0.125, z), ω.map(f64::to_radians)));
        (K, poses.collect())
    }

    fn homography(K: &Matrix3<f64>, X_CT: &Pose) -> Matrix3<f64> {
        let R = X_CT.rotation.to_rotation_matrix();
        K * Matrix3::from_columns(&[R.matrix().column(0).into(), R.matrix().column(1).into(), X_CT.translation.vector])
    }

    #[test]
    fn exact_homographies_give_back_the_five_numbers_of_the_paper() {
        let (K, poses) = paper();
        let H: Vec<_> = poses.iter().map(|X| homography(&K, X)).collect();
        let found = Pinhole::with_skew(&H, Vector2::new(256.0, 256.0), 512.0).unwrap();
        let truth = Pinhole { fx: 1250.0, fy: 900.0, cx: 255.0, cy: 255.0, skew: 1.090_83 };
        for (a, b) in [(found.fx, truth.fx), (found.fy, truth.fy), (found.cx, truth.cx), (found.cy, truth.cy)] {
            assert!((a - b).abs() < 1e-8 * b, "{found:?}");
        }
        assert!((found.skew - truth.skew).abs() < 1e-6);
        assert!((truth.inverse_matrix() * K - Matrix3::identity()).norm() < 1e-12);
        for (H, X_CT) in H.iter().zip(&poses) {
            let found = pose_of_homography(&(truth.inverse_matrix() * H * -3.0)).unwrap();
            assert!((found.translation.vector - X_CT.translation.vector).norm() < 1e-12);
            assert!(found.rotation.angle_to(&X_CT.rotation) < 1e-7);
        }
    }

    #[test]
    fn two_views_fix_a_camera_without_skew_and_one_fixes_a_focal_length() {
        let (mut K, poses) = paper();
        K[(0, 1)] = 0.0;
        let H: Vec<_> = poses[..2].iter().map(|X| homography(&K, X)).collect();
        let found = Pinhole::without_skew(&H, Vector2::new(200.0, 300.0), 512.0).unwrap();
        assert!((found.fx - 1250.0).abs() < 1e-7 && (found.fy - 900.0).abs() < 1e-7 && (found.cx - 255.0).abs() < 1e-7);
        K[(1, 1)] = 1250.0;
        let H = [homography(&K, &poses[2])];
        let found = Pinhole::with_principal_point(&H, Vector2::new(255.0, 255.0), 512.0).unwrap();
        assert!((found.fx - 1250.0).abs() < 1e-7);
    }

    #[test]
    fn parallel_boards_and_a_single_view_fix_no_camera() {
        let (K, poses) = paper();
        let H: Vec<_> = [(0.0, 0.5), (0.1, 0.7), (-0.1, 0.6), (0.05, 0.4)]
            .map(|(x, z)| homography(&K, &Pose::from_parts(Vector3::new(x, 0.02, z).into(), poses[2].rotation)))
            .to_vec();
        assert_eq!(Pinhole::with_skew(&H, Vector2::new(256.0, 256.0), 512.0), None);
        assert_eq!(Pinhole::without_skew(&H, Vector2::new(256.0, 256.0), 512.0), None);
        assert_eq!(Pinhole::without_skew(&H[..1], Vector2::new(256.0, 256.0), 512.0), None);
    }
}
