#!/usr/bin/env python3
"""Writes timeline.json: tours in time, and where their joints are at some times, from the textbook's phases of a move.

Every move speeds up from rest, cruises unless it is short, and slows down to rest, evenly, or where jerk is limited with an acceleration
that grows and falls evenly; the joint that takes longest for its share limits speed, acceleration and jerk of all. The way is integrated
phase by phase. Python's standard library alone; written with Python 3.11.
"""
import json
import math
import random
from pathlib import Path

rng = random.Random(7)
JOINTS = 3
DWELL = 0.8


def speeding_up(speed, acceleration, jerk):
    """The times of growing, even and falling acceleration on the way to a speed."""
    if jerk == math.inf:
        return 0.0, speed / acceleration, 0.0
    if speed * jerk > acceleration**2:
        return acceleration / jerk, speed / acceleration - acceleration / jerk, acceleration / jerk
    return math.sqrt(speed / jerk), 0.0, math.sqrt(speed / jerk)


def phases(start, end, limits):
    """Of the share of the way: the time and the jerk of each of the seven phases of a move; jumps of the acceleration where it is unlimited."""
    ways = [abs(b - a) for a, b in zip(start, end)]
    if not any(ways):
        return 0.0, 0.0, []
    speed, acceleration, jerk = (min(most / way for way, most in zip(ways, each) if way > 0) for each in limits)
    # Bisection for the greatest speed from which it can stop in time: the way while speeding up is half of speed times time.
    if speed * sum(speeding_up(speed, acceleration, jerk)) > 1:
        low, high = 0.0, speed
        for _ in range(200):
            middle = (low + high) / 2
            low, high = (middle, high) if middle * sum(speeding_up(middle, acceleration, jerk)) <= 1 else (low, middle)
        speed = low
    up = speeding_up(speed, acceleration, jerk)
    cruise = max(1 / speed - sum(up), 0.0)
    if jerk == math.inf:
        pieces = [(up[1], acceleration, 0), (cruise, 0, 0), (up[1], -acceleration, 0)]
    else:
        peak = jerk * up[0]
        pieces = [(up[0], 0, jerk), (up[1], peak, 0), (up[2], peak, -jerk), (cruise, 0, 0)]
        pieces += [(up[0], 0, -jerk), (up[1], -peak, 0), (up[2], -peak, jerk)]
    return sum(up), up[0], pieces


def share(t, pieces):
    """The share of the way that is done at a time."""
    way = speed = 0.0
    for duration, acceleration, jerk in pieces:
        spent = min(t, duration)
        way += speed * spent + acceleration * spent**2 / 2 + jerk * spent**3 / 6
        speed += acceleration * spent + jerk * spent**2 / 2
        t -= spent
    return way


def tour(jerks):
    """A tour by joints with these limits of jerk, infinite where there is none."""
    speeds = [rng.uniform(0.3, 2) for _ in range(JOINTS)]
    accelerations = [rng.uniform(0.5, 3) for _ in range(JOINTS)]
    configuration = lambda scale: [rng.uniform(-scale, scale) for _ in range(JOINTS)]
    start = configuration(1)
    # Far, near, round about, and nowhere at all.
    targets = [[configuration(3)], None, [configuration(1), configuration(2)], "rest", [configuration(1)]]
    time, q = 0.0, start
    moves, pictures, at = [], [], []

    def halt(pose):
        nonlocal time
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
            ramp, ease, pieces = phases(q, corner, (speeds, accelerations, jerks))
            duration = sum(piece[0] for piece in pieces)
            leg = {"start_s": time, "seconds": duration, "ramp_s": ramp, "to": corner}
            legs.append(leg | ({"ease_s": ease} if ease else {}))
            for part in (0, 0.01, 0.1, 0.25, 0.4, 0.5, 0.61, 0.8, 0.95, 0.999, 1):
                s = share(part * duration, pieces)
                at.append({"time_s": time + part * duration, "joints": [a + s * (b - a) for a, b in zip(q, corner)]})
            time += duration
            q = corner
        moves.append({"from": pose - 1, "to": pose, "start_s": begun, "seconds": time - begun, "legs": legs})
        halt(pose)
    at += [{"time_s": -1.0, "joints": start}, {"time_s": time + 1, "joints": q}]
    return {
        "speeds": speeds,
        "accelerations": accelerations,
        "jerks": [None if jerk == math.inf else jerk for jerk in jerks],
        "timeline": {"start": start, "moves": moves, "pictures": pictures, "end_s": time},
        "at": at,
    }


tours = [tour([math.inf] * JOINTS), tour([5.0, math.inf, 2.0]), tour([0.4, 60.0, 60.0])]
Path(__file__).with_suffix(".json").write_text(json.dumps(tours, indent=1) + "\n")
