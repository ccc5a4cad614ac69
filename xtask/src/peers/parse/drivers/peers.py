"""Packages that read motion capture: peers.py PEER RUNS FILE...

Reads once unmeasured, then RUNS times; prints facts about what was read and the median of the
process's CPU milliseconds.
"""

import statistics
import sys
import time


def pybvh(path):
    import numpy as np
    import pybvh

    def facts(bvh):
        total = bvh.root_pos.sum() + np.degrees(bvh.joint_angles).sum()
        return {"frames": bvh.frame_count, "sum": total}

    return lambda: pybvh.read_bvh_file(path), facts


def bvhio(path):
    import bvhio

    def facts(bvh):
        keys = bvh.Root.Keyframes
        return {"frames": len(keys), "root_sum": sum(sum(key.Position) for key in keys)}

    return lambda: bvhio.readAsBvh(path), facts


def pyacclaim(asf_path, amc_path):
    import pyacclaim

    asf = pyacclaim.loadASF(asf_path, verbose=False)

    def facts(frames):
        root = sum(frame["root"][:3].sum() for frame in frames)
        return {"frames": len(frames), "root_sum": root * asf["units"]["length"]}

    return lambda: pyacclaim.loadAMC(asf, amc_path), facts


def asfamc_parser(path):
    import asfamcparser

    def facts(amc):
        total = sum(sum(values) for frame in amc.frames for values in frame.values())
        return {"frames": amc.count, "sum": total}

    return lambda: asfamcparser.ParseAMC(path).amc, facts


def c3d(path):
    import c3d

    def read():
        with open(path, "rb") as file:
            return list(c3d.Reader(file).read_frames())

    def facts(frames):
        total = sum(points[:, :3].astype(float).sum() for _, points, _ in frames)
        return {"frames": len(frames), "sum": total}

    return read, facts


def ezc3d(path):
    import ezc3d

    def facts(file):
        points = file["data"]["points"]
        return {"frames": points.shape[2], "sum": points[:3].sum()}

    return lambda: ezc3d.c3d(path), facts


def main(peer, runs, *files):
    read, facts = globals()[peer.replace("-", "_")](*files)
    stated = facts(read())
    times = []
    for _ in range(int(runs)):
        start = time.process_time()
        result = read()
        times.append((time.process_time() - start) * 1e3)
        del result
    stated["ms"] = statistics.median(times)
    print(*(f"{key}={float(value)!r}" for key, value in stated.items()))


main(*sys.argv[1:])
