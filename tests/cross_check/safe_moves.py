"""Moves that a plan says are safe, followed in MuJoCo and coal.

    python tests/cross_check/safe_moves.py PLAN PROBLEM [PLAN PROBLEM ...]

Builds the robot of the problem file as self_collision.py does and goes along the moves of `plan.json` in COUNT configurations: no tested pair
of links may be nearer than the clearance that the plan states for the move, by both libraries and by more than TOLERANCE (MuJoCo 4.0.0 at times
finds a capsule apart from a box that it pierces, or the other way round), and nothing may be said safe of a move that is not. On level ground
the tip-over margin, from MuJoCo's centre of mass and the support polygon of the problem file, may not be below the one stated either. The least
distances found must come near the ones stated, or these would prove little. Exits with 1 if anything disagrees. Makes a virtual environment
with mujoco and coal from PyPI (see environment.py).
"""

import json
import sys
import tomllib
from pathlib import Path

from environment import run_with
from self_collision import REQUIREMENTS, TOLERANCE, coal_shape, dump, mjcf

COUNT = 10_000
# A stated clearance is within a millimetre of the least, and a move is looked at in steps.
NEAR = 3e-3


class World:
    """The robot in both libraries."""

    def __init__(self, problem_path):
        self.model = dump(problem_path, 1)
        links = self.model["links"]
        self.mj = mujoco.MjModel.from_xml_string(mjcf(self.model))
        self.data = mujoco.MjData(self.mj)
        self.moved = [
            (self.mj.joint(f"j{i}").qposadr[0], link["motion"]["joint"], link["motion"]["multiplier"], link["motion"]["offset"])
            for i, link in enumerate(links)
            if link["motion"]
        ]
        self.solids = {}
        for i, link in enumerate(links):
            for j, body in enumerate(link["bodies"]):
                rotation = np.zeros(9)
                mujoco.mju_quat2Mat(rotation, np.array(body["pose"]["quaternion_wxyz"]))
                local = coal.Transform3s(rotation.reshape(3, 3), np.array(body["pose"]["position"]))
                self.solids.setdefault(i, []).append((self.mj.geom(f"g{i}_{j}").id, coal_shape(coal, np, body), local))
        self.has_mass = any(link["mass"] for link in links)

    def place(self, q):
        for address, joint, multiplier, offset in self.moved:
            self.data.qpos[address] = multiplier * q[joint] + offset
        mujoco.mj_kinematics(self.mj, self.data)
        mujoco.mj_comPos(self.mj, self.data)

    def distance(self, below):
        """The least distance of tested links, as the greater of what both libraries say; pairs beyond `below` are not looked at by coal."""
        least = np.inf
        for a, b in self.model["pairs"]:
            for g, shape_g, local_g in self.solids[a]:
                for h, shape_h, local_h in self.solids[b]:
                    found = mujoco.mj_geomDistance(self.mj, self.data, g, h, 10.0, np.zeros(6))
                    if found < below:
                        placed = [self.transform(link) * local for link, local in ((a, local_g), (b, local_h))]
                        found = max(found, coal.distance(shape_g, placed[0], shape_h, placed[1], coal.DistanceRequest(), coal.DistanceResult()))
                    least = min(least, found)
        return least

    def transform(self, link):
        body = self.mj.body(f"l{link}").id
        return coal.Transform3s(self.data.xmat[body].reshape(3, 3), self.data.xpos[body])

    def balance(self, polygon):
        """Distance of the centre of mass, seen from above, from the polygon's nearest edge; negative outside."""
        p = self.data.subtree_com[0][:2]
        edges = list(zip(polygon, np.roll(polygon, -1, axis=0)))
        return min(((b - a)[0] * (p - a)[1] - (b - a)[1] * (p - a)[0]) / np.linalg.norm(b - a) for a, b in edges)


def polygon_of(problem):
    """The support polygon in m, counterclockwise; None where there is none, or the ground is not level."""
    stability = problem.get("stability")
    if stability is None or stability.get("roll_deg", 0) or stability.get("pitch_deg", 0):
        return None
    points = np.array(stability["support_mm"]) / 1e3
    return points[ConvexHull(points).vertices]


def follow(plan_path, problem_path):
    plan, problem = json.loads(Path(plan_path).read_text()), tomllib.loads(Path(problem_path).read_text())
    tour, world, polygon = plan["tour"], World(problem_path), polygon_of(problem)
    of_id = {pose["id"]: pose["joints_rad"] for pose in plan["poses"]}
    home = [tour["home_rad"]] if "home_rad" in tour else []
    stops = [np.array(q) for q in [*home, *(of_id[id] for id in tour["order"]), *(home if tour["returns"] else [])]]
    legs = []
    for move, (start, end) in zip(tour["moves"], zip(stops, stops[1:]), strict=True):
        corners = [start, *map(np.array, move.get("via_rad", [])), end]
        legs += [(number, move, a, b) for number, (a, b) in enumerate(zip(corners, corners[1:]))]
    each = COUNT // len(legs)
    wrong, least, stated, round_about = [], np.inf, np.inf, sum("via_rad" in move for move in tour["moves"])
    for _, move, a, b in legs:
        if not move.get("safe"):
            continue
        clearance, margin = move.get("clearance_m"), move.get("tip_over_margin_m")
        stated = min(stated, np.inf if clearance is None else clearance)
        for t in np.linspace(0, 1, each):
            world.place((1 - t) * a + t * b)
            if clearance is not None:
                found = world.distance(min(clearance, least) + 0.01)
                least = min(least, found)
                if found < clearance - TOLERANCE:
                    wrong.append(f"links come within {1e3 * found:.3f} mm where {1e3 * clearance:.3f} mm is stated")
            if margin is not None and polygon is not None:
                found = world.balance(polygon)
                if found < margin - TOLERANCE:
                    wrong.append(f"the tip-over margin is {1e3 * found:.3f} mm where {1e3 * margin:.3f} mm is stated")
    safe = sum(move.get("safe") is True for move in tour["moves"])
    print(f"{plan_path}: {safe} of {len(tour['moves'])} moves safe, {round_about} round about, {each * len(legs)} configurations; least distance "
          f"{1e3 * least:.2f} mm found, {1e3 * stated:.2f} mm stated")
    if least - stated > NEAR:
        wrong.append("the stated clearance is far below what was found")
    for fault in wrong[:5]:
        print(f"  {fault}")
    return not wrong


if __name__ == "__main__":
    if len(sys.argv) < 3 or len(sys.argv) % 2 == 0:
        sys.exit(__doc__)
    run_with(*REQUIREMENTS, "scipy==1.16.3")
    import coal
    import mujoco
    import numpy as np
    from scipy.spatial import ConvexHull

    agreed = [follow(*pair) for pair in zip(sys.argv[1::2], sys.argv[2::2])]
    sys.exit(0 if all(agreed) else 1)
