"""The includes obey the table of modules, which stands alike in CMakeLists.txt and ARCHITECTURE.md.

    layering_test.py REPOSITORY

The table is the posewise_module(<module> <modules it may use>...) lines, and ARCHITECTURE's lines
| module | holds | may use |; "core/x.hpp" is a private header of core. Public headers moreover
include no third-party header but Eigen's, so that no dependency of ours becomes everyone's. What
`task` computes must be of use without a file or a terminal, so it may use neither io nor report, and
neither it nor what it uses speaks of options of the command line: it names fields, `pose_count`.
Private headers hold posewise::detail and nothing else, and public ones nothing of it, so that what
is no promise to users can be seen from its name.
"""

import pathlib
import re
import sys

NAMESPACE = re.compile(r"^(?:inline )?namespace ([\w:]*) ?\{", re.MULTILINE)
FLAG = re.compile(r'"[^"\n]*--[a-z][^"\n]*"')
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.MULTILINE)


def read_table(repository):
    text = (repository / "CMakeLists.txt").read_text()
    lines = re.findall(r"^posewise_module\(([^)]*)\)", text, re.MULTILINE)
    return {line.split()[0]: set(line.split()) for line in lines}


def read_stated_table(repository):
    text = (repository / "ARCHITECTURE.md").read_text()
    table = text.partition("| module | holds | may use |\n")[2].partition("\n\n")[0]
    rows = re.findall(r"^\| ([a-z]+) \| [^|]* \| ([a-z -]*) \|$", table, re.MULTILINE)
    return {module: {module} | set(used.replace("-", "").split()) for module, used in rows}


def table_faults(table, stated):
    """Where ARCHITECTURE's table is not that of CMakeLists.txt, and what no table may allow."""
    for module in sorted((table.keys() | stated.keys()) - {"cli", "python"}):
        if table.get(module) != stated.get(module):
            yield (f"ARCHITECTURE.md: module {module} may use {sorted(stated.get(module, []))}, by "
                   f"CMakeLists.txt {sorted(table.get(module, []))}")
    for module in ("io", "report", "cli"):
        if module in table.get("task", set()):
            yield f"CMakeLists.txt: task may not use {module}"


def includes(path):
    """(line number, "<" or '"', included path) of every include."""
    text = path.read_text()
    for match in INCLUDE.finditer(text):
        yield text.count("\n", 0, match.start(1)) + 1, match[1], match[2]


def layering_faults(table, module, included):
    """Why a file of `module` must not include this, or nothing."""
    if "/" not in included:
        return  # beside it
    used = included.removeprefix("posewise/").split("/")[0]
    if used == "posewise.hpp":
        yield f"{included}: is for users only; include what is needed of it"
        return
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


def namespace_faults(path, is_public):
    text = path.read_text()
    names = NAMESPACE.findall(text)
    if is_public and re.search(r"\bdetail::|::detail\b", text):
        yield "a public header does not speak of posewise::detail"
    if not is_public and not names:
        yield "has no namespace; names in a private header are in posewise::detail"
    for name in names:
        if not is_public and not (name + "::").startswith("posewise::detail::"):
            yield f"namespace '{name}': names in a private header are in posewise::detail"


def flag_faults(text):
    """Options of the command line in texts of a module that knows no command line."""
    text = re.sub(r"//.*", "", text)
    for match in FLAG.finditer(text):
        yield text.count("\n", 0, match.start()) + 1, f"{match[0]}: names an option; name the field"


def check(repository):
    table = read_table(repository)
    faults, count = list(table_faults(table, read_stated_table(repository))), 0
    for path in sorted(repository.glob("include/posewise/**/*.hpp*")) + sorted(
            repository.glob("src/**/*.[ch]pp")):
        name = path.relative_to(repository)
        is_public = name.parts[0] == "include"
        module = name.parts[2 if is_public else 1]
        if module == "posewise.hpp":
            continue  # all that a program needs, of every module
        count += 1
        if module in ("cli", "python") and not is_public:
            continue  # they use all; they have no public header, so nothing can include them
        if module not in table:
            faults.append(f"{name}: '{module}' is not a module of CMakeLists.txt")
            continue
        if ".hpp" in path.suffixes:
            faults += [f"{name}: {fault}" for fault in namespace_faults(path, is_public)]
        if module not in ("io", "report"):
            faults += [f"{name}:{line}: {fault}" for line, fault in flag_faults(path.read_text())]
        for line, bracket, included in includes(path):
            found = list(layering_faults(table, module, included)) if bracket == '"' else []
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
