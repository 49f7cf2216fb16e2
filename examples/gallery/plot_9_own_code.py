"""
A code of one's own
===================

What a case asks can be asked of any program: the problem goes out in plain files, an answer comes
back in one, and is held to the bounds that our own method is held to. On the command line that is
``cmverify export`` and ``cmverify compare``; here it is done from Python, with a program of ten
lines.
"""

import json
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from cmverify.cases import registry
from cmverify.exchange import answers, case_export, compare
from cmverify.judge.verdict import judge

# %%
# The problem: a temperature in an anisotropic disc, prescribed in a layer at its edge.
case, n = registry.get("disc-exponential"), 25
pose = case.poses[0]
folder = Path(tempfile.mkdtemp())
for path in case_export.write_case(case, pose, n, folder):
    print(path.name)


# %%
# The program knows these files and nothing else. It is of another kind than ours: a series of
# polynomials that all solve div(D∇T) = 0, the real and imaginary parts of (x₁ + μ x₂)ᵏ, fitted to
# what is prescribed on the edge.
def program(folder, degree):
    said = json.loads((folder / "case.json").read_text(encoding="utf-8"))
    (d11, d12), (_, d22) = said["material"]["matrix"]
    mu = np.roots([d22, 2 * d12, d11])[0]
    edge, wanted = np.load(folder / "boundary.npz"), np.load(folder / "reference.npz")

    def basis(points):
        z = points[:, 0] + mu * points[:, 1]
        powers = z[:, None] ** np.arange(degree + 1)
        return np.hstack([powers.real, powers.imag])

    factors = np.linalg.lstsq(basis(edge["points"]), edge["value_T"], rcond=None)[0]
    places = wanted["temperature_points"]
    np.savez(folder / "fields.npz", points=places, temperature=basis(places) @ factors)


# %%
# Its answers, by degree, beside our bonds and the bound that holds for them at this spacing.
degrees = (2, 4, 6, 8, 10)
ours = compare.our_record(case, pose, n, None)
errors, verdicts = [], []
for degree in degrees:
    program(folder, degree)
    answer = answers.read(folder / "fields.npz", pose.state(n).targets)
    judged = compare.compare(case, pose, n, [answer], ours)
    outcomes = {record.method: {n: record.outcome} for record in judged.records}
    errors.append(outcomes[answer.name][n].quantities["temperature"])
    verdicts += [v for v in judge(judged.case, outcomes) if v.method == answer.name]
bound = judged.case.checks[-1].bound_at(n)

figure, axis = plt.subplots(figsize=(6, 4), layout="constrained")
axis.semilogy(degrees, errors, "o-", label="the program, by its degree")
axis.axhline(ours.outcome.quantities["temperature"], color="C1", label=f"bonds, a/{n}")
axis.axhline(bound, color="C3", linestyle="--", label="bound")
axis.set(xlabel="degree", ylabel="relative L2 error of the temperature")
axis.legend()

# %%
# A verdict an answer: the first are refused, as they should be.
for degree, verdict in zip(degrees, verdicts, strict=True):
    print(degree, verdict.passed, f"{verdict.value:.1e}", verdict.asked)
plt.show()
