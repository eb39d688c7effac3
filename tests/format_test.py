"""Every source is laid out as .clang-format says. Usage: format_test.py REPOSITORY

Skipped (exit code 77) without clang-format 14, that of Debian 12: others break lines elsewhere.
"""

import pathlib
import shutil
import subprocess
import sys


def main(repository: str) -> int:
    program = shutil.which("clang-format-14") or shutil.which("clang-format")
    if program is None or " 14." not in subprocess.run([program, "--version"], capture_output=True, text=True,
                                                      check=True).stdout:
        print("clang-format 14 is not installed")
        return 77
    root = pathlib.Path(repository)
    files = [str(path) for folder in ("include", "src", "tests", "examples")
             for path in sorted((root / folder).rglob("*.[ch]pp")) if "node_modules" not in path.parts]
    done = subprocess.run([program, "--dry-run", "--Werror", *files], capture_output=True, text=True)
    print("\n".join(line for line in done.stderr.splitlines() if "error:" in line))
    return 0 if files and done.returncode == 0 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
