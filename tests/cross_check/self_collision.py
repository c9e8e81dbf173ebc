"""Collision verdicts, also with obstacles, and centres of mass of calipose against MuJoCo and coal.

    python tests/cross_check/self_collision.py [COUNT] [FILE ...]

Makes a virtual environment with mujoco and coal from PyPI (in $CROSS_CHECK_VENV, or a temporary folder), lets
`tests/tools/feasibility_dump.rs` print the model and calipose's answers for COUNT (10 000) random configurations and for
pairs of them moved to either side of where the verdict changes, builds the same robot as MJCF, and compares configuration
by configuration (of the Servosila with bodies and of shapes.toml, which has every kind of body and of obstacle, unless files are given):

- distances of every tested pair of links, where they are apart: MuJoCo's kinematics, MuJoCo's and coal's distances. One
  that contradicts both is wrong (MuJoCo 4.0.0 at times finds a capsule apart from a box that it pierces);
- verdicts: no pair that either library finds nearer than the clearance by more than TOLERANCE may be called free, and none
  called a collision that both find farther than the clearance by more than TOLERANCE;
- the centre of mass.

Exits with 1 if anything disagrees.
"""

import json
import subprocess
import sys
from pathlib import Path

from environment import run_with

ROOT = Path(__file__).resolve().parents[2]
REQUIREMENTS = ["numpy==2.4.6", "mujoco==4.0.0", "coal==3.0.3"]
# Both libraries iterate to about 1e-6 m by default; contact within this is nobody's error.
TOLERANCE = 1e-5
CENTER_TOLERANCE = 1e-9


def dump(file, count):
    command = ["cargo", "run", "--quiet", "--locked", "--example", "feasibility_dump", "--", file, str(count)]
    return json.loads(subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout)


def words(numbers):
    return " ".join(repr(float(x)) for x in numbers)


def mjcf(model):
    """The robot as MJCF: body l<i> is link i, geom g<i>_<j> its body j, joint j<i> moves link i."""
    links = model["links"]
    meshes = []

    def place(pose):
        return f'pos="{words(pose["position"])}" quat="{words(pose["quaternion_wxyz"])}"'

    def geom(i, j, body):
        shape, size, at = body["shape"], body["size"], place(body["pose"])
        name = f'name="g{i}_{j}"'
        if shape == "convex":
            vertices = words(x for point in size for x in point)
            # MuJoCo moves a mesh to its centre of mass and the geom with it, so the pose stays that of the points.
            meshes.append(f'<mesh name="m{i}_{j}" vertex="{vertices}"/>')
            return f'<geom {name} type="mesh" mesh="m{i}_{j}" {at}/>'
        sizes = {
            "box": lambda: [s / 2 for s in size],
            "sphere": lambda: size,
            "cylinder": lambda: [size[0], size[1] / 2],
            "capsule": lambda: [size[0], size[1] / 2],
        }[shape]()
        return f'<geom {name} type="{shape}" size="{words(sizes)}" {at}/>'

    def body(i):
        link = links[i]
        inside = []
        if link["motion"]:
            m = link["motion"]
            inside.append(f'<joint name="j{i}" type="{m["kind"]}" axis="{words(m["axis"])}"/>')
        if link["mass"]:
            m = link["mass"]
            inside.append(f'<inertial pos="{words(m["center"])}" mass="{m["mass"]!r}" diaginertia="1 1 1"/>')
        inside += [geom(i, j, b) for j, b in enumerate(link["bodies"])]
        inside += [body(k) for k, other in enumerate(links) if other["parent"] == i]
        return f'<body name="l{i}" {place(link["pose"])}>{"".join(inside)}</body>'

    tree = body(0)
    return f"""<mujoco>
      <compiler inertiafromgeom="false" boundmass="1e-13" boundinertia="1e-13" balanceinertia="true"/>
      <option><flag contact="disable"/></option>
      <default><geom contype="0" conaffinity="0"/></default>
      <asset>{"".join(meshes)}</asset>
      <worldbody>{tree}</worldbody>
    </mujoco>"""


def coal_shape(coal, numpy, body):
    shape, size = body["shape"], body["size"]
    if shape == "box":
        return coal.Box(*size)
    if shape == "sphere":
        return coal.Sphere(*size)
    if shape == "cylinder":
        return coal.Cylinder(*size)
    if shape == "capsule":
        return coal.Capsule(*size)
    points = coal.StdVec_Vec3s()
    points.extend([numpy.array(point) for point in size])
    return coal.Convex.convexHull(points, False, "Qt")


