"""Holds calipose's reading of URDF against pinocchio: link poses, centres of mass, and the extent of collision meshes; and the limits
of joints, soft ones included, against the XML.

    python -m venv env
    env/bin/pip install pin==4.1.0 example-robot-data==6.0.0
    env/bin/python tests/golden/urdf_kinematics.py            # public robots, 1 000 random configurations each
    env/bin/python tests/golden/urdf_kinematics.py --golden   # writes urdf_kinematics.json

`.ci/urdf_kinematics` does the first three. The public robots come with the PyPI package example-robot-data and stay there;
calipose's binary example of the same name computes its side. urdf_kinematics.json has 40 configurations of each robot of
problems/urdf, for tests without Python. Made with Python 3.11, pin 4.1.0, example-robot-data 6.0.0, numpy 2.4.6.

Joint values are uniform within the limits, or within half a turn either way. The root link's mass, which pinocchio keeps apart
because it does not move, is part of the centre of mass.
"""

import json
import pathlib
import subprocess
import sys
import xml.etree.ElementTree

import numpy as np
import pinocchio as pin

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
GOLDEN = pathlib.Path(__file__).with_suffix(".json")
SHARE = pathlib.Path(pin.__file__).resolve().parents[4] / "share"
ROBOTS = SHARE / "example-robot-data" / "robots"
TOLERANCE = 1e-12
# Meshes are read by assimp on the other side, in single precision.
MESH_TOLERANCE = 1e-6

PUBLIC = [
    "ur_description/urdf/ur5_robot.urdf",
    "panda_description/urdf/panda.urdf",
    "xarm_description/urdf/xarm7.urdf",
    "kinova_description/robots/kinova.urdf",
    "tiago_description/robots/tiago.urdf",
    "talos_data/robots/talos_full_v2.urdf",
    "baxter_description/urdf/baxter.urdf",
    "romeo_description/urdf/romeo.urdf",
    "icub_description/robots/icub.urdf",
    "pr2_description/urdf/pr2.urdf",
]


