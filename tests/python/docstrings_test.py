"""The examples in docstrings are as they say."""

import doctest
import importlib
import pkgutil

import pytest

import posewise

names = ["posewise"] + [
    f"posewise.{module.name}"
    for module in pkgutil.iter_modules(posewise.__path__)
    if module.name != "_posewise"
]


@pytest.mark.parametrize("name", names)
def test_examples(name):
    assert doctest.testmod(importlib.import_module(name)).failed == 0


def test_there_are_examples():
    finder = doctest.DocTestFinder()
    assert sum(len(test.examples) for test in finder.find(posewise.choice)) > 5
