"""clang-tidy finds nothing in the lines of C++ that have changed. Usage: tidy_test.py REPOSITORY BUILD

Changed is what the branch adds to the default branch (on that, what the last commit changed) and what
is not committed. Sources of one unit are read together, as are all headers; the smallest first, and
what there is no time for is named. Skipped (exit code 77) without git or clang-tidy 14 (Debian 12),
outside a clone, and where no C++ has changed.
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import time

from units import units_by_source

SECONDS = 45
# Precompiled headers are g++'s; warnings are for the compiler to give.
NOT_FOR_CLANG = {"-fpch-preprocess", "-Winvalid-pch", "-fno-semantic-interposition", "-Werror"}

Ranges = dict[pathlib.Path, list[list[int]]]


def git(root: pathlib.Path, *words: str) -> str:
    done = subprocess.run(["git", *words], cwd=root, capture_output=True, text=True)
    return done.stdout if done.returncode == 0 else ""


def changed_lines(root: pathlib.Path) -> Ranges:
    head = git(root, "rev-parse", "HEAD").strip()
    base = git(root, "merge-base", "HEAD", "origin/HEAD").strip()
    if base in ("", head):
        base = git(root, "rev-parse", "HEAD~1").strip()
    if base == "":
        return {}
    lines: Ranges = {}
    for line in git(root, "diff", "--unified=0", "--no-prefix", base, "--", "*.cpp", "*.hpp").splitlines():
        if line.startswith("+++ "):
            ranges = lines.setdefault(root / line[4:], [])
        elif hunk := re.match(r"@@ -\S+ \+(\d+)(?:,(\d+))? @@", line):
            first, count = int(hunk[1]), int(hunk[2] or 1)
            if count > 0:
                ranges.append([first, first + count - 1])
    for name in git(root, "ls-files", "--others", "--exclude-standard", "*.cpp", "*.hpp").splitlines():
        lines[root / name] = [[1, 1_000_000]]
    return {path: ranges for path, ranges in lines.items() if ranges}


def faults_in(paths: list[pathlib.Path], lines: Ranges, program: str, options: list[str], made: pathlib.Path,
              seconds: float) -> list[str]:
    made.write_text("".join(f'#include "{path}"  // NOLINT\n' for path in paths))
    only = json.dumps([{"name": str(path), "lines": lines[path]} for path in paths])
    done = subprocess.run([program, "--quiet", f"--line-filter={only}", str(made), "--", *options],
                          capture_output=True, text=True, timeout=seconds)
    # What clang 14 does not know of C++20 is no fault.
    return re.findall(r"^.* error: .*\[(?!clang-diagnostic-error).*$", done.stdout, re.M)


def options_for_clang(command: tuple[str, ...]) -> list[str]:
    options = [word for word in command[1:] if word not in NOT_FOR_CLANG]
    if "-include" in options:
        at = options.index("-include")
        del options[at:at + 2]
    return [*options, "-Wno-everything"]


def main(repository: str, build_folder: str) -> int:
    root, build = pathlib.Path(repository), pathlib.Path(build_folder)
    program = shutil.which("clang-tidy-14")
    if program is None or shutil.which("git") is None:
        print("clang-tidy 14 or git is not installed")
        return 77
    lines = changed_lines(root)
    if not lines:
        print("no C++ has changed, or this is no clone")
        return 77
    units = units_by_source(build)
    groups: dict[tuple[tuple[str, ...], pathlib.Path | None], list[pathlib.Path]] = {}
    for path in lines:
        if path not in units:
            print(f"left out, not compiled alone: {path}")
            continue
        unit = units[path]
        groups.setdefault((unit.command, unit.path if path.suffix == ".cpp" else None), []).append(path)
    end = time.monotonic() + SECONDS
    faults: list[str] = []
    sized = sorted(groups.items(), key=lambda group: sum(path.stat().st_size for path in group[1]))
    for (command, _), paths in sized:
        # What a file of such a name includes is analysed as the file itself.
        made = build / "tests" / "UnifiedSource-tidy.cpp"
        try:
            faults += faults_in(paths, lines, program, options_for_clang(command), made,
                                max(0.1, end - time.monotonic()))
            outcome = "read"
        except subprocess.TimeoutExpired:
            outcome = "left out, no time"
        print(f"{outcome}: {', '.join(map(str, paths))}", flush=True)
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2]))