def main(file, count):
    """Prints how far calipose and the libraries agree on FILE; whether they do."""
    import coal
    import mujoco
    import numpy as np

    model = dump(file, count)
    mj = mujoco.MjModel.from_xml_string(mjcf(model))
    data = mujoco.MjData(mj)
    links, pairs, clearance = model["links"], model["pairs"], model["clearance"]
    has_mass = any(link["mass"] for link in links)
    geoms = {i: [mj.geom(f"g{i}_{j}").id for j in range(len(link["bodies"]))] for i, link in enumerate(links)}
    shapes = {
        mj.geom(f"g{i}_{j}").id: (coal_shape(coal, np, body), i, body["pose"])
        for i, link in enumerate(links)
        for j, body in enumerate(link["bodies"])
    }
    moved = [
        (mj.joint(f"j{i}").qposadr[0], link["motion"]["joint"], link["motion"]["multiplier"], link["motion"]["offset"])
        for i, link in enumerate(links)
        if link["motion"]
    ]

    def rigid(rotation, position):
        return coal.Transform3s(np.asarray(rotation).reshape(3, 3), np.asarray(position))

    local = {}
    for g, (_, _, pose) in shapes.items():
        rotation = np.zeros(9)
        mujoco.mju_quat2Mat(rotation, np.array(pose["quaternion_wxyz"]))
        local[g] = rigid(rotation, pose["position"])

    fromto = np.zeros(6)
    request = coal.DistanceRequest()
    worst = {"mujoco": 0.0, "coal": 0.0}
    missed = needless = colliding = compared = disagreements = near = 0
    alone = {"mujoco": 0, "coal": 0}
    worst_center = 0.0
    for configuration in model["configurations"]:
        q = configuration["q"]
        for address, joint, multiplier, offset in moved:
            data.qpos[address] = multiplier * q[joint] + offset
        mujoco.mj_kinematics(mj, data)
        mujoco.mj_comPos(mj, data)
        if has_mass:
            error = np.abs(data.subtree_com[0] - configuration["center_of_mass"]).max()
            worst_center = max(worst_center, error)
        placed = {}
        for g, (_, i, _) in shapes.items():
            body = mj.body(f"l{i}").id
            placed[g] = rigid(data.xmat[body], data.xpos[body]) * local[g]
        nearest = {"mujoco": np.inf, "coal": np.inf}
        for (a, b), gap in zip(pairs, configuration["gaps"]):
            found = {"mujoco": np.inf, "coal": np.inf}
            for g in geoms[a]:
                for h in geoms[b]:
                    found["mujoco"] = min(found["mujoco"], mujoco.mj_geomDistance(mj, data, g, h, 10.0, fromto))
                    result = coal.DistanceResult()
                    distance = coal.distance(shapes[g][0], placed[g], shapes[h][0], placed[h], request, result)
                    found["coal"] = min(found["coal"], distance)
            contradicts = {}
            for library, distance in found.items():
                nearest[library] = min(nearest[library], distance)
                if gap > TOLERANCE and distance > TOLERANCE:
                    compared += 1
                    worst[library] = max(worst[library], abs(distance - gap))
                # In contact calipose does not say how deep.
                contradicts[library] = abs(max(gap, 0) - max(distance, 0)) > TOLERANCE
            disagreements += all(contradicts.values())
            if sum(contradicts.values()) == 1:
                alone["mujoco" if contradicts["mujoco"] else "coal"] += 1
        colliding += configuration["collides"]
        near += abs(min(nearest.values()) - clearance) < 1e-3
        if not configuration["collides"] and min(nearest.values()) < clearance - TOLERANCE:
            missed += 1
        if configuration["collides"] and min(nearest.values()) > clearance + TOLERANCE:
            needless += 1

    print(f"{model['problem']}: {len(model['configurations'])} configurations, {len(pairs)} pairs of links, "
          f"{colliding} collide by calipose ({near} are within 1 mm of the clearance).")
    print(f"Collisions missed: {missed}. Collisions that neither MuJoCo {mujoco.__version__} nor coal {coal.__version__} "
          f"finds: {needless}.")
    print(f"{compared} distances compared; worst difference: "
          + ", ".join(f"{name} {value:.1e} m" for name, value in worst.items())
          + f". In {disagreements} cases calipose contradicts both libraries; in {alone['mujoco']} MuJoCo contradicts coal and "
          f"calipose, in {alone['coal']} coal contradicts MuJoCo and calipose.")
    if has_mass:
        print(f"Centre of mass: worst difference {worst_center:.1e} m.")
    return not (missed or needless or disagreements or worst_center > CENTER_TOLERANCE or not compared)


if __name__ == "__main__":
    run_with(*REQUIREMENTS)
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    files = sys.argv[2:] or ["problems/servosila-engineer-bodies.toml", "tests/cross_check/shapes.toml"]
    agreed = [main(file, count) for file in files]
    sys.exit(0 if all(agreed) else 1)
