"""A test fails for each of some lines that are made wrong. Usage: mutation_test.py REPOSITORY BUILD NINJA

The source with the wrong line is compiled alone and linked into the module's tests before all else: a
linker takes the first of two definitions. Only calls from other units come there, so a line must be of
what they call. A line that is not wrong goes the same way first, and must be passed.
"""

import pathlib
import shutil
import subprocess
import sys

from units import Unit, units_by_source

# File, line, what is wrong in its place, module of the test, test.
MUTANTS = [
    # The column of a target's place.
    ("src/measurement/targets.cpp",
     "J_unknowns.block<3, 1>(3 * j, index) = world_from_flange.linear().col(axis);",
     "J_unknowns.block<3, 1>(3 * j, index) = -world_from_flange.linear().col(axis);",
     "measurement", "EverySensor.HasTheJacobianOfItsPredictionAndOfItsPositions"),
    # The weight of a prior.
    ("src/measurement/prior_rows.cpp",
     "known = root.matrixL().solve(MatrixXd(scale.asDiagonal()));",
     "known = 2 * root.matrixL().solve(MatrixXd(scale.asDiagonal()));",
     "measurement", "PriorInformation.IsTheInverseOfTheCovarianceInUnitsOfTheSpread"),
    # The probability of a quantile.
    ("src/core/statistics.cpp",
     "return boost::math::quantile(ChiSquared(degrees_of_freedom), p);",
     "return boost::math::quantile(ChiSquared(degrees_of_freedom), 1 - p);",
     "core", "DistributionQuantile.IsThatOfTables"),
    # The gap to a proven bound.
    ("src/selection/bound.cpp",
     "? exponential((value - bound) / static_cast<double>(parameter_count))",
     "? exponential((bound - value) / static_cast<double>(parameter_count))",
     "selection", "Efficiency.IsAFractionForEveryCriterion"),
    # The limits of the joints.
    ("src/model/joint_limits.cpp",
     "if (q[j] >= joint.lower - rounding && q[j] <= joint.upper + rounding) continue;",
     "if (q[j] >= joint.lower - rounding || q[j] <= joint.upper + rounding) continue;",
     "model", "DescribeLimitViolation.NamesTheFirstJointBeyondItsLimits"),
    # The factor of a unit in a file.
    ("src/io/format/units.cpp",
     '{"deg", Quantity::Angle, std::numbers::pi, 180},',
     '{"deg", Quantity::Angle, std::numbers::pi, 200},',
     "io", "ReadMeasurementsCsv.ConvertsDegreesAndMillimetres"),
    # The digits of a program, within the limits.
    ("src/task/plan/sent_plan.cpp",
     "if (fault.empty()) return nearest;",
     "if (!nearest.hasNaN()) return nearest;",
     "task", "SentPlan.RoundsInwardsAtALimit"),
    # The degrees of freedom of a fit.
    ("src/calibrator/least_squares.cpp",
     "estimate.degrees_of_freedom = problem.equation_count() - R.cols();",
     "estimate.degrees_of_freedom = problem.equation_count();",
     "calibrator", "MissingTargets.ADroppedTargetIsOneOfWeightZero"),
    # The root in the slope of a determinant.
    ("src/criteria/objective.cpp",
     "is_logarithm(objective.criterion) ? 1 : value / (2.0 * static_cast<double>(L));",
     "is_logarithm(objective.criterion) ? 1 : value / static_cast<double>(L);",
     "criteria", "Objective.GradientOfEveryCriterionAgreesWithDifferences"),
    # What is held out of a fold.
    ("src/calibrator/cross_validation.cpp",
     "take(measurements_, all_but(measurements_.configuration_count(), held_out));",
     "take(measurements_, all_but(measurements_.configuration_count(), {}));",
     "calibrator", "CrossValidate.IsAnIdentificationOfEveryFoldWhereverItStarts"),
]


class Fault(Exception):
    """A mutant that cannot be tried."""


def run(command: list[str], folder: pathlib.Path) -> str:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        raise Fault(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    return done.stdout


def passes(mutant: pathlib.Path, source: pathlib.Path, unit: Unit, build: pathlib.Path, ninja: str,
           program: str, test: str) -> bool:
    """Whether the test passes with `mutant` in place of `source`."""
    made, tests = mutant.with_suffix(".o"), mutant.with_suffix("")
    run([*unit.command, f"-iquote{source.parent}", "-c", str(mutant), "-o", str(made)], unit.folder)
    # The command ninja links the program by, with one object more.
    link = run([ninja, "-t", "commands", "-s", program], build).replace(f" -o {program} ", f" -o {tests} ", 1)
    before, first, others = link.partition(" CMakeFiles/")
    run(["sh", "-c", f"{before} -Wl,-z,muldefs {made}{first}{others}"], build)
    done = subprocess.run([tests, f"--gtest_filter={test}"], cwd=mutant.parent, capture_output=True,
                          text=True)
    if f"[ RUN      ] {test}\n" not in done.stdout:
        raise Fault(f"there is no test {test}")
    return done.returncode == 0


def main(repository: str, build_folder: str, ninja: str) -> int:
    root, build = pathlib.Path(repository), pathlib.Path(build_folder)
    units = units_by_source(build)
    folder = build / "tests" / "mutants"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    faults = 0
    file, line, _, module, test = MUTANTS[0]
    tries = [(file, line, line, module, test), *MUTANTS]
    for number, (file, line, wrong, module, test) in enumerate(tries):
        source = root / file
        text = source.read_text()
        mutant = folder / f"{number}.cpp"
        mutant.write_text(text.replace(line, wrong))
        fault = ""
        try:
            if text.count(line) != 1:
                raise Fault(f"the line is there {text.count(line)} times, must be once")
            passed = passes(mutant, source, units[source], build, ninja, f"tests/posewise_{module}_test", test)
            if passed != (wrong == line):
                fault = f"{test} {'does not see it' if passed else 'fails'}"
        except Fault as error:
            fault = str(error)
        faults += fault != ""
        print(f"{file}: {line if fault else wrong}: {fault or 'as it must be'}", flush=True)
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
