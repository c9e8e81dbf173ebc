"""The tables and the summary of a study, and the best set-up of a design, by foreign programs.

    python tests/cross_check/studies.py [FOLDER]

Runs a small study and a small design by ${CALIPOSE:-target/release/calipose}. Arrow reads results.parquet, which must hold what
results.csv says; pandas and SciPy make means, medians, Student's intervals and paired comparisons from the rows anew, which must be
those of study.json; SciPy holds the Sobol draws of a sampled study against the uniform distribution. The plan of the design's
best.toml, of swept views alone as designs are, goes through map_error.py (OpenCV, NumPy): the map error must be the one that the
design states. Results stay in FOLDER. Makes a virtual environment with packages from PyPI (see environment.py). Exits with 1 at
the first disagreement.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from environment import run_with

ROOT = Path(__file__).resolve().parents[2]
TOLERANCE = 1e-9

STUDY = f"""
name = "Cross-check"
problems = ["{ROOT}/problems/servosila-engineer.toml"]
set = ["sweep.step_deg=20"]
[[factors]]
key = "noise.sigma_px"
values = [0.2, 0.3, 0.7]
[[factors]]
name = "lens"
levels = [{{ name = "as it is" }}, {{ name = "longer", set = ["camera.fx_px=1100", "camera.fy_px=1100"] }}]
[choose]
methods = ["best", "kmeans-joints", "random"]
counts = [8, 12]
seeds = 4
"""

DRAWN = f"""
name = "Drawn"
problems = ["{ROOT}/problems/servosila-engineer.toml"]
set = ["sweep.step_deg=40"]
[[factors]]
key = "noise.sigma_px"
log_uniform = [0.1, 1.0]
[[factors]]
key = "camera.fx_px"
normal = {{ mean = 1000, sigma = 20 }}
[design]
kind = "sampled"
draws = 256
[choose]
methods = ["random"]
"""

DESIGN = f"""
name = "Cross-check"
problem = "{ROOT}/problems/servosila-engineer.toml"
set = ["sweep.step_deg=16", "visibility.min_distance_mm=250", "target.zone={{}}"]
[[free]]
key = "camera.roll_deg"
range = {{ from = 0, to = 150, step = 30 }}
[[free]]
key = "target.pose.position_mm[0]"
uniform = [100, 300]
[search]
screened = 32
rounds = 3
map = 0
"""


def calipose(*arguments):
    program = os.environ.get("CALIPOSE", ROOT / "target/release/calipose")
    subprocess.run([program, *arguments, "--quiet"], check=True, stdin=subprocess.DEVNULL)


def require(agree, what):
    if not agree:
        sys.exit(f"FAILED: {what}")


def close(ours, theirs):
    if ours is None or theirs is None or np.any(pd.isna(theirs)):
        return ours is None and (theirs is None or np.all(pd.isna(theirs)))
    return np.allclose(ours, theirs, rtol=TOLERANCE, atol=0)


def interval(numbers):
    """Student's 95 % interval of the mean; None of fewer than two numbers."""
    if len(numbers) < 2:
        return None
    return stats.t.interval(0.95, len(numbers) - 1, np.mean(numbers), stats.sem(numbers))


def table(folder):
    """results.csv, which must be what Arrow reads in results.parquet."""
    told = pd.read_csv(folder / "results.csv", keep_default_na=False, na_values=[""], float_precision="round_trip")
    read = pq.read_table(folder / "results.parquet").to_pandas()
    require(len(told) == len(read) and len(told.columns) == len(read.columns), "the tables have one shape")
    for ours, theirs in zip(told.columns, read.columns):
        a, b = told[ours], read[theirs]
        same = a.isna().eq(b.isna()).all() and a.dropna().tolist() == b.dropna().tolist()
        require(same, f"column {ours} of results.csv is {theirs} of results.parquet")
    return told


def series(row, names):
    return ", ".join(f"{row[name]} poses" if name == "count" else str(row[name]) for name in names)


