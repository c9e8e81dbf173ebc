#!/usr/bin/env python3
"""Writes timeline.json: a tour in time, and where its joints are at some times, from the textbook's three phases of a move.

Every move speeds up evenly from rest, cruises unless it is short, and slows down evenly to rest; the joint that takes longest for its share
limits speed and acceleration of all. Python's standard library alone; written with Python 3.11.
"""
import json
import math
import random
from pathlib import Path

rng = random.Random(7)
JOINTS = 3
DWELL = 0.8


def phases(start, end, speeds, accelerations):
    """Greatest speed and acceleration of the share of the way, each as much as every joint allows; the times of speeding up and of all."""
    ways = [abs(b - a) for a, b in zip(start, end)]
    moving = [(way, v, a) for way, v, a in zip(ways, speeds, accelerations) if way > 0]
    if not moving:
        return 0.0, 0.0, 0.0, 0.0
    speed = min(v / way for way, v, _ in moving)
    acceleration = min(a / way for way, _, a in moving)
    # What it would travel to speed up and slow down again.
    if speed * speed / acceleration > 1:
        speed = math.sqrt(acceleration)
    ramp = speed / acceleration
    cruise = (1 - speed * ramp) / speed
    return speed, acceleration, ramp, 2 * ramp + max(cruise, 0.0)


def share(t, speed, acceleration, ramp, duration):
    if t >= duration:
        return 1.0
    if t < ramp:
        return acceleration * t * t / 2
    if t < duration - ramp:
        return acceleration * ramp * ramp / 2 + speed * (t - ramp)
    left = duration - t
    return 1 - acceleration * left * left / 2


speeds = [rng.uniform(0.3, 2) for _ in range(JOINTS)]
accelerations = [rng.uniform(0.5, 3) for _ in range(JOINTS)]
configuration = lambda scale: [rng.uniform(-scale, scale) for _ in range(JOINTS)]
start = configuration(1)
# Far, near, round about, and nowhere at all.
targets = [[configuration(3)], None, [configuration(1), configuration(2)], "rest", [configuration(1)]]
time, q = 0.0, start
moves, pictures, at = [], [], []


def halt(pose):
    global time
    pictures.append({"id": pose, "start_s": time, "seconds": DWELL})
    at.append({"time_s": time + DWELL / 2, "joints": q})
    time += DWELL


halt(0)
for pose, corners in enumerate(targets, 1):
    if corners is None:
        corners = [[value + rng.uniform(-0.01, 0.01) for value in q]]
    elif corners == "rest":
        corners = [q]
    begun, legs = time, []
    for corner in corners:
        speed, acceleration, ramp, duration = phases(q, corner, speeds, accelerations)
        legs.append({"start_s": time, "seconds": duration, "ramp_s": ramp, "to": corner})
        for part in (0, 0.01, 0.1, 0.25, 0.4, 0.5, 0.61, 0.8, 0.95, 0.999, 1):
            s = share(part * duration, speed, acceleration, ramp, duration)
            at.append({"time_s": time + part * duration, "joints": [a + s * (b - a) for a, b in zip(q, corner)]})
        time += duration
        q = corner
    moves.append({"from": pose - 1, "to": pose, "start_s": begun, "seconds": time - begun, "legs": legs})
    halt(pose)
at += [{"time_s": -1.0, "joints": start}, {"time_s": time + 1, "joints": q}]
document = {
    "speeds": speeds,
    "accelerations": accelerations,
    "timeline": {"start": start, "moves": moves, "pictures": pictures, "end_s": time},
    "at": at,
}
Path(__file__).with_suffix(".json").write_text(json.dumps(document, indent=1) + "\n")
