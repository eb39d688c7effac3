"""Each key of a campaign file is in its manual, designs/README.md, and no other.

    keys_test.py REPOSITORY

The keys are those that the readers of src/io hand to YamlMap; `sigma_<length>` may have any unit of
length, and stands in the manual with one of them. The manual's are the first column of its tables.
"""

import pathlib
import re
import sys

UNITS = {"length": ["mm", "m", "um"], "angle": ["deg", "mrad", "urad", "rad"],
         "amount": ["deg", "mrad", "mm"]}
LISTS = re.compile(r"YamlMap\s*\w*\s*\([^{};]*\{([^{}]*)\}|keys\s*\{([^{}]*)\}")
KEY = re.compile(r'"([A-Za-z_]+(?:<[a-z]+>)?[A-Za-z_]*)"')


def keys_of_readers(repository):
    keys = {}
    for path in sorted((repository / "src/io").rglob("*.[ch]pp")):
        for lists in LISTS.finditer(path.read_text()):
            for key in KEY.findall(lists[1] or lists[2] or ""):
                keys.setdefault(key, path.name)
    return keys


def keys_of_manual(repository):
    text = (repository / "designs/README.md").read_text()
    return set(re.findall(r"^\| `([A-Za-z_]+)` \|", text, re.MULTILINE))


def spellings(key):
    """The key with each unit it may have."""
    match = re.search(r"<([a-z]+)>", key)
    if not match:
        return {key}
    return {key.replace(match[0], unit) for unit in UNITS[match[1]]}


def check(repository):
    readers, manual = keys_of_readers(repository), keys_of_manual(repository)
    written = (repository / "designs/README.md").read_text()
    faults = [f"designs/README.md: key {key} of {source} is not explained"
              for key, source in sorted(readers.items())
              if not any(f"`{spelling}`" in written for spelling in spellings(key))]
    known = set().union(*(spellings(key) for key in readers))
    faults += [f"designs/README.md: {key} is no key of any reader" for key in sorted(manual - known)]
    if len(readers) < 60:
        faults.append(f"only {len(readers)} keys found in src/io: is the pattern still right?")
    return faults


if __name__ == "__main__":
    found_faults = check(pathlib.Path(sys.argv[1]))
    print("\n".join(found_faults) or "each key of the readers is in the manual")
    sys.exit(1 if found_faults else 0)
