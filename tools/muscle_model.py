#!/usr/bin/env python3
"""Samples the muscles of the arm from MyoArm and writes them as smooth functions of the posture.

    python3 -m venv v && v/bin/pip install myo-sim==0.2.4 numpy scipy
    v/bin/python tools/muscle_model.py

writes assets/human/muscles.toml, which docs/method.md#416-muscles explains, and tests/data/muscle_arms.csv, moment arms
and strengths of MyoArm itself at random postures. MyoArm: Caggiano et al. 2022, MyoSuite; Python package myo-sim,
Apache-2.0. The 13 muscles inside the hand cross no joint of the arm and are left out.
"""

import argparse
import itertools
import math
import pathlib
import warnings

warnings.filterwarnings("ignore")

import mujoco  # noqa: E402
import myo_sim  # noqa: E402
import numpy as np  # noqa: E402
from scipy.optimize import least_squares  # noqa: E402
from scipy.spatial.transform import Rotation  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent

# MyoArm's coordinates; scapula and clavicle follow by its couplings.
COORDINATES = [
    "elv_angle_r", "shoulder_elv_r", "shoulder_rot_r", "elbow_flexion_r", "pro_sup_r", "deviation_r", "flexion_r",
]
# A fist around a handle, rad.
FINGERS_RAD, THUMB_RAD = 0.9, -0.4
# Axes of MyoArm from those of V: x_V forward is -y, y_V left is x.
R_MV = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])

# Degrees of the polynomials.
MAP_DEGREE, SHOULDER_DEGREE, ELBOW_DEGREE, WRIST_DEGREE = 5, 8, 7, 5
# Ranges of the four angles beyond the shoulder, rad: those of docs/method.md#41-arm-kinematics.
BEYOND_RAD = np.radians([[0, 145], [-90, 90], [-70, 75], [-20, 40]])
# No moment arm is longer, m; what is longer in a difference of lengths is a jump.
JUMP_M = 0.15
# Shares of error in a length (m) and in its derivatives (m/rad) in the fit of the shoulder.
LENGTH_WEIGHT = 0.3

FULL_NAMES = {
    "DELT1": "anterior deltoid", "DELT2": "middle deltoid", "DELT3": "posterior deltoid", "SUPSP": "supraspinatus",
    "INFSP": "infraspinatus", "SUBSC": "subscapularis", "TMIN": "teres minor", "TMAJ": "teres major",
    "PECM1": "clavicular pectoralis major", "PECM2": "sternal pectoralis major", "PECM3": "costal pectoralis major",
    "LAT1": "thoracic latissimus dorsi", "LAT2": "lumbar latissimus dorsi", "LAT3": "iliac latissimus dorsi",
    "CORB": "coracobrachialis", "TRIlong": "long head of triceps", "TRIlat": "lateral head of triceps",
    "TRImed": "medial head of triceps", "ANC": "anconeus", "SUP": "supinator", "BIClong": "long head of biceps",
    "BICshort": "short head of biceps", "BRA": "brachialis", "BRD": "brachioradialis",
    "ECRL": "extensor carpi radialis longus", "ECRB": "extensor carpi radialis brevis", "ECU": "extensor carpi ulnaris",
    "FCR": "flexor carpi radialis", "FCU": "flexor carpi ulnaris", "PL": "palmaris longus", "PT": "pronator teres",
    "PQ": "pronator quadratus", "EDM": "extensor digiti minimi", "EIP": "extensor indicis",
    "EPL": "extensor pollicis longus", "EPB": "extensor pollicis brevis", "FPL": "flexor pollicis longus",
    "APL": "abductor pollicis longus",
}
FINGERS = {"2": "index finger", "3": "middle finger", "4": "ring finger", "5": "little finger"}
for short, full in (("FDS", "flexor digitorum superficialis"), ("FDP", "flexor digitorum profundus"),
                    ("EDC", "extensor digitorum")):
    FULL_NAMES.update({short + digit: f"{full} of the {finger}" for digit, finger in FINGERS.items()})