def summary(folder, rows):
    """Holds study.json against the rows; how many means and differences were compared."""
    document = json.loads((folder / "study.json").read_text())
    axes = {axis["name"]: axis["levels"] for axis in document["axes"]}
    require(set(axes) == {"noise.sigma_px", "lens", "count", "method"}, f"the axes are {list(axes)}")
    compared = 0
    for outcome in document["outcomes"]:
        column = outcome["outcome"]
        for means in outcome["means"]:
            axis = means["axis"]
            names = [name for name in ("problem", "criterion", "count", "method") if name in axes and name != axis]
            groups = rows.groupby([rows[axis].astype(str), rows.apply(series, axis=1, names=names)])[column]
            require(len(groups) == len(means["means"]), f"{column} has as many means by {axis}")
            for mean in means["means"]:
                numbers = groups.get_group((mean["level"], mean["series"])).to_numpy()
                require(len(numbers) == mean["rows"], f"{column} by {axis}: rows of {mean}")
                for key, value in [("mean", np.mean(numbers)), ("median", np.median(numbers)), ("interval", interval(numbers))]:
                    require(close(mean[key], value), f"{column} by {axis}: {key} is {value} by SciPy, and not {mean}")
                    compared += 1
        for comparison in outcome["compared"]:
            axis, against = comparison["axis"], comparison["against"]
            others = [name for name in axes if name != axis]
            names = [name for name in ("problem", "criterion", "count", "method") if name in others]
            blocks = rows.groupby([*others, axis])[column].mean().unstack(axis)
            blocks.columns = [str(level) for level in blocks.columns]
            labels = blocks.reset_index().apply(series, axis=1, names=names).to_numpy()
            for difference in comparison["differences"]:
                pairs = blocks[labels == difference["series"]][[against, difference["level"]]].dropna().to_numpy()
                change, ratio = pairs[:, 1] - pairs[:, 0], np.log(pairs[:, 1] / pairs[:, 0])
                require(len(pairs) == difference["pairs"], f"{column} against {against}: pairs of {difference}")
                expected = {
                    "difference": np.mean(change),
                    "interval": interval(change),
                    "ratio": np.exp(np.mean(ratio)),
                    "ratio_interval": None if len(pairs) < 2 else np.exp(interval(ratio)),
                }
                for key, value in expected.items():
                    # An interval of equal differences has no width but rounding.
                    agree = close(difference[key], value) or np.allclose(difference[key], value, rtol=1e-6, atol=1e-9)
                    require(agree, f"{column} against {against}: {key} is {value} by SciPy, and not {difference}")
                    compared += 1
    return compared


def draws(rows):
    """How far the draws are from their distributions at most, as Kolmogorov and Smirnov measure it."""
    sigma = stats.kstest(np.log10(rows["noise.sigma_px"]), stats.uniform(-1, 1).cdf).statistic
    focal = stats.kstest(rows["camera.fx_px"], stats.norm(1000, 20).cdf).statistic
    # Of 256 points of a Sobol sequence each 256th of the range holds one; of independent ones the distance is some 0.05.
    for distance in (sigma, focal):
        require(distance < 1.5 / 256, f"the draws are {distance} off their distribution")
    return max(sigma, focal)


if __name__ == "__main__":
    run_with("numpy==2.4.6", "opencv-python-headless==5.0.0.93", "pandas==2.3.3", "pyarrow==22.0.0", "scipy==1.16.3")
    import numpy as np
    import pandas as pd
    import pyarrow.parquet as pq
    from scipy import stats

    with tempfile.TemporaryDirectory() as temporary:
        desk = Path(sys.argv[1] if len(sys.argv) > 1 else temporary).absolute()
        desk.mkdir(parents=True, exist_ok=True)
        for name, text in [("study", STUDY), ("drawn", DRAWN), ("design", DESIGN)]:
            (desk / f"{name}.toml").write_text(text)
        calipose("study", "run", desk / "study.toml", "--output", desk / "study")
        rows = table(desk / "study")
        print(f"results.parquet by Arrow: {len(rows)} rows of {len(rows.columns)} columns, those of results.csv")
        print(f"study.json by pandas and SciPy: {summary(desk / 'study', rows)} numbers agree")
        calipose("study", "run", desk / "drawn.toml", "--output", desk / "drawn")
        print(f"draws: within {draws(table(desk / 'drawn')):.5f} of their distributions")

        calipose("design", desk / "design.toml", "--output", desk / "design")
        best, plan = desk / "design/best.toml", desk / "plan"
        # Designs are about swept views alone.
        calipose("plan", best, "--output", plan, "--trials", "0", "--set", "selection.off_grid=false",
                 "--set", "selection.tour_tolerance=0")
        stated = json.loads((desk / "design/design.json").read_text())["best"]["map_error_px"]
        planned = json.loads((plan / "plan.json").read_text())["map_error_px"]
        require(stated == planned, f"the plan of best.toml has {planned} px, the design {stated}")
        script = Path(__file__).with_name("map_error.py")
        subprocess.run([sys.executable, script, best, plan / "plan.json"], check=True)
