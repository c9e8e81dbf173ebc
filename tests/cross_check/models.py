"""Models of plans' robots and recordings of their tours, read by foreign programs.

    python tests/cross_check/models.py PLAN PROBLEM [PLAN PROBLEM ...]

$CALIPOSE (or target/release/calipose) exports each plan as URDF, MJCF, SDF and MCAP, and of each

- URDF by yourdfpy, pinocchio and Drake, MJCF by MuJoCo and Drake, SDF by Drake's libsdformat: all links at every pose of the plan and at random
  joint values where kinematics of ours in NumPy (of Denavit-Hartenberg tables) or pinocchio on the problem's own URDF have them; the camera
  where plan.json has it, seen from the board; limits and masses as the other formats have them;
- MuJoCo: the pairs of bodies that it tests are those that calipose tests, no body touches another at a pose of the plan or a turn between
  poses, and the corners of the board are in its camera's picture where the pinhole puts them;
- the sensor of the SDF: its pose and its intrinsics;
- MCAP by mcap and mcap-ros2-support, and by rosbags with its own definitions: every message; joint values at the stops to the last bit and on
  straight lines between them, no faster than the joints may be; the tree of frames at every moment as MuJoCo has it; K and D;
- the picture of the board by OpenCV's detector: its corners, on the plate by the mesh's texture coordinates, are the board's.

Exits with 1 if anything disagrees. The packages are PyPI's (see environment.py).
"""

import json
import logging
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path

from environment import run_with

ROOT = Path(__file__).resolve().parents[2]
POSE = 1e-9  # Positions in m and entries of rotations.
SINGLE = 2e-7  # What MuJoCo holds in single precision, of 1.
RANDOM = 200
CORNER_MM = 0.1
# Corners in pictures that are rendered larger by a factor and averaged down: MuJoCo itself does not smooth edges off the screen.
RENDERED_PX = 0.2
FINER = 3
BORDER_PX = 20
REQUIREMENTS = [
    "drake==1.51.1",
    "mcap==1.6.0",
    "mcap-ros2-support==0.6.0",
    "mujoco==4.0.0",
    "numpy==2.4.6",
    "opencv-python-headless==5.0.0.93",
    "pin==4.1.0",
    "rosbags==0.11.9",
    "yourdfpy==0.0.60",
]


def transform(R, t):
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = R, t
    return X


def pose_of(table):
    table = table or {}
    return transform(checks.from_rpy(table.get("rpy_deg", [0, 0, 0])), np.array(table.get("position_mm", [0, 0, 0])) / 1e3)


def apart(X, Y):
    return np.abs(np.asarray(X) - np.asarray(Y)).max()


class Table:
    """A robot by its Denavit-Hartenberg table, in NumPy."""

    def __init__(self, problem, joints):
        robot = problem["robot"]
        self.rows, self.flange = robot["joints"], pose_of(robot.get("flange"))
        self.is_modified = robot.get("convention") == "modified"

    def links(self, q):
        """Poses of the links in the base, by the names that the models have for them."""
        X, poses = np.eye(4), {"base": np.eye(4)}
        for value, row in zip(q, self.rows):
            slides = row.get("kind") == "prismatic"
            theta = np.radians(row.get("theta_deg", 0)) + (0 if slides else value)
            d = row.get("d_mm", 0) / 1e3 + (value if slides else 0)
            a, alpha = row.get("a_mm", 0) / 1e3, np.radians(row.get("alpha_deg", 0))
            turn = lambda axis, angle: transform(checks.from_rpy(np.degrees(angle) * np.eye(3)[axis]), np.zeros(3))
            move = lambda axis, way: transform(np.eye(3), way * np.eye(3)[axis])
            along_x, about_z = move(0, a) @ turn(0, alpha), turn(2, theta) @ move(2, d)
            X = X @ (along_x @ about_z if self.is_modified else about_z @ along_x)
            # The joint has the name already.
            poses[f"{row['name']}_link"] = X
        poses["flange"] = X @ self.flange
        return poses

    board_link = "base"