# The part of the arm at which each muscle is drawn; docs/method.md#416-muscles.
REGIONS = {
    "chest": "PECM1 PECM2 PECM3",
    "back": "LAT1 LAT2 LAT3 TMAJ",
    "rotator cuff": "SUPSP INFSP SUBSC TMIN",
    "front of the shoulder": "DELT1 CORB",
    "side of the shoulder": "DELT2",
    "back of the shoulder": "DELT3",
    "front of the upper arm": "BIClong BICshort BRA",
    "back of the upper arm": "TRIlong TRIlat TRImed ANC",
    "thumb side of the forearm": "BRD ECRL ECRB",
    "palm side of the forearm": "PT PQ FCR FCU PL FPL FDS2 FDS3 FDS4 FDS5 FDP2 FDP3 FDP4 FDP5",
    "back of the forearm": "SUP ECU EDC2 EDC3 EDC4 EDC5 EDM EIP EPL EPB APL",
}
REGION_OF = {name: region for region, names in REGIONS.items() for name in names.split()}


def turn(axis, angle):
    return Rotation.from_rotvec(np.eye(3)["xyz".index(axis)] * angle).as_matrix()


def segments(q):
    """Orientations of upper arm, forearm (turned by pronation) and hand in V, docs/method.md#41-arm-kinematics."""
    upper = turn("y", -q[0]) @ turn("x", -q[1]) @ turn("z", q[2])
    fore = upper @ turn("y", -q[3]) @ turn("z", q[4])
    return upper, fore, fore @ turn("x", q[5]) @ turn("y", q[6])


