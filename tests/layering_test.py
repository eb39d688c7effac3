"""The includes obey the table of modules in CMakeLists.txt.

    layering_test.py REPOSITORY

The table is the posewise_module(<module> <modules it may use>...) lines. Public headers moreover
include no third-party header but Eigen's, so that no dependency of ours becomes everyone's.
"""

import pathlib
import re
import sys

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def read_table(repository):
    text = (repository / "CMakeLists.txt").read_text()
    lines = re.findall(r"^posewise_module\(([^)]*)\)", text, re.MULTILINE)
    return {line.split()[0]: set(line.split()) for line in lines}


def includes(path):
    """(line number, "<" or '"', included path) of every include."""
    text = path.read_text()
    for match in INCLUDE.finditer(text):
        yield text.count("\n", 0, match.start(1)) + 1, match[1], match[2]


def layering_faults(table, module, included):
    """Why a file of `module` must not include this, or nothing."""
    if not included.startswith("posewise/"):
        return
    used = included.split("/")[1]
    if used not in table:
        yield f"{included}: '{used}' is not a module of CMakeLists.txt"
    elif used not in table[module]:
        yield f"{included}: {module} may use only {', '.join(sorted(table[module]))}"


def public_header_faults(bracket, included):
    if bracket == '"' and not included.startswith("posewise/"):
        yield f"{included}: a public header includes by its whole path, posewise/..."
    standard = "/" not in included and "." not in included
    if bracket == "<" and not standard and not included.startswith("Eigen/"):
        yield f"{included}: a public header includes only posewise, Eigen and the standard library"


def check(repository):
    table = read_table(repository)
    faults, count = [], 0
    for path in sorted(repository.glob("include/posewise/**/*.hpp*")) + sorted(
            repository.glob("src/**/*.[ch]pp")):
        name = path.relative_to(repository)
        is_public = name.parts[0] == "include"
        module = name.parts[2 if is_public else 1]
        count += 1
        if module == "cli" and not is_public:
            continue  # uses all; has no public header, so nothing can include it
        if module not in table:
            faults.append(f"{name}: '{module}' is not a module of CMakeLists.txt")
            continue
        for line, bracket, included in includes(path):
            found = list(layering_faults(table, module, included))
            if is_public:
                found += public_header_faults(bracket, included)
            faults += [f"{name}:{line}: {fault}" for fault in found]
    if not table or count == 0:
        faults.append(f"{repository}: no modules or no sources found")
    return faults


if __name__ == "__main__":
    found_faults = check(pathlib.Path(sys.argv[1]))
    print("\n".join(found_faults) or "every include obeys the table of modules")
    sys.exit(1 if found_faults else 0)
