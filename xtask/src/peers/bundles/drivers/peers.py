"""Packages of Gaussian mixtures: peers.py PEER RUNS JOB FRAMES START.

Fits RUNS times from START; prints the mean log-likelihood of a frame, what the means come to, and the
median of the process's CPU milliseconds of an iteration: of MANY iterations less FEW. Both files are of
f64: frames of 12 dimensions; weights, variances and means.
"""

import statistics
import sys
import time
import warnings

import numpy as np
from sklearn.exceptions import ConvergenceWarning
from sklearn.mixture import GaussianMixture

DIMS, FEW, MANY = 12, 5, 25


def fit(frames, start, iterations):
    kappa = len(start) // (DIMS + 2)
    weights, variances, means = np.split(start, [kappa, 2 * kappa])
    mixture = GaussianMixture(
        kappa,
        covariance_type="spherical",
        tol=0,
        # Ours has a floor instead, which these frames do not reach.
        reg_covar=0,
        max_iter=iterations,
        # Overwritten by what follows; the others take longer.
        init_params="random_from_data",
        random_state=0,
        weights_init=weights,
        means_init=means.reshape(kappa, DIMS),
        precisions_init=1 / variances,
    )
    begin = time.process_time()
    mixture.fit(frames)
    return mixture, (time.process_time() - begin) * 1e3


def main(runs, frames, start):
    times = []
    for _ in range(runs):
        few, many = fit(frames, start, FEW), fit(frames, start, MANY)
        times.append((many[1] - few[1]) / (MANY - FEW))
    mixture = many[0]
    spread = float(mixture.weights_ @ (mixture.means_**2).sum(axis=1))
    likelihood = float(mixture.lower_bound_)
    print(f"log_likelihood={likelihood!r} spread={spread!r} ms={statistics.median(times)}")


_, peer, runs, job, frames, start = sys.argv
assert (peer, job) == ("scikit-learn", "em")
warnings.simplefilter("ignore", ConvergenceWarning)
main(int(runs), np.fromfile(frames, "<f8").reshape(-1, DIMS), np.fromfile(start, "<f8"))