class Described:
    """A robot by pinocchio on the URDF that the problem names."""

    def __init__(self, problem, joints, folder):
        robot = problem["robot"]
        self.model = pinocchio.buildModelFromUrdf(str(folder / robot["urdf"]))
        self.data, self.joints = self.model.createData(), joints
        self.held = {}
        for key, unit in (("joint_values_deg", np.radians), ("joint_values_mm", lambda x: x / 1e3)):
            self.held |= {name: unit(value) for name, value in robot.get(key, {}).items()}
        self.mimics = {}
        for joint in ET.parse(folder / robot["urdf"]).iter("joint"):
            if (mimic := joint.find("mimic")) is not None:
                self.mimics[joint.get("name")] = mimic.get("joint"), float(mimic.get("multiplier", 1)), float(mimic.get("offset", 0))
        root = [frame.name for frame in self.model.frames if frame.type == pinocchio.FrameType.BODY][0]
        self.base = robot.get("base_link", root)
        self.board_link = problem["target"].get("link", self.base)

    def links(self, q):
        values = self.held | dict(zip(self.joints, q))
        for name, (leader, multiplier, offset) in self.mimics.items():
            values[name] = multiplier * values.get(leader, 0.0) + offset
        return in_base(self.base, pinocchio_links(self.model, self.data, values))


def in_base(base, poses):
    X_BW = np.linalg.inv(poses[base])
    return {name: X_BW @ X for name, X in poses.items()}


