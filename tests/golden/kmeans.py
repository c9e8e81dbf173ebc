"""Writes kmeans.json: clusters of points from given centres, by scikit-learn.

Made with Python 3.11 and scikit-learn 1.9.1:

    python -m venv env
    env/bin/pip install scikit-learn==1.9.1
    env/bin/python kmeans.py

Lloyd's method until no label changes. The points are rounded before they are clustered, so that both sides see the same.
"""

import json
import pathlib

import numpy as np
from sklearn.cluster import KMeans

rng = np.random.default_rng(20261125)


def case(points, count):
    points = np.round(points, 3)
    centres = points[rng.choice(len(points), count, replace=False)]
    model = KMeans(count, init=centres, n_init=1, max_iter=1000, tol=0, algorithm="lloyd").fit(points)
    return {
        "points": points.tolist(),
        "start": centres.tolist(),
        "labels": model.labels_.tolist(),
        "centres": model.cluster_centers_.tolist(),
        "inertia": model.inertia_,
    }


blobs = np.concatenate([rng.normal(centre, 0.6, (30, 2)) for centre in [(0, 0), (3, 1), (1, 4), (-2, 3)]])
joints = rng.uniform(-3, 3, (160, 6))
cases = [case(blobs, 4), case(blobs, 9), case(joints, 3), case(joints, 12), case(joints[:, :1], 7), case(joints, 40)]
pathlib.Path(__file__).with_suffix(".json").write_text(json.dumps(cases) + "\n")
