"""Which unit of compile_commands.json has each source, and how that is compiled."""

import json
import pathlib
import re
import shlex
from dataclasses import dataclass


@dataclass(frozen=True)
class Unit:
    path: pathlib.Path
    folder: pathlib.Path  # where the compiler is run
    command: tuple[str, ...]  # compiler and options, without input and output


def units_by_source(build: pathlib.Path) -> dict[pathlib.Path, Unit]:
    """Of each source and, where headers are compiled alone, each header."""
    units: dict[pathlib.Path, Unit] = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        words = shlex.split(entry["command"])
        for option in ("-o", "-c"):
            at = words.index(option)
            del words[at:at + 2]
        path = pathlib.Path(entry["file"])
        unit = Unit(path, pathlib.Path(entry["directory"]), tuple(words))
        sources = [str(path)]
        if build in path.parents and path.exists():  # of CMake: it includes the sources
            sources = re.findall(r'^#include "(.+)"', path.read_text(), re.M)
        for source in sources:
            units.setdefault(pathlib.Path(source), unit)
    return units