class Myo:
    """MyoArm, in its own coordinates p."""

    def __init__(self):
        self.model = model = myo_sim.load_model("myoarm_r")
        self.data = mujoco.MjData(model)
        self.joints = [model.joint(name).id for name in COORDINATES]
        self.addresses = [model.jnt_qposadr[joint] for joint in self.joints]
        self.couplings = [
            (model.jnt_qposadr[model.eq_obj1id[i]], model.jnt_qposadr[model.eq_obj2id[i]], model.eq_data[i][:5].copy())
            for i in range(model.neq) if model.eq_type[i] == mujoco.mjtEq.mjEQ_JOINT
        ]
        self.rest = model.qpos0.copy()
        for joint in range(model.njnt):
            name = model.joint(joint).name
            if name.startswith(("mcp", "pm", "md")) and "flexion" in name:
                self.rest[model.jnt_qposadr[joint]] = FINGERS_RAD
            if name in ("cmc_flexion", "mp_flexion_r", "ip_flexion_r"):
                self.rest[model.jnt_qposadr[joint]] = THUMB_RAD
        self.names = [model.actuator(i).name for i in range(model.nu)]
        self.tendons = model.actuator_trnid[:, 0]
        # SUPSP's gain row is that of SUP; its bias row is its own.
        self.parameters = model.actuator_biasprm.copy()
        own = np.isclose(model.actuator_gainprm[:, :9], model.actuator_biasprm[:, :9]).all(1)
        assert [self.names[i] for i in np.flatnonzero(~own)] == ["SUPSP"]
        self.force_n = self.parameters[:, 2]
        low, high = self.parameters[:, 0], self.parameters[:, 1]
        ranges = model.actuator_lengthrange
        # Length of the tendon per unit of normalised fibre length, and its length where that would be zero.
        self.scale_m = (ranges[:, 1] - ranges[:, 0]) / (high - low)
        self.slack_m = ranges[:, 0] - low * self.scale_m
        self.place(np.zeros(7))
        self.frames_l = self.segment_frames()

    def place(self, p, tendons=False):
        qpos = self.rest.copy()
        qpos[self.addresses] = p
        for dependent, driver, c in self.couplings:
            qpos[dependent] = np.polyval(c[::-1], qpos[driver])
        self.data.qpos[:] = qpos
        mujoco.mj_kinematics(self.model, self.data)
        if tendons:
            mujoco.mj_comPos(self.model, self.data)
            mujoco.mj_tendon(self.model, self.data)

    def body(self, name):
        return self.data.xmat[self.model.body(name).id].reshape(3, 3)

    def axis(self, name):
        return self.data.xaxis[self.model.joint(name).id].copy()

    def segment_frames(self):
        """The three segments' frames in their bodies, from the joints at zero: upper arm z from elbow to shoulder, y against the
        elbow's axis; forearm z from wrist to elbow, y against the axis of deviation; hand x along the axis of flexion, z up."""
        point = lambda name: self.data.xpos[self.model.body(name).id].copy()
        shoulder, elbow, wrist = point("humerus_r"), point("ulna_r"), point("lunate_r")

        def frame(z, y):
            z = z / np.linalg.norm(z)
            y = y - z * (y @ z)
            y = y / np.linalg.norm(y)
            return np.column_stack([np.cross(y, z), y, z])

        upper = frame(shoulder - elbow, -self.axis("elbow_flexion_r"))
        fore = frame(elbow - wrist, -self.axis("deviation_r"))
        x = self.axis("flexion_r")
        up = np.array([0.0, 0.0, 1.0])
        z = up - x * (up @ x)
        hand = frame(z, np.cross(z, x))
        bodies = zip(("humerus_r", "radius_r", "lunate_r"), (upper, fore, hand))
        return [self.body(name).T @ frame for name, frame in bodies]

    def segments(self, p):
        """Orientations of upper arm, forearm and hand in V."""
        self.place(p)
        bodies = zip(("humerus_r", "radius_r", "lunate_r"), self.frames_l)
        return [R_MV.T @ self.body(name) @ frame for name, frame in bodies]

    def lengths(self, p):
        self.place(p, tendons=True)
        return self.data.ten_length[self.tendons].copy()

    def arms(self, p, step=1e-4):
        """dL/dp, m/rad."""
        return np.column_stack([(self.lengths(p + step * e) - self.lengths(p - step * e)) / (2 * step) for e in np.eye(7)])

    def axes_v(self, p):
        """Axes in V of a turn about each coordinate beyond the shoulder."""
        self.place(p)
        return [R_MV.T @ self.axis(name) for name in COORDINATES[3:]]

    def shoulder_rates(self, p, step=1e-5):
        """Angular velocity of the upper arm in V by the three coordinates of the shoulder."""
        rates = np.zeros((3, 3))
        for k in range(3):
            e = np.zeros(7)
            e[k] = step
            back, forth = self.segments(p - e)[0], self.segments(p + e)[0]
            rates[:, k] = Rotation.from_matrix(forth @ back.T).as_rotvec() / (2 * step)
        return rates

    def at_upper_arm(self, r_vu):
        """The coordinates of the shoulder, with a positive elevation, for an orientation of the upper arm."""
        theta = math.acos(np.clip(r_vu[2, 2], -1, 1))
        residual = lambda x: (self.segments(np.array([*x, 1.2, 0, 0, 0]))[0] - r_vu).ravel()
        for start in itertools.product(np.arange(-3, 3.2, 0.7), (-2, 0, 2)):
            found = least_squares(residual, [start[0], max(theta, 0.05), start[1]], method="lm", xtol=1e-13, ftol=1e-13)
            if found.cost < 1e-18 and 0 <= found.x[1] <= math.pi:
                return found.x
        return None

    def matched(self, q):
        """All coordinates for angles of ours: least squares over the nine axes of the three segments, followed from angles of the
        elbow and the wrist that leave no choice between minima."""
        p = np.array([*self.at_upper_arm(segments(q)[0]), 0.8, 0, 0, 0])
        neutral = np.array([*q[:3], 0.8, 0, 0, 0])
        for share in np.linspace(0.25, 1, 4):
            wanted = segments(neutral + share * (q - neutral))
            residual = lambda p: np.concatenate([(a - b).ravel() for a, b in zip(self.segments(p), wanted)])
            p = least_squares(residual, p, method="lm", xtol=1e-13, ftol=1e-13).x
        return p


def force_length(x, low, high):
    """MuJoCo's active force over normalised fibre length: pieces of parabolas, 1 at length 1."""
    left, right = (low + 1) / 2, (1 + high) / 2
    if x < low or x > high:
        return 0.0
    if x <= left:
        return 0.5 * ((x - low) / (left - low)) ** 2
    if x <= 1:
        return 1 - 0.5 * ((1 - x) / (1 - left)) ** 2
    if x <= right:
        return 1 - 0.5 * ((x - 1) / (right - 1)) ** 2
    return 0.5 * ((high - x) / (high - right)) ** 2


def exponents(variables, degree, homogeneous=False):
    powers = [e for e in itertools.product(range(degree + 1), repeat=variables) if sum(e) <= degree]
    return np.array([e for e in powers if sum(e) == degree or not homogeneous])


