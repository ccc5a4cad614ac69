"""Packages of subsequence alignment: peers.py PEER RUNS JOB FILE.

Works once unmeasured, which compiles what is compiled late, then RUNS times; prints the facts of the
distance curve, in disagreements, and the median of the process's CPU milliseconds. FILE holds the words
of a template of 100 columns and then those of the clip, as u64.
"""

import statistics
import sys
import time

import numpy as np

FEATURES, COLUMNS = 39, 100
STEPS = np.array([[1, 1], [1, 2], [2, 1]])
WEIGHTS = {"unit": np.array([1, 1, 1]), "advance": np.array([1, 1, 2])}


def read(path):
    """Template and clip as matrices, features first."""
    words = np.fromfile(path, "<u8")
    bits = (words[None, :] >> np.arange(FEATURES, dtype=np.uint64)[:, None]) & 1
    bits = np.asfortranarray(bits.astype(float))
    return bits[:, :COLUMNS].copy(), bits[:, COLUMNS:].copy()


def libfmp(job, template, clip):
    from libfmp.c3 import compute_cost_matrix
    from libfmp.c7 import compute_accumulated_cost_matrix_subsequence_dtw_21

    assert job == "unit"

    def curve():
        costs = compute_cost_matrix(template, clip, metric="cityblock")
        return compute_accumulated_cost_matrix_subsequence_dtw_21(costs)[-1]

    return curve


def librosa(job, template, clip):
    from librosa.sequence import dtw

    def curve():
        return dtw(
            template,
            clip,
            metric="cityblock",
            step_sizes_sigma=STEPS,
            weights_mul=WEIGHTS[job],
            subseq=True,
            backtrack=False,
        )[-1]

    return curve


def main(peer, runs, job, path):
    work = globals()[peer](job, *read(path))
    costs = work()
    reached = np.isfinite(costs)
    stated = {"least": costs[reached].min(), "end": np.argmin(costs), "sum": costs[reached].sum()}
    times = []
    for _ in range(int(runs)):
        start = time.process_time()
        result = work()
        times.append((time.process_time() - start) * 1e3)
        del result
    stated["ms"] = statistics.median(times)
    print(*(f"{key}={float(value)!r}" for key, value in stated.items()))


main(*sys.argv[1:])