def pinocchio_links(model, data, values):
    """Poses of all links at joint values by name."""
    q = pinocchio.neutral(model)
    for name, value in values.items():
        if not model.existJointName(name):
            continue
        joint = model.joints[model.getJointId(name)]
        # A joint without limits is a point on a circle.
        q[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
    pinocchio.framesForwardKinematics(model, data, q)
    bodies = [i for i, frame in enumerate(model.frames) if frame.type == pinocchio.FrameType.BODY]
    return {model.frames[i].name: data.oMf[i].homogeneous for i in bodies}


class Urdf:
    """What the exported URDF says itself."""

    def __init__(self, path):
        self.root = ET.parse(path).getroot()
        self.joints = {joint.get("name"): joint for joint in self.root.iter("joint")}
        self.links = [link.get("name") for link in self.root.iter("link")]

    def limits(self, name):
        limit = self.joints[name].find("limit")
        return float(limit.get("lower")), float(limit.get("upper"))

    def value(self, name, q):
        """Of a joint, at the arm's values by name."""
        mimic = self.joints[name].find("mimic")
        if mimic is None:
            return q[name]
        return float(mimic.get("multiplier")) * q[mimic.get("joint")] + float(mimic.get("offset"))

    def values(self, q):
        moving = [name for name, joint in self.joints.items() if joint.get("type") != "fixed"]
        return {name: self.value(name, q) for name in moving}


class Drake:
    def __init__(self, path):
        self.plant = MultibodyPlant(0.0)
        models = Parser(self.plant).AddModels(str(path))
        assert len(models) == 1, path
        self.model = models[0]
        self.plant.Finalize()
        self.context = self.plant.CreateDefaultContext()

    def links(self, values):
        for name, value in values.items():
            joint = self.plant.GetJointByName(name, self.model)
            (joint.set_angle if isinstance(joint, RevoluteJoint) else joint.set_translation)(self.context, value)
        bodies = [self.plant.get_body(index) for index in self.plant.GetBodyIndices(self.model)]
        return {body.name(): body.EvalPoseInWorld(self.context).GetAsMatrix4() for body in bodies}

    def limits(self, name):
        joint = self.plant.GetJointByName(name, self.model)
        return joint.position_lower_limits()[0], joint.position_upper_limits()[0]

    def masses(self):
        bodies = [self.plant.get_body(index) for index in self.plant.GetBodyIndices(self.model)]
        return {body.name(): body.default_mass() for body in bodies}


class MuJoCo:
    def __init__(self, path, links):
        self.model = mujoco.MjModel.from_xml_path(str(path))
        self.data = mujoco.MjData(self.model)
        # The name of the world is MuJoCo's own.
        own = [self.model.body(i).name for i in range(self.model.nbody)]
        self.names = ["world" if name == "world_link" and "world" in links else name for name in own]

    def links(self, values):
        for name, value in values.items():
            self.data.qpos[self.model.joint(name).qposadr[0]] = value
        return self.placed()

    def placed(self):
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_camlight(self.model, self.data)
        bodies = range(1, self.model.nbody)
        return {self.names[i]: transform(self.data.xmat[i].reshape(3, 3), self.data.xpos[i]) for i in bodies}

    def touching(self):
        mujoco.mj_collision(self.model, self.data)
        names = lambda contact: sorted(self.names[self.model.geom_bodyid[geom]] for geom in contact.geom)
        return {tuple(names(contact)) for contact in self.data.contact[: self.data.ncon]}

    def tested(self):
        """Pairs of bodies that have solids and are neither excluded nor one rigid body."""
        model = self.model
        solid = sorted({int(body) for geom, body in enumerate(model.geom_bodyid) if model.geom_contype[geom]})
        excluded = {(signature >> 16, signature & 0xFFFF) for signature in map(int, model.exclude_signature)}
        assert model.opt.disableflags & mujoco.mjtDisableBit.mjDSBL_FILTERPARENT
        pairs = {(a, b) for a in solid for b in solid if a < b and model.body_weldid[a] != model.body_weldid[b]}
        pairs -= {(min(pair), max(pair)) for pair in excluded}
        return {tuple(sorted((self.names[a], self.names[b]))) for a, b in pairs}

    def pixels(self, points):
        """Where the camera's picture has points of the world, the centre of the top left pixel being (0, 0)."""
        model, id = self.model, self.model.camera("camera").id
        size = model.cam_resolution[id]
        # What its renderer draws by: the frustum, in single precision.
        scene = mujoco.MjvScene(model, 10)
        view = mujoco.MjvCamera()
        view.type, view.fixedcamid = mujoco.mjtCamera.mjCAMERA_FIXED, id
        mujoco.mjv_updateCamera(model, self.data, view, scene)
        seen = scene.camera[0]
        near, half = seen.frustum_near, seen.frustum_width or (seen.frustum_top - seen.frustum_bottom) / 2 * size[0] / size[1]
        R, t = self.data.cam_xmat[id].reshape(3, 3), self.data.cam_xpos[id]
        p = (points - t) @ R
        x, y = near * p[:, 0] / -p[:, 2], near * p[:, 1] / -p[:, 2]
        u = (x - seen.frustum_center + half) / (2 * half) * size[0] - 0.5
        v = (seen.frustum_top - y) / (seen.frustum_top - seen.frustum_bottom) * size[1] - 0.5
        return np.column_stack([u, v])


class Checked:
    """A plan with its problem and its files."""

    def __init__(self, plan_path, problem_path, folder):
        self.plan = json.loads(Path(plan_path).read_text())
        self.problem = checks.read_problem(problem_path, self.plan)
        self.set = [word for text in self.plan["problem"].get("set", []) for word in ("--set", text)]
        listed = self.asked("export", plan_path, "--problem", problem_path, "--to", "urdf,mjcf,sdf,mcap", "-o", folder)["files"]
        first = lambda kind: folder / next(file["file"] for file in listed if file["format"] == kind)
        self.urdf_path, self.mjcf_path, self.sdf_path, self.mcap_path = map(first, ("urdf", "mjcf", "sdf", "mcap"))
        assert all((folder / file["file"]).stat().st_size for file in listed)
        self.folder = folder
        self.urdf = Urdf(self.urdf_path)
        self.problem_path = Path(problem_path)
        tour = self.plan["tour"]
        of_id = {pose["id"]: pose for pose in self.plan["poses"]}
        self.poses = [of_id[id] for id in tour["order"]]
        self.joints = self.plan["joints"]
        self.turns = [via for move in tour["moves"] for via in move.get("via_rad", [])]
        if "urdf" in self.problem["robot"]:
            self.reference = Described(self.problem, self.joints, self.problem_path.parent)
        else:
            self.reference = Table(self.problem, self.joints)
        rng = np.random.default_rng(1)
        low, high = np.array([self.urdf.limits(name) for name in self.joints]).T
        self.random = [rng.uniform(low, high) for _ in range(RANDOM)]
        self.X_BT = pose_of(self.problem["target"]["pose"])
        self.camera = next(name for name in self.urdf.links if name in ("camera_optical_frame", "camera"))

    @staticmethod
    def asked(*arguments):
        """What calipose answers."""
        program = os.environ.get("CALIPOSE", ROOT / "target/release/calipose")
        return json.loads(subprocess.run([program, *arguments, "--json"], check=True, stdout=subprocess.PIPE).stdout)

    def by_name(self, q):
        return dict(zip(self.joints, q))

    def hold(self, what, links, tolerance=POSE):
        """That a reader's links are where they are by the reference, at poses and at random; and that the camera sees the board as planned."""
        worst = 0.0
        root = self.urdf.links[0]
        for q in [*(pose["joints_rad"] for pose in self.poses), *self.turns, *self.random]:
            found, expected = links(self.urdf.values(self.by_name(q))), self.reference.links(q)
            # SDF keeps the name of the world for itself, and Drake has a link of that name stand for it.
            if root == "world" and root not in found:
                found[root] = found.get("world_link", np.eye(4))
            missing = [name for name in expected if name not in found]
            assert not missing, f"{what}: no links {missing}"
            X_BR = np.linalg.inv(expected[root])
            for name in expected:
                worst = max(worst, apart(X_BR @ expected[name], np.linalg.inv(found[root]) @ found[name]))
        for pose in self.poses:
            found = links(self.urdf.values(self.by_name(pose["joints_rad"])))
            R_BC = checks.rotation(pose["camera_in_base"]["quaternion_xyzw"])
            X_TC = np.linalg.inv(self.X_BT) @ transform(R_BC, pose["camera_in_base"]["position_m"])
            worst = max(worst, apart(X_TC, np.linalg.inv(found["board"]) @ found[self.camera]))
        assert worst < tolerance, f"{what}: links are {worst} off"
        print(f"  {what}: {len(found)} links, off by {worst:.1e} at most")

    def models(self):
        model = pinocchio.buildModelFromUrdf(str(self.urdf_path))
        data = model.createData()
        self.hold("URDF, pinocchio", lambda values: pinocchio_links(model, data, values))
        pinocchio.buildGeomFromUrdf(model, str(self.urdf_path), pinocchio.GeometryType.COLLISION, package_dirs=[str(self.folder)])
        robot = yourdfpy.URDF.load(str(self.urdf_path), build_collision_scene_graph=True, load_collision_meshes=True)
        self.hold("URDF, yourdfpy", lambda values: self.by_yourdfpy(robot, values))
        drakes = {kind: Drake(path) for kind, path in (("URDF", self.urdf_path), ("MJCF", self.mjcf_path), ("SDF", self.sdf_path))}
        for kind, drake in drakes.items():
            self.hold(f"{kind}, Drake", drake.links)
            for name in self.joints:
                assert apart(drake.limits(name), self.urdf.limits(name)) < 1e-12, (kind, name)
        self.mujoco = MuJoCo(self.mjcf_path, self.urdf.links)
        self.hold("MJCF, MuJoCo", self.mujoco.links)
        stated = {link.get("name"): float(mass.get("value")) for link in self.urdf.root.iter("link") if (mass := link.find("inertial/mass")) is not None}
        by_sdf, by_mujoco = drakes["SDF"].masses(), self.mujoco.model
        for name in self.urdf.links:
            expected, name = stated.get(name, 1e-3), "world_link" if name == "world" else name
            assert abs(by_sdf[name] - expected) < 1e-12 and abs(by_mujoco.body(name).mass[0] - expected) < 1e-12, name
        print(f"  masses of {len(stated)} links, {sum(stated.values()):.3f} kg, in all three")

    def by_yourdfpy(self, robot, values):
        robot.update_cfg({name: values[name] for name in robot.actuated_joint_names})
        return {name: robot.get_transform(name, robot.base_link) for name in robot.link_map}

    def contacts(self):
        model = self.mujoco
        for pose in self.poses:
            key = model.model.key(f"pose {pose['id']}")
            model.data.qpos[:] = key.qpos
            by_key = model.placed()
            by_value = model.links(self.urdf.values(self.by_name(pose["joints_rad"])))
            assert max(apart(by_key[name], by_value[name]) for name in by_key) < 1e-15
        name = lambda link: link if link in self.urdf.links else f"{link}_link"
        pairs = self.asked("check", self.problem_path, *self.set)["self_collision"] or {"tested": []}
        tested = {tuple(sorted(map(name, pair["links"]))) for pair in pairs["tested"]}
        assert model.tested() == tested, model.tested() ^ tested
        for q in [*(pose["joints_rad"] for pose in self.poses), *self.turns]:
            model.links(self.urdf.values(self.by_name(q)))
            assert not model.touching(), model.touching()
        met = set()
        for q in self.random:
            model.links(self.urdf.values(self.by_name(q)))
            met |= model.touching()
        assert met <= tested, met - tested
        print(f"  MuJoCo tests {len(tested)} pairs, as calipose; none touches at {len(self.poses)} poses and {len(self.turns)} turns, {len(met)} do at random")

    def view(self):
        camera = checks.Camera(self.problem["camera"])
        if camera.model == checks.FISHEYE:
            assert self.mujoco.model.ncam == 0
            return print("  a fisheye: no camera in the models")
        corners = checks.corners(self.problem["target"])
        worst = 0.0
        for pose in self.poses:
            X_WT = self.mujoco.links(self.urdf.values(self.by_name(pose["joints_rad"])))["board"]
            found = self.mujoco.pixels(corners @ X_WT[:3, :3].T + X_WT[:3, 3])
            R, t = checks.board_in_camera(self.problem, pose)
            expected = cv2.projectPoints(corners, cv2.Rodrigues(R)[0], t, camera.K, None)[0].reshape(-1, 2)
            worst = max(worst, np.abs(found - expected).max())
        assert worst < 0.01, f"MuJoCo's pixels are {worst} off"
        sensor, = ET.parse(self.sdf_path).iter("sensor")
        link = next(link for link in ET.parse(self.sdf_path).iter("link") if link.find("sensor") is not None)
        assert link.get("name") == self.camera == sensor.findtext("camera/optical_frame_id") and sensor.get("type") == "camera"
        # Drake's rotations, so that the order of the angles is not ours.
        numbers = [float(word) for word in sensor.findtext("pose").split()]
        R_CS = RollPitchYaw(*numbers[3:]).ToRotationMatrix().matrix()
        assert apart(R_CS, [[0, -1, 0], [0, 0, -1], [1, 0, 0]]) < 1e-15 and not any(numbers[:3])
        said = {name: float(sensor.findtext(f"camera/lens/intrinsics/{name}")) for name in ("fx", "fy", "cx", "cy", "s")}
        # Gazebo counts pixels from the picture's corner.
        assert said == {"fx": camera.fx, "fy": camera.fy, "cx": camera.cx + 0.5, "cy": camera.cy + 0.5, "s": 0}
        assert [int(sensor.findtext(f"camera/image/{name}")) for name in ("width", "height")] == list(camera.size)
        if camera.model == "brown-conrady":
            distortion = [float(sensor.findtext(f"camera/distortion/{name}")) for name in ("k1", "k2", "p1", "p2", "k3")]
            assert distortion == camera.coefficients
        else:
            assert sensor.find("camera/distortion") is None
        print(f"  cameras: MuJoCo's pixels off by {worst:.1e} px at most; SDF's sensor as it should be")
        self.rendered(camera, corners)

    def rendered(self, camera, corners):
        """The corners that OpenCV finds in MuJoCo's pictures of the poses, against those of the pinhole."""
        target, model = self.problem["target"], self.mujoco.model
        if target.get("kind", "checkerboard") != "checkerboard":
            return
        width, height = camera.size
        model.vis.global_.offwidth, model.vis.global_.offheight = FINER * width, FINER * height
        try:
            renderer = mujoco.Renderer(model, FINER * height, FINER * width)
        except Exception as error:
            return print(f"  MuJoCo's pictures NOT checked: {type(error).__name__}: {error}")
        whole, found, off = 0, 0, []
        for pose in self.poses:
            R, t = checks.board_in_camera(self.problem, pose)
            expected = cv2.projectPoints(corners, cv2.Rodrigues(R)[0], t, camera.K, None)[0].reshape(-1, 2)
            # Without the lens some boards reach beyond the picture.
            if np.any(expected < BORDER_PX) or np.any(expected > np.array(camera.size) - 1 - BORDER_PX):
                continue
            whole += 1
            self.mujoco.links(self.urdf.values(self.by_name(pose["joints_rad"])))
            mujoco.mj_forward(model, self.mujoco.data)
            renderer.update_scene(self.mujoco.data, "camera")
            picture = cv2.cvtColor(renderer.render(), cv2.COLOR_RGB2GRAY)
            picture = cv2.resize(picture, camera.size, interpolation=cv2.INTER_AREA)
            size = target["columns"], target["rows"]
            seen, pixels = cv2.findChessboardCornersSB(picture, size, flags=cv2.CALIB_CB_ACCURACY | cv2.CALIB_CB_EXHAUSTIVE)
            if not seen:
                continue
            found += 1
            off += [np.linalg.norm(expected - pixel, axis=1).min() for pixel in pixels.reshape(-1, 2)]
        if whole < 2:
            return print(f"  MuJoCo's pictures NOT checked: without the lens {whole} of them have the whole board")
        assert found >= 2, f"OpenCV finds the board in {found} of {whole} pictures"
        # The detector errs at the far end of boards that are seen at a slant.
        middle, most = np.percentile(off, [50, 75])
        assert middle < RENDERED_PX and most < 3 * RENDERED_PX, (middle, most)
        print(f"  MuJoCo's pictures: OpenCV finds the board in {found} of {whole}, its corners {middle:.2f} px off, three of four less than {most:.2f}")

    def picture(self):
        """The corners that OpenCV finds in the picture, on the plate by the mesh's texture coordinates."""
        target = self.problem["target"]
        if target.get("kind", "checkerboard") != "checkerboard":
            return
        picture = cv2.imread(str(next(self.folder.glob("*.board.png"))), cv2.IMREAD_GRAYSCALE)
        size = target["columns"], target["rows"]
        found, pixels = cv2.findChessboardCornersSB(picture, size, flags=cv2.CALIB_CB_ACCURACY)
        assert found, "OpenCV finds no checkerboard"
        # Of the mesh, the front: the triangles that have a part of the picture.
        rows = [line.split() for line in next(self.folder.glob("*.board.obj")).read_text().splitlines()]
        vertices, places = [np.array([row[1:] for row in rows if row[0] == kind], dtype=float) for kind in ("v", "vt")]
        corners = [[tuple(map(int, word.split("/"))) for word in row[1:]] for row in rows if row[0] == "f"]
        front = [corner for face in corners if len({place for _, place in face}) == 3 for corner in face]
        on, at = vertices[[vertex - 1 for vertex, _ in front]], places[[place - 1 for _, place in front]]
        # Rows of pictures begin at the top, places at the bottom.
        at = at * [1, -1] + [0, 1]
        A = np.linalg.lstsq(np.column_stack([at, np.ones(len(at))]), on, rcond=None)[0]
        assert np.abs(np.column_stack([at, np.ones(len(at))]) @ A - on).max() < 1e-12
        uv = (pixels.reshape(-1, 2) + 0.5) / picture.shape[::-1]
        points = np.column_stack([uv, np.ones(len(uv))]) @ A
        expected = checks.corners(target)
        off = max(np.linalg.norm(expected - point, axis=1).min() for point in points)
        assert len(points) == len(expected) and off * 1e3 < CORNER_MM, f"corners of the picture are {off * 1e3} mm off"
        print(f"  the board's picture: {len(points)} corners, off by {off * 1e3:.3f} mm at most")

    def recording(self):
        tour, motion = self.plan["tour"], self.problem.get("motion", {})
        reader = make_reader(open(self.mcap_path, "rb"), decoder_factories=[DecoderFactory()], validate_crcs=True)
        assert reader.get_header().profile == "ros2"
        kinds, messages = get_typestore(Stores.ROS2_HUMBLE), {}
        for schema, channel, message, decoded in reader.iter_decoded_messages():
            assert schema.encoding == "ros2msg" and channel.message_encoding == "cdr"
            qos = parse_qos(yaml.safe_load(channel.metadata["offered_qos_profiles"]))
            latched = channel.topic in ("/tf_static", "/robot_description")
            assert len(qos) == 1 and qos[0].durability.name == ("TRANSIENT_LOCAL" if latched else "VOLATILE"), qos
            # By definitions that are not the file's.
            own = kinds.deserialize_cdr(message.data, schema.name)
            messages.setdefault(channel.topic, []).append((message.log_time / 1e9, decoded, own))
        count = sum(map(len, messages.values()))
        assert reader.get_summary().statistics.message_count == count
        described = messages["/robot_description"][0][1].data
        assert links_of(described) == self.urdf.links
        self.hold_stops(messages, tour)
        self.hold_frames(messages)
        self.hold_camera(messages["/camera_info"])
        states = messages["/joint_states"]
        print(f"  MCAP: {count} messages, {len(states)} joint states in {states[-1][0]:.1f} s, {len(messages['/camera_info'])} pictures")

    def hold_stops(self, messages, tour):
        states = messages["/joint_states"]
        times, places = np.array([time for time, _, _ in states]), np.array([decoded.position for _, decoded, _ in states])
        assert np.array_equal(places, [own.position for _, _, own in states]) and np.all(np.diff(times) > 0)
        for time, decoded, own in states:
            assert decoded.name == self.joints == own.name and decoded.velocity == [] == decoded.effort
            stamps = [message.header.stamp for message in (decoded, own)]
            assert all(abs(stamp.sec + stamp.nanosec / 1e9 - time) < 1e-9 for stamp in stamps)
        stops = [(time, own.data) for time, _, own in messages["/stops"]]
        of_id = {f"pose {pose['id']}": pose["joints_rad"] for pose in self.poses}
        turns = iter(self.turns)
        expected = []
        labels = [label for _, label in stops if label in of_id]
        assert labels == list(of_id)
        for at, label in stops:
            row, = np.flatnonzero(times == at)
            q = of_id[label] if label in of_id else tour["home_rad"] if label == "home" else next(turns)
            assert np.array_equal(places[row], q), label
            expected.append((at, np.array(q)))
        assert next(turns, None) is None
        dwell = tour["dwell_s"]
        moving = times[-1] - dwell * len(self.poses)
        assert abs(moving - tour["moving_s"]) < 1e-6, (moving, tour["moving_s"])
        # On the straight line between two stops, and monotonic.
        for (start, a), (end, b) in zip(expected, expected[1:]):
            inside = places[(times >= start) & (times <= end)]
            way = b - a
            share = (inside - a) @ way / (way @ way)
            assert np.abs(a + share[:, None] * way - inside).max() < 1e-12 and np.all(np.diff(share) >= -1e-12)
        speed = np.abs(np.diff(places, axis=0) / np.diff(times)[:, None]).max(axis=0)
        most = np.array([float(self.urdf.joints[name].find("limit").get("velocity")) for name in self.joints])
        assert np.all(speed <= most * (1 + 1e-6)), (speed, most)
        assert (speed / most).max() > 0.5, "nothing moves fast"

    def hold_frames(self, messages):
        matrix = lambda t: transform(
            checks.rotation([t.rotation.x, t.rotation.y, t.rotation.z, t.rotation.w]), [t.translation.x, t.translation.y, t.translation.z]
        )
        tree = lambda decoded: {t.child_frame_id: (t.header.frame_id, matrix(t.transform)) for t in decoded.transforms}
        fixed, = [tree(own) for _, _, own in messages["/tf_static"]]
        worst = 0.0
        for (time, _, own), (at, state, _) in zip(messages["/tf"], messages["/joint_states"], strict=True):
            assert time == at
            frames, poses = fixed | tree(own), {self.urdf.links[0]: np.eye(4)}
            assert set(frames) == set(self.urdf.links[1:])
            for name in self.urdf.links[1:]:
                parent, X = frames[name]
                poses[name] = poses[parent] @ X
            by_mujoco = self.mujoco.links(self.urdf.values(self.by_name(state.position)))
            worst = max(worst, *(apart(poses[name], by_mujoco[name]) for name in poses))
        assert worst < POSE, f"frames are {worst} off"

    def hold_camera(self, infos):
        camera = checks.Camera(self.problem["camera"])
        names = {"none": "plumb_bob", "brown-conrady": "plumb_bob", "rational": "rational_polynomial", checks.FISHEYE: "equidistant"}
        assert len(infos) == len(self.poses)
        for _, decoded, own in infos:
            assert np.array_equal(np.reshape(decoded.k, (3, 3)), camera.K) and np.array_equal(own.k, decoded.k)
            D = camera.D if camera.D.size else np.zeros(5)
            assert np.array_equal(decoded.d, D) and decoded.distortion_model == names[camera.model] and np.array_equal(own.d, D)
            assert [decoded.width, decoded.height] == list(camera.size) and decoded.header.frame_id == self.camera
            assert np.array_equal(np.reshape(decoded.p, (3, 4)), np.column_stack([camera.K, np.zeros(3)]))
            assert own.binning_x == own.binning_y == own.roi.width == own.roi.height == 0 and own.roi.do_rectify is False


def links_of(text):
    return [link.get("name") for link in ET.fromstring(text.encode()).iter("link")]


def main():
    pairs = list(zip(sys.argv[1::2], sys.argv[2::2]))
    assert pairs and len(sys.argv) % 2 == 1, __doc__
    wrong = []
    for plan, problem in pairs:
        print(problem)
        with tempfile.TemporaryDirectory() as folder:
            checked = Checked(plan, problem, Path(folder))
            for check in (checked.models, checked.contacts, checked.view, checked.picture, checked.recording):
                try:
                    check()
                except Exception as error:
                    wrong.append(f"{problem}, {check.__name__}: {type(error).__name__}: {error}")
                    if os.environ.get("TRACE"):
                        raise
    for fault in wrong:
        print(fault)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    run_with(*REQUIREMENTS)
    os.environ.setdefault("MUJOCO_GL", "egl")
    # Drake tells of all that it has no use for, the sensor for one.
    logging.getLogger("drake").setLevel(logging.ERROR)
    import cv2
    import mujoco
    import numpy as np
    import pinocchio
    import yaml
    import yourdfpy
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory
    from pydrake.math import RollPitchYaw
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import RevoluteJoint
    from rosbags.rosbag2.metadata import parse_qos
    from rosbags.typesys import Stores, get_typestore

    import map_error as checks

    checks.np, checks.cv2 = np, cv2
    main()
