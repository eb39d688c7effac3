"""Choosing K of N poses in Python: cvxopt's relaxations beside posewise.

    python_relaxation.py [CANDIDATES] [POSES]

All maximise the determinant of the information of the same Jacobians, with weights from 0 to 1 that
sum to K, in one run on one core. "cone" is what FIGAROH asks cvxopt for (through PICOS): the root of
the determinant by a linear matrix inequality and second-order cones. "log det" is the quickest that
cvxopt can do: its convex solver with first and second derivatives in closed form. Weights do not
choose an exact number of poses; the largest K are taken, as FIGAROH does. Needs python3-cvxopt and
the package posewise on the path.
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
    found = cvxopt.solvers.cp(
        objective, bounds, limits, A=cvxopt.matrix(1.0, (1, count)), b=cvxopt.matrix(float(k))
    )
    return np.array(found["x"]).ravel(), -found["primal objective"]


def relaxation_by_cone(J, k):
    """The same by a cone program: t <= det(M)^(1/p) where [M Z; Z^T diag(Z)] is positive
    semidefinite for a lower triangular Z and t is at most the geometric mean of Z's diagonal
    [Ben-Tal and Nemirovski, Lectures on Modern Convex Optimization, 4.2]."""
    count, _, p = J.shape
    informations = np.einsum("nri,nrj->nij", J, J)
    lower = [(i, j) for j in range(p) for i in range(j, p)]
    leaves = 1 << (p - 1).bit_length()
    first_node = count + len(lower)  # node 1 of the tree is t, nodes from `leaves` on the diagonal
    size = first_node + leaves - 1
    t = first_node

    inequality = np.zeros((4 * p * p, size))
    for w in range(count):
        entry = np.zeros((2 * p, 2 * p))
        entry[:p, :p] = informations[w]
        inequality[:, w] = -entry.ravel()
    for z, (i, j) in enumerate(lower):
        entry = np.zeros((2 * p, 2 * p))
        entry[i, p + j] = entry[p + j, i] = 1
        if i == j:
            entry[p + i, p + i] = 1
        inequality[:, count + z] = -entry.ravel()

    diagonal = [count + z for z, (i, j) in enumerate(lower) if i == j]

    def variable(node):
        if node < leaves:
            return first_node + node - 1
        return diagonal[node - leaves] if node - leaves < p else t

    cones = np.zeros((3 * (leaves - 1), size))  # 2 u <= root of (a + b)^2 - (a - b)^2
    for node in range(1, leaves):
        a, b = variable(2 * node), variable(2 * node + 1)
        rows = cones[3 * (node - 1) : 3 * node]
        rows[0, a] -= 1
        rows[0, b] -= 1
        rows[1, a] -= 1
        rows[1, b] += 1
        rows[2, variable(node)] -= 2

    bounds = np.zeros((2 * count, size))
    bounds[:count, :count] = -np.eye(count)
    bounds[count:, :count] = np.eye(count)
    limits = np.concatenate([np.zeros(count), np.ones(count), np.zeros(len(cones) + 4 * p * p)])
    sum_of_weights = np.zeros((1, size))
    sum_of_weights[0, :count] = 1
    cost = np.zeros(size)
    cost[t] = -1
    found = cvxopt.solvers.conelp(
        cvxopt.matrix(cost),
        cvxopt.sparse(cvxopt.matrix(np.vstack([bounds, cones, inequality]))),
        cvxopt.matrix(limits),
        {"l": 2 * count, "q": [3] * (leaves - 1), "s": [2 * p]},
        cvxopt.matrix(sum_of_weights),
        cvxopt.matrix(float(k)),
    )
    weights = np.array(found["x"]).ravel()[:count]
    return weights, np.linalg.slogdet(np.tensordot(weights, informations, 1))[1]


def timed(work):
    began = time.process_time()
    result = work()
    return result, time.process_time() - began


def main(count=500, k=70):
    cvxopt.solvers.options.update(show_progress=False)
    J = np.random.default_rng(0).normal(size=(count, 3, 21)) * np.linspace(1, 0.1, 21)
    peers = {"cone": relaxation_by_cone, "log det": relaxation_by_cvxopt}
    solved = {name: timed(lambda solve=solve: solve(J, k)) for name, solve in peers.items()}
    ours = {
        "default": timed(lambda: pw.select(J, k, criterion="d")),
        "one start": timed(lambda: pw.select(J, k, criterion="d", starts=1, proof=0)),
    }
    print(f"{count} candidates, 3 rows, 21 parameters, {k} poses, CPU seconds on one core")
    for name, ((weights, bound), seconds) in solved.items():
        largest = pw.indices(J, np.argsort(weights)[-k:])["d"]
        print(f"cvxopt, {name:9} {seconds:9.3f} s  bound {bound:.6f}  largest weights {largest:.6f}")
    for name, (choice, seconds) in ours.items():
        times = ", ".join(f"{slow / seconds:.0f} times {peer}" for peer, (_, slow) in solved.items())
        print(
            f"posewise, {name:9} {seconds:7.3f} s  bound {choice.bound:.6f}  chosen "
            f"{choice.value:.6f}  ({times})"
        )


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