def monomials(x, powers):
    """Values (n x k) and derivatives (list of n x k) of monomials at points (n x variables)."""
    highest = powers.max()
    table = np.array([x**k for k in range(highest + 1)])
    factors = [table[powers[:, v], :, v].T for v in range(x.shape[1])]
    values = np.prod(factors, axis=0)
    slopes = []
    for v in range(x.shape[1]):
        lowered = powers[:, v] * table[np.maximum(powers[:, v] - 1, 0), :, v].T
        slopes.append(lowered * np.prod([f for w, f in enumerate(factors) if w != v], axis=0))
    return values, slopes


def solve(columns, target, ridge):
    scale = np.linalg.norm(columns, axis=0)
    a = columns / scale
    return (np.linalg.solve(a.T @ a + ridge * np.eye(len(scale)), a.T @ target).T / scale).T


def quaternions(r):
    q = Rotation.from_matrix(r).as_quat(scalar_first=True)
    return q * np.where(q[:, :1] < 0, -1, 1)


def by_rotation(q, slopes):
    """Derivatives by a small rotation of the upper arm about the axes of V, from those by the quaternion's components."""
    w, x, y, z = q.T
    rates = 0.5 * np.array([[-x, -y, -z], [w, z, -y], [-z, w, x], [y, -x, w]])
    return [sum(slopes[c] * rates[c, k][:, None] for c in range(4)) for k in range(3)]


def draw_upper_arm(rng, is_low):
    """A random orientation of the upper arm: up to 70 degrees of elevation, or the whole box of the shoulder's angles."""
    if is_low:
        theta, azimuth = math.acos(rng.uniform(math.cos(math.radians(70)), 1)), rng.uniform(-math.pi, math.pi)
        twist = rng.uniform(-1.6, 1.6)
        axis = np.array([math.sin(azimuth), -math.cos(azimuth), 0.0])
        return Rotation.from_rotvec(axis * theta).as_matrix() @ turn("z", twist)
    q = [rng.uniform(-1.05, 3.14), rng.uniform(-0.52, 2.09), rng.uniform(-1.57, 1.57), 0, 0, 0, 0]
    return segments(q)[0]


def sample_shoulder(myo, rng, count):
    orientations, lengths, slopes = [], [], []
    for k in range(count):
        r_vu = draw_upper_arm(rng, k % 2 == 0)
        x = myo.at_upper_arm(r_vu)
        if x is None:
            continue
        p = np.array([*x, 1.2, 0, 0, 0])
        rates = myo.shoulder_rates(p)
        if np.linalg.cond(rates) > 50:
            continue  # Hanging: elevation angle and rotation turn about one axis.
        orientations.append(r_vu)
        lengths.append(myo.lengths(p))
        slopes.append(myo.arms(p)[:, :3] @ np.linalg.inv(rates))
    return np.array(orientations), np.array(lengths), np.array(slopes)


def draw_beyond(rng):
    low, high = BEYOND_RAD.T
    return rng.uniform(low - 0.05 * (high - low), high + 0.05 * (high - low))


def sample_beyond(myo, rng, count):
    """The angles q4..q7; the correction of the upper arm, `tan(angle / 2)` times its axis in U, with the coordinates p4..p7;
    lengths; slopes."""
    angles, outputs, lengths, slopes = [], [], [], []
    for _ in range(count):
        q = np.array([0.6, 0.3, 0.1, *draw_beyond(rng)])
        p = myo.matched(q)
        correction = Rotation.from_matrix(segments(q)[0].T @ myo.segments(p)[0]).as_quat(scalar_first=True)
        angles.append(q[3:])
        outputs.append([*(correction[1:] / correction[0]), *p[3:]])
        lengths.append(myo.lengths(p))
        slopes.append(myo.arms(p)[:, 3:])
    return tuple(np.array(values) for values in (angles, outputs, lengths, slopes))


def numbers(values):
    return "[" + ", ".join(f"{v:.6g}" for v in values) + "]"


