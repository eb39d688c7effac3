"""Builds a wheel with CMake, as pip asks for it (PEP 517): needs no package that Debian lacks.

pip install . runs it; so does python3 -m pip wheel . The compiler, CMake and the libraries are those
of ./scripts/test; what is missing is said by CMake.
"""

import base64
import hashlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import tomllib
import zipfile

root = pathlib.Path(__file__).resolve().parent.parent


def _version() -> str:
    found = re.search(r"project\(posewise VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text())
    assert found is not None
    return found.group(1)


def _metadata() -> str:
    project = tomllib.loads((root / "pyproject.toml").read_text())["project"]
    lines = [
        "Metadata-Version: 2.1",
        f"Name: {project['name']}",
        f"Version: {_version()}",
        f"Summary: {project['description']}",
        f"License: {project['license']['text']}",
        f"Requires-Python: {project['requires-python']}",
    ]
    lines += [f"Requires-Dist: {name}" for name in project["dependencies"]]
    for extra, needed in project["optional-dependencies"].items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f"Requires-Dist: {name}; extra == '{extra}'" for name in needed]
    lines.append("Description-Content-Type: text/markdown")
    return "\n".join(lines) + "\n\n" + (root / project["readme"]).read_text()


def _tag() -> str:
    interpreter = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{interpreter}-{interpreter}-{platform}"


def _run(*command: str) -> None:
    if subprocess.run(command).returncode != 0:
        sys.exit(f"posewise: '{' '.join(command[:3])} ...' failed; what it misses stands above. On "
                 "Debian and Ubuntu ./scripts/test installs all that is needed")


def _install(stage: str) -> None:
    """Builds the library and the module; POSEWISE_BUILD names a folder to build in, configured by
    whoever made it."""
    if shutil.which("cmake") is None:
        sys.exit("posewise: needs cmake, a C++20 compiler and the libraries of scripts/common.sh")
    with tempfile.TemporaryDirectory(prefix="posewise") as new:
        build = os.environ.get("POSEWISE_BUILD", new)
        options = ["-DPOSEWISE_PYTHON=ON", "-DPOSEWISE_BUILD_TESTS=OFF", "-DCMAKE_BUILD_TYPE=Release",
                   f"-DPython_EXECUTABLE={sys.executable}"]
        if shutil.which("ninja"):
            options.append("-GNinja")
        if shutil.which("ccache"):
            options.append("-DCMAKE_CXX_COMPILER_LAUNCHER=ccache")
        if build == new:
            _run("cmake", "-S", str(root), "-B", build, *options)
        _run("cmake", "--build", build, "--parallel", "--target", "posewise_python")
        _run("cmake", "--install", build, "--component", "python", "--prefix", stage, "--strip")


def _hash(content: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    info = f"posewise-{_version()}.dist-info"
    name = f"posewise-{_version()}-{_tag()}.whl"
    with tempfile.TemporaryDirectory(prefix="posewise") as stage:
        _install(stage)
        package = next(pathlib.Path(stage).rglob("_posewise*.so")).parent
        files = {
            path.relative_to(package.parent).as_posix(): path.read_bytes()
            for path in sorted(package.rglob("*"))
            if path.is_file()
        }
    files[f"{info}/METADATA"] = _metadata().encode()
    files[f"{info}/LICENSE"] = (root / "LICENSE").read_bytes()
    files[f"{info}/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: posewise\nRoot-Is-Purelib: false\nTag: {_tag()}\n".encode()
    )
    record = "".join(f"{path},sha256={_hash(data)},{len(data)}\n" for path, data in files.items())
    files[f"{info}/RECORD"] = (record + f"{info}/RECORD,,\n").encode()
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in files.items():
            entry = zipfile.ZipInfo(path)  # no time of day: the same wheel from the same source
            entry.external_attr = (0o755 if path.endswith(".so") else 0o644) << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, data)
    return name


def build_sdist(sdist_directory, config_settings=None):
    name = f"posewise-{_version()}"
    target = pathlib.Path(sdist_directory) / f"{name}.tar.gz"
    _run("git", "-C", str(root), "archive", f"--prefix={name}/", "-o", str(target), "HEAD")
    return target.name
