"""Pictures of checkerboards drawn by NumPy, blurred ones, and the sensor's noise."""

from functools import cached_property

from map_error import corners

# Grey values.
BLACK, WHITE, AROUND = 40.0, 200.0, 110.0
# The light changes by this share from left to right.
GRADIENT = 0.1
BLUR_PX = 0.6
SUBPIXELS = 8
# The white around the squares, in squares.
QUIET = 1
# Of OpenCV's search for the ray through a pixel.
ITERATIONS = 60


class Views:
    """One board from several sides: the poses of a plan, or any. Only checkerboards are drawn."""

    def __init__(self, camera, target, poses):
        self.camera, self.target, self.poses = camera, target, poses
        self.board = corners(target)

    @cached_property
    def rays(self):
        """Through the pixels' centres, and how they change to the next along u and v: between pixels they are as good as linear."""
        width, height = self.camera.size
        u, v = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
        rays = self.camera.rays(np.column_stack([u.ravel(), v.ravel()]), ITERATIONS)[:, :2].reshape(height, width, 2)
        return rays, np.gradient(rays, axis=1), np.gradient(rays, axis=0)

    def project(self, pose, points=None):
        R, t = pose
        return self.camera.project(self.board if points is None else points, cv2.Rodrigues(R)[0], t.reshape(3, 1))

    def is_black(self, x, y):
        columns, rows, square = self.target["columns"], self.target["rows"], self.target["square_mm"] / 1e3
        i, j = np.floor(x / square + (columns + 1) / 2), np.floor(y / square + (rows + 1) / 2)
        return (i >= 0) & (i <= columns) & (j >= 0) & (j <= rows) & ((i + j) % 2 == 0)

    def picture(self, pose):
        """Grey values without the sensor's noise."""
        R, t = pose
        width, height = self.camera.size
        square = self.target["square_mm"] / 1e3
        reach_x, reach_y = [((self.target[side] + 1) / 2 + QUIET) * square for side in ("columns", "rows")]
        grey = np.full((height, width), AROUND)
        rim = np.array([[x, y, 0] for x in np.linspace(-reach_x, reach_x, 20) for y in np.linspace(-reach_y, reach_y, 20)])
        pixels = self.project(pose, rim[(rim @ R.T + t)[:, 2] > 0.01])
        low = np.clip(np.floor(pixels.min(0)) - 4, 0, [width - 1, height - 1]).astype(int)
        high = np.clip(np.ceil(pixels.max(0)) + 5, 1, [width, height]).astype(int)
        part = slice(low[1], high[1]), slice(low[0], high[0])
        rays, along_u, along_v = [field[part] for field in self.rays]
        offsets = (np.arange(SUBPIXELS) + 0.5) / SUBPIXELS - 0.5
        total = np.zeros(rays.shape[:2])
        normal = R[:, 2]
        for dv in offsets:
            for du in offsets:
                ray = rays + along_u * du + along_v * dv
                depth = normal @ t / (ray[..., 0] * normal[0] + ray[..., 1] * normal[1] + normal[2])
                x, y = [(ray[..., 0] * depth - t[0]) * R[0, k] + (ray[..., 1] * depth - t[1]) * R[1, k] + (depth - t[2]) * R[2, k]
                        for k in (0, 1)]
                paper = (np.abs(x) < reach_x) & (np.abs(y) < reach_y) & (depth > 0)
                total += np.where(paper, np.where(self.is_black(x, y), BLACK, WHITE), AROUND)
        grey[part] = total / SUBPIXELS**2
        light = 1 + GRADIENT * (np.arange(width) / (width - 1) - 0.5)
        return cv2.GaussianBlur(grey * light, (0, 0), BLUR_PX, borderType=cv2.BORDER_REPLICATE)


def blurred(picture, disc, path, direction):
    """A picture out of focus and moved: by a disc of that diameter and a straight path of that length, px."""
    v, u = np.meshgrid(np.fft.fftfreq(picture.shape[0]), np.fft.rfftfreq(picture.shape[1]), indexing="ij")
    # A disc's Fourier transform, by a rule of Gauss over its chords.
    angles = np.arange(1, 20) * np.pi / 20
    radius = np.pi * disc * np.hypot(u, v)
    of_disc = sum(np.sin(angle) ** 2 * np.cos(radius * np.cos(angle)) for angle in angles) / 10
    of_path = np.sinc(path * (u * np.cos(direction) + v * np.sin(direction)))
    return np.fft.irfft2(np.fft.rfft2(picture) * of_disc * of_path, s=picture.shape)


def exposed(picture, noise, rng):
    """The picture with Gaussian noise of so many grey values; OpenCV draws it several times faster than NumPy."""
    cv2.setRNGSeed(int(rng.integers(2**31)))
    drawn = cv2.randn(np.empty(picture.shape, np.float32), 0, noise)
    return cv2.add(picture.astype(np.float32), drawn, dtype=cv2.CV_8U)
