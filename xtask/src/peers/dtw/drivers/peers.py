"""Packages of dynamic time warping: peers.py PEER RUNS JOB FILE.

Works once unmeasured, which compiles what is compiled late, then RUNS times; prints the cost and the
median of the process's CPU milliseconds. FILE holds numbers as f32; peers get them as f64. Costs are
sums of Euclidean local costs, and for the jobs of `ROOTS` roots of sums of their squares.
"""

import math
import statistics
import sys
import time

import numpy as np

ROOTS = ("multi-squared", "path-squared", "band-squared", "univariate", "pairwise", "pairwise-band")
FRAMES, SERIES, QUERY = 1000, 200, 128
RADIUS = {"band": 100, "band-squared": 100, "univariate": 100, "pairwise-band": 20, "windows": 6}


def read(job, path):
    """Two sequences, or all series, or query and series."""
    numbers = np.fromfile(path, "<f4").astype(float)
    if job == "windows":
        return numbers[:QUERY].copy(), numbers[QUERY:].copy()
    if job.startswith("pairwise"):
        return (numbers.reshape(SERIES, -1),)
    if job == "univariate":
        return tuple(numbers.reshape(2, FRAMES))
    return tuple(numbers.reshape(2, FRAMES, -1))


def cost(value):
    return {"cost": value}


def root(value):
    return {"cost": math.sqrt(value)}


def path_facts(path, value):
    return {"cost": value, "steps": len(path)}


def dtaidistance(job, radius, a, b=None):
    from dtaidistance import dtw, dtw_ndim

    window = None if radius is None else radius + 1
    if b is None:
        many = lambda: dtw.distance_matrix_fast(a, window=window, compact=True, parallel=False)
        return many, lambda distances: cost(np.sum(distances))
    inner = "squared euclidean" if job in ROOTS else "euclidean"
    if job.startswith("path"):

        def align():
            value, cells = dtw_ndim.warping_paths_fast(a, b, inner_dist=inner)
            return dtw.best_path(cells), value

        return align, lambda found: path_facts(*found)
    module = dtw if job == "univariate" else dtw_ndim
    return lambda: module.distance_fast(a, b, window=window, inner_dist=inner), cost


def tslearn(job, radius, a, b):
    from tslearn.metrics import dtw, dtw_path

    band = {} if radius is None else {"global_constraint": "sakoe_chiba", "sakoe_chiba_radius": radius}
    if job.startswith("path"):
        return lambda: dtw_path(a, b, **band), lambda found: path_facts(*found)
    return lambda: dtw(a, b, **band), cost


def aeon(job, radius, a, b=None):
    from aeon.distances import dtw_alignment_path, dtw_distance, dtw_pairwise_distance

    if b is None:
        window = None if radius is None else radius / a.shape[1]
        many = lambda: dtw_pairwise_distance(a[:, None, :], window=window)
        return many, lambda squares: cost(np.sqrt(squares[np.triu_indices(len(a), 1)]).sum())
    # Channels first.
    a, b = np.ascontiguousarray(a.T), np.ascontiguousarray(b.T)
    window = None if radius is None else radius / a.shape[-1]
    if job.startswith("path"):
        return lambda: dtw_alignment_path(a, b), lambda found: path_facts(found[0], math.sqrt(found[1]))
    return lambda: dtw_distance(a, b, window=window), root


def dtw_python(job, radius, a, b):
    import dtw

    band = {} if radius is None else {"window_type": "sakoechiba", "window_args": {"window_size": radius}}
    only = not job.startswith("path")
    work = lambda: dtw.dtw(a, b, step_pattern="symmetric1", distance_only=only, **band)
    if only:
        return work, lambda found: cost(found.distance)
    return work, lambda found: path_facts(found.index1, found.distance)


def librosa(job, radius, a, b):
    from librosa.sequence import dtw

    # Dimensions first.
    a, b = np.ascontiguousarray(a.T), np.ascontiguousarray(b.T)
    if job.startswith("path"):
        return lambda: dtw(a, b), lambda found: path_facts(found[1], found[0][-1, -1])
    return lambda: dtw(a, b, backtrack=False), lambda cells: cost(cells[-1, -1])


def pydtw(job, radius, a, b):
    from pydtw import dtw2d

    # What it calls the cost is a sum over the path of costs that are sums already.
    return lambda: dtw2d(a, b), lambda found: cost(found[0][-1, -1])


def wildboar(job, radius, a, b=None):
    from wildboar import distance

    if job == "windows":
        query, series = a, b
        band = {"r": (radius + 1) / len(query)}
        search = lambda: distance.pairwise_subsequence_distance(
            query, series, metric="scaled_dtw", metric_params=band, return_index=True
        )
        return search, lambda found: {"start": found[1], "cost": found[0]}
    # Its band is a cell narrower than asked for.
    band = {"r": 1.0 if radius is None else (radius + 1) / a.shape[-1]}
    if b is None:
        many = lambda: distance.pairwise_distance(a, metric="dtw", metric_params=band)
        return many, lambda distances: cost(distances[np.triu_indices(len(a), 1)].sum())
    return lambda: distance.pairwise_distance(a, b, metric="dtw", metric_params=band), cost


def tsdistances(job, radius, a, b=None):
    from tsdistances import dtw_distance

    band = 1.0 if radius is None else radius / a.shape[-1]
    if b is None:
        many = lambda: dtw_distance(a, None, band=band, par=False)
        return many, lambda squares: cost(np.sqrt(squares[np.triu_indices(len(a), 1)]).sum())
    return lambda: dtw_distance(a, b, band=band, par=False), root


def ucrdtw(job, radius, query, series):
    import _ucrdtw

    search = lambda: _ucrdtw.ucrdtw(series, query, radius / len(query), False)
    return search, lambda found: {"start": found[0], "cost": found[1]}


def main(peer, runs, job, path):
    work, facts = globals()[peer.replace("-", "_")](job, RADIUS.get(job), *read(job, path))
    stated = facts(work())
    times = []
    for _ in range(int(runs)):
        start = time.process_time()
        result = work()
        times.append((time.process_time() - start) * 1e3)
        del result
    stated["ms"] = statistics.median(times)
    print(*(f"{key}={float(value)!r}" for key, value in stated.items()))


main(*sys.argv[1:])