def fit_beyond(p, lengths, slopes, powers):
    """Least squares on the four slopes (m/rad) and, a tenth as strong, on the length (m)."""
    values, rates = monomials(p, powers)
    columns = np.vstack([0.1 * values, *rates])
    target = np.concatenate([0.1 * lengths, *[slopes[:, k] for k in range(4)]])
    return solve(columns, target, 1e-10)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--samples", type=int, default=16000)
    parser.add_argument("--asset", default=ROOT / "assets/human/muscles.toml")
    parser.add_argument("--reference", default=ROOT / "tests/data/muscle_arms.csv")
    arguments = parser.parse_args()
    rng = np.random.default_rng(1)
    myo = Myo()
    r_vu, shoulder_m, shoulder_slopes = sample_shoulder(myo, rng, arguments.samples)
    angles, outputs, beyond_m, beyond_slopes = sample_beyond(myo, rng, arguments.samples // 2)
    write(arguments, myo, (r_vu, shoulder_m, shoulder_slopes), (angles, outputs, beyond_m, beyond_slopes))
    write_reference(arguments.reference, myo, rng)


def write(arguments, myo, shoulder, beyond):
    r_vu, shoulder_m, shoulder_slopes = shoulder
    angles, outputs, beyond_m, beyond_slopes = beyond
    map_powers = exponents(4, MAP_DEGREE)
    map_values, _ = monomials(angles, map_powers)
    coordinate_map = solve(map_values, outputs, 1e-12)
    map_error = np.abs(map_values @ coordinate_map - outputs)
    print("error of the angles, rad (the first three half as large): rms", np.sqrt((map_error**2).mean(0)).round(4), "max",
          map_error.max(0).round(3))
    # E(p4, p5) + W(p5, p6, p7) is exact in MyoArm: no muscle has both an elbow's and a wrist's part in one term.
    elbow, wrist = exponents(2, ELBOW_DEGREE), exponents(3, WRIST_DEGREE)
    beyond_powers = {(a, b, 0, 0) for a, b in elbow} | {(0, *e) for e in wrist}
    beyond_powers = np.array(sorted(beyond_powers - {(0, 0, 0, 0)}, key=lambda e: (sum(e), e)))
    shoulder_powers = exponents(4, SHOULDER_DEGREE, homogeneous=True)
    quats = quaternions(r_vu)
    values, component_slopes = monomials(quats, shoulder_powers)
    rates = by_rotation(quats, component_slopes)
    columns = np.vstack([LENGTH_WEIGHT * values, *rates])
    p_reference = np.array([[1.2, 0.0, 0.0, 0.0]])
    used_shoulder = np.abs(shoulder_slopes).max((0, 2)) > 1e-6
    used_beyond = np.abs(beyond_slopes).max((0, 2)) > 1e-6
    p = outputs[:, 3:]
    lines = [HEADER, "[angles]", "# One row for each monomial: exponents of q4, q5, q6, q7 (rad), then the seven outputs."]
    lines.append("rows = [")
    for e, c in zip(map_powers, coordinate_map):
        lines.append(f"  {numbers([*e, *c])},")
    lines += ["]", "", "[axes]"]
    myo.place(np.zeros(7))
    for name, coordinate in zip(("elbow", "pronation", "deviation", "flexion"), COORDINATES[3:]):
        upper = R_MV.T @ myo.body("humerus_r") @ myo.frames_l[0]
        lines.append(f"{name} = {numbers(upper.T @ (R_MV.T @ myo.axis(coordinate)))}")
    lines += ["", "[lengths]"]
    lines.append(f"shoulder_degree = {SHOULDER_DEGREE}")
    lines.append("beyond_powers = " + "[" + ", ".join(str(list(map(int, e))) for e in beyond_powers) + "]")
    for i, name in enumerate(myo.names):
        if not (used_shoulder[i] or used_beyond[i]):
            continue
        low, high = myo.parameters[i, 4:6]
        lines += ["", "[[muscles]]", f'name = "{FULL_NAMES[name]}" # {name}']
        lines.append(f'region = "{REGION_OF[name]}"')
        lines.append(f"force_n = {myo.force_n[i]:.6g}")
        lines.append(f"fibre_m = {myo.scale_m[i]:.6g}")
        lines.append(f"fibre_range = {numbers([low, high])}")
        constant, errors = 0.0, []
        if used_shoulder[i]:
            # A tendon that jumps over a surface that it wraps around has no slope there.
            kept = np.linalg.norm(shoulder_slopes[:, i], axis=1) < JUMP_M
            target = np.concatenate(
                [LENGTH_WEIGHT * shoulder_m[kept, i], *[shoulder_slopes[kept, i, k] for k in range(3)]])
            c = solve(columns[np.tile(kept, 4)], target, 1e-9)
            error = np.array([rates[k][kept] @ c - shoulder_slopes[kept, i, k] for k in range(3)])
            errors.append(np.sqrt((error**2).sum(0).mean()))
            lines.append(f"shoulder_mm = {numbers(1e3 * c)}")
        if used_beyond[i]:
            powers, kept = beyond_powers, np.abs(beyond_slopes[:, i]).max(1) < JUMP_M
            lengths, slopes = beyond_m[kept, i], beyond_slopes[kept, i]
            with_constant = np.vstack([powers, [0, 0, 0, 0]])
            c = fit_beyond(p[kept], lengths - lengths.mean(), slopes, with_constant)[:-1]
            v, s = monomials(p[kept], powers)
            errors.append(np.sqrt(sum((s[k] @ c - slopes[:, k]) ** 2 for k in range(4)).mean()))
            lines.append(f"beyond_mm = {numbers(1e3 * c)}")
            if used_shoulder[i]:
                # The shoulder's samples were taken at one posture of the elbow.
                constant = -(monomials(p_reference, powers)[0] @ c)[0]
            else:
                constant = (lengths - v @ c).mean()
        lines.append(f"constant_mm = {1e3 * (constant - myo.slack_m[i]):.6g}")
        lines.append(f"arm_error_mm = {1e3 * max(errors):.2g}")
        print(f"{name:9s} force {myo.force_n[i]:7.1f} N, error of the moment arm {1e3 * max(errors):.2f} mm")
    pathlib.Path(arguments.asset).write_text("\n".join(lines) + "\n")


def write_reference(path, myo, rng, count=120):
    """Strength of each muscle in the moments of docs/method.md#416-muscles, from MyoArm itself."""
    used = [i for i, name in enumerate(myo.names) if name in FULL_NAMES]
    lines = ["# Moments of each muscle at full activation in MyoArm (myo-sim 0.2.4), by tools/muscle_model.py, N m: about the",
             "# shoulder in x_V, y_V, z_V, then along the axes of elbow, pronation, deviation and flexion.",
             "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,q7_rad,muscle,sx_nm,sy_nm,sz_nm,elbow_nm,pronation_nm,deviation_nm,flexion_nm"]
    while count:
        q = np.array([rng.uniform(-0.5, 1.2), rng.uniform(-0.1, 1.0), rng.uniform(-0.8, 0.8), *rng.uniform(
            [0.5, -1.2, -0.8, -0.2], [2.2, 1.2, 0.8, 0.5])])
        p = myo.matched(q)
        rates = myo.shoulder_rates(p)
        if not 0.15 < p[1] < math.pi or np.linalg.cond(rates) > 20:
            continue
        lengths, arms = myo.lengths(p), myo.arms(p)
        for i in used:
            x = (lengths[i] - myo.slack_m[i]) / myo.scale_m[i]
            force = myo.force_n[i] * force_length(x, *myo.parameters[i, 4:6])
            moments = -force * np.array([*(arms[i, :3] @ np.linalg.inv(rates)), *arms[i, 3:]])
            lines.append(",".join([*(f"{v:.6f}" for v in q), FULL_NAMES[myo.names[i]], *(f"{v:.4f}" for v in moments)]))
        count -= 1
    pathlib.Path(path).write_text("\n".join(lines) + "\n")


HEADER = """\
# Muscles of the right arm as smooth functions of its posture, docs/method.md#416-muscles. Written by
# tools/muscle_model.py from MyoArm (Caggiano, Wang, Durandau, Sartori and Kumar 2022, "MyoSuite: a contact-rich simulation
# suite for musculoskeletal motor control"; Python package myo-sim 0.2.4, Apache-2.0, after Saul et al. 2015).
# Attribution: the authors of MyoSuite (Vittorio Caggiano, Huiyi Wang and others); the licence is LICENSE-myo_sim beside this file.
# The figures are fitted to that model: numbers of polynomials and of muscles, no geometry.
"""

if __name__ == "__main__":
    main()