class Reference:
    """A URDF in pinocchio, driven by the joints that mimic no other."""

    def __init__(self, path):
        self.model = pin.buildModelFromUrdf(str(path))
        self.data = self.model.createData()
        self.links = [(f.name, i) for i, f in enumerate(self.model.frames) if f.type == pin.FrameType.BODY and f.name != "universe"]
        self.mimic = {}
        self.limits = {}
        self.allowed = {}
        for joint in xml.etree.ElementTree.parse(path).getroot().findall("joint"):
            kind, name = joint.get("type"), joint.get("name")
            if kind == "fixed":
                continue
            mimic = joint.find("mimic")
            if mimic is not None:
                self.mimic[name] = (mimic.get("joint"), float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0)))
            elif kind == "continuous":
                self.limits[name] = (-np.pi, np.pi)
            else:
                limit = joint.find("limit")
                self.limits[name] = (float(limit.get("lower", 0)), float(limit.get("upper", 0)))
            if name in self.limits:
                self.allowed[name] = self.softened(name, joint.find("safety_controller"))

    def softened(self, name, controller):
        """The limits and those of the safety controller, where it has some, whichever are tighter."""
        lower, upper = self.limits[name]
        if controller is not None:
            soft_lower, soft_upper = (float(controller.get(f"soft_{end}_limit", 0)) for end in ("lower", "upper"))
            if soft_lower or soft_upper:
                return max(lower, soft_lower), min(upper, soft_upper)
        return lower, upper

    def mesh_bounds(self, path):
        """Least and greatest coordinates of the collision meshes of each link, in the link's frame."""
        geometry = pin.buildGeomFromUrdf(self.model, str(path), pin.GeometryType.COLLISION, package_dirs=[str(SHARE)])
        bounds = {}
        for object in geometry.geometryObjects:
            if not hasattr(object.geometry, "num_vertices"):
                continue
            frame = self.model.frames[object.parentFrame]
            X = frame.placement.inverse() * object.placement
            points = np.array([X.act(object.geometry.vertex(i)) for i in range(object.geometry.num_vertices)])
            bounds.setdefault(frame.name, []).append(np.r_[points.min(0), points.max(0)])
        return bounds

    def value(self, name, values):
        if name in self.mimic:
            master, multiplier, offset = self.mimic[name]
            return multiplier * self.value(master, values) + offset
        return values[name]

    def compute(self, values):
        q = pin.neutral(self.model)
        for name, joint in zip(self.model.names[1:], self.model.joints[1:]):
            value = self.value(name, values)
            # A continuous joint is a point on the circle.
            q[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        pin.framesForwardKinematics(self.model, self.data, q)
        poses = [self.data.oMf[i] for _, i in self.links]
        center = pin.centerOfMass(self.model, self.data, q)
        fixed, moving = self.model.inertias[0], pin.computeTotalMass(self.model)
        mass = fixed.mass + moving
        moment = moving * center + fixed.mass * fixed.lever
        return poses, (moment / mass if mass > 0 else None), mass


def compare(path, configurations):
    reference = Reference(path)
    rng = np.random.default_rng(20240601)
    names = list(reference.limits)
    lower, upper = np.array([reference.limits[name] for name in names]).reshape(-1, 2).T
    q = rng.uniform(lower, upper, (configurations, len(names)))
    request = json.dumps({"joints": names, "configurations": q.tolist()})
    command = ["cargo", "run", "--quiet", "--locked", "--example", "urdf_kinematics", "--", path, SHARE]
    run = subprocess.run(list(map(str, command)), input=request, capture_output=True, text=True, cwd=ROOT)
    if run.returncode:
        sys.exit(f"{path}: {run.stderr}")
    ours = json.loads(run.stdout)
    for joint in ours["joints"]:
        expected = reference.allowed[joint["name"]]
        if not np.allclose([joint["min"], joint["max"]], expected, rtol=0, atol=TOLERANCE):
            sys.exit(f"{path}: joint {joint['name']} has the limits {joint['min']} to {joint['max']}, not {expected}")
    place = {name: i for i, name in enumerate(ours["links"])}
    missing = {name for name, _ in reference.links} ^ set(place)
    if missing:
        sys.exit(f"{path}: links that only one of the two has: {sorted(missing)}")
    worst = dict(position=0.0, rotation=0.0, center=0.0, mass=0.0)
    for values, poses, center in zip(q, ours["poses"], ours["centers"]):
        expected, expected_center, mass = reference.compute(dict(zip(names, values)))
        for (name, _), X in zip(reference.links, expected):
            pose = np.array(poses[place[name]])
            worst["position"] = max(worst["position"], np.linalg.norm(pose[:3] - X.translation))
            rotation = pin.Quaternion(pose[3:]).toRotationMatrix()
            worst["rotation"] = max(worst["rotation"], np.linalg.norm(rotation - X.rotation))
        if expected_center is not None:
            worst["center"] = max(worst["center"], np.linalg.norm(np.array(center[:3]) - expected_center))
            worst["mass"] = max(worst["mass"], abs(center[3] - mass))
    bounds = reference.mesh_bounds(path)
    meshes = 0
    worst_mesh = 0.0
    for name, boxes in zip(ours["links"], ours["meshes"]):
        if len(boxes) != len(bounds.get(name, [])):
            sys.exit(f"{path}: link {name} has {len(boxes)} meshes here, {len(bounds.get(name, []))} there")
        for box, expected in zip(boxes, bounds.get(name, [])):
            meshes += 1
            worst_mesh = max(worst_mesh, np.abs(np.array(box) - expected).max())
    figures = "  ".join(f"{key} {value:.1e}" for key, value in worst.items())
    mimics = f", {len(reference.mimic)} mimicking" if reference.mimic else ""
    print(
        f"{path.stem}: {len(place)} links, {len(names)} joints{mimics}; worst {figures}; {meshes} meshes {worst_mesh:.1e}",
        flush=True,
    )
    return max(worst.values()) <= TOLERANCE and worst_mesh <= MESH_TOLERANCE


def golden():
    rng = np.random.default_rng(20240602)
    robots = []
    for path in sorted((ROOT / "problems" / "urdf").glob("*.urdf")):
        reference = Reference(path)
        names = list(reference.limits)
        lower, upper = np.array([reference.limits[name] for name in names]).T
        cases = []
        for values in rng.uniform(lower, upper, (40, len(names))):
            poses, center, mass = reference.compute(dict(zip(names, values)))
            last = dict(zip((name for name, _ in reference.links), poses))["camera_optical_frame"]
            tips = [poses[i] for i, (name, _) in enumerate(reference.links) if name.startswith("finger_")]
            cases.append(
                {
                    "q": values.tolist(),
                    "camera": last.homogeneous[:3].tolist(),
                    "fingers": [tip.translation.tolist() for tip in tips],
                    "center_of_mass": center.tolist(),
                    "mass": mass,
                }
            )
        robots.append({"urdf": path.name, "joints": names, "cases": cases})
    GOLDEN.write_text(json.dumps({"made_with": f"pin {pin.__version__}", "robots": robots}, indent=None) + "\n")


if __name__ == "__main__":
    if "--golden" in sys.argv:
        golden()
    else:
        paths = [ROBOTS / name for name in PUBLIC] + sorted((ROOT / "problems" / "urdf").glob("*.urdf"))
        agree = [compare(path, 1000) for path in paths]
        if not all(agree):
            sys.exit(f"beyond {TOLERANCE}")
