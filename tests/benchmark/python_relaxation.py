"""Choosing K of N poses in Python: cvxopt's relaxation, as FIGAROH solves it, beside posewise.

    python_relaxation.py [CANDIDATES] [POSES]

Both maximise log det of the information, FIGAROH its root, for the same Jacobians in one run on one
core. cvxopt's primal form (maximum-volume design, weights that sum to one) is solved by its cpl
with analytic derivatives; its weights do not choose an exact number of poses, the largest K are
taken, as FIGAROH does. Needs python3-cvxopt and the package posewise on the path.
"""

import os
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import cvxopt
import cvxopt.solvers
import numpy as np
import posewise as pw


def relaxation_by_cvxopt(J, k):
    """Weights from 0 to 1 that sum to k, maximising log det of sum_i w_i J_i^T J_i."""
    count = len(J)
    informations = np.einsum("nri,nrj->nij", J, J)

    def objective(w=None, z=None):
        if w is None:
            return 0, cvxopt.matrix(k / count, (count, 1))
        M = np.tensordot(np.array(w).ravel(), informations, 1)
        sign, value = np.linalg.slogdet(M)
        if sign <= 0:
            return None
        inverse = np.linalg.inv(M)
        slope = -np.einsum("ij,nji->n", inverse, informations)
        Df = cvxopt.matrix(slope.reshape(1, -1))
        if z is None:
            return cvxopt.matrix(-value), Df
        products = np.einsum("ij,njk->nik", inverse, informations).reshape(count, -1)
        transposed = np.einsum("ij,njk->nki", inverse, informations).reshape(count, -1)
        return cvxopt.matrix(-value), Df, cvxopt.matrix(z[0] * products @ transposed.T)

    bounds = cvxopt.matrix(np.vstack([-np.eye(count), np.eye(count)]))
    limits = cvxopt.matrix(np.concatenate([np.zeros(count), np.ones(count)]))
    cvxopt.solvers.options.update(show_progress=False)
    found = cvxopt.solvers.cp(
        objective, bounds, limits, A=cvxopt.matrix(1.0, (1, count)), b=cvxopt.matrix(float(k))
    )
    return np.array(found["x"]).ravel(), -found["primal objective"]


def timed(work):
    began = time.process_time()
    result = work()
    return result, time.process_time() - began


def main(count=500, k=70):
    J = np.random.default_rng(0).normal(size=(count, 3, 21)) * np.linspace(1, 0.1, 21)
    (weights, bound), slow = timed(lambda: relaxation_by_cvxopt(J, k))
    choice, quick = timed(lambda: pw.select(J, k, criterion="d"))
    relaxed, quickest = timed(lambda: pw.select(J, k, criterion="d", starts=1, proof=0))
    rounded = np.argsort(weights)[-k:]
    print(f"{count} candidates, 3 rows, 21 parameters, {k} poses, CPU seconds on one core")
    print(f"cvxopt    {slow:9.3f} s  bound {bound:.6f}  largest weights {pw.indices(J, rounded)['d']:.6f}")
    print(f"posewise  {quick:9.3f} s  bound {choice.bound:.6f}  chosen {choice.value:.6f} ({slow / quick:.0f} times)")
    print(f"one start {quickest:9.3f} s  bound {relaxed.bound:.6f}  chosen {relaxed.value:.6f} ({slow / quickest:.0f} times)")
    print(f"weights between 0.001 and 0.999: {((weights > 1e-3) & (weights < 0.999)).sum()}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
