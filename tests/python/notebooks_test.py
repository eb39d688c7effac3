"""Every notebook of designs/python runs, and prints what stands in it."""

import ast
import contextlib
import io
import json

import pytest
from conftest import designs

notebooks = sorted((designs / "python").glob("*.ipynb"))


def run_cell(text, names):
    """What a cell prints, and the text of its last expression."""
    tree = ast.parse(text)
    last = None
    if isinstance(tree.body[-1], ast.Expr):
        last = ast.Expression(tree.body.pop().value)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(tree, "cell", "exec"), names)
        value = None if last is None else eval(compile(last, "cell", "eval"), names)
    return printed.getvalue(), None if value is None else repr(value)


def stated(cell):
    printed, value = "", None
    for output in cell["outputs"]:
        if output["output_type"] == "stream":
            printed += "".join(output["text"])
        else:
            value = "".join(output["data"]["text/plain"])
    return printed, value


def test_there_are_notebooks():
    assert len(notebooks) >= 5


@pytest.mark.parametrize("path", notebooks, ids=lambda path: path.stem)
def test_notebook(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {"__name__": "__main__"}
    for cell in json.loads(path.read_text())["cells"]:
        if cell["cell_type"] == "code":
            assert run_cell("".join(cell["source"]), names) == stated(cell), "".join(cell["source"])
