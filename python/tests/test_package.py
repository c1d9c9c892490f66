import doctest
import importlib
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import poinsot
import pytest


def test_names():
    assert poinsot.methods()[:2] == ("exact", "jacobi") and "srkn6" in poinsot.splittings() and "gravity" in poinsot.effects()
    assert poinsot.has_feature("lapack") and not poinsot.has_feature("levitation")
    assert poinsot.__version__.count(".") == 2


def test_every_name_is_documented():
    for name in poinsot.__all__:
        thing = getattr(poinsot, name)
        assert thing.__doc__, name
        if isinstance(thing, type) and thing.__module__.startswith("poinsot"):
            for member in vars(thing).values():
                if callable(member) and not member.__name__.startswith("_"):
                    assert member.__doc__, f"{name}.{member.__name__}"


@pytest.mark.parametrize("name", ["_body", "_plan", "elliptic", "quaternion"])
def test_examples_of_docstrings(name):
    module = importlib.import_module("poinsot." + name)
    failed, tried = doctest.testmod(module, extraglobs={"np": np})
    assert tried > 0 and failed == 0


@pytest.mark.parametrize("module, names", [(poinsot.quaternion, r"quaternion_(\w+)"),
                                           (poinsot.elliptic, r"(?:elliptic_)?((?<=elliptic_)\w+|jacobi\w*|carlson\w+)")])
def test_functions_are_those_of_the_header(module, names):
    header = (Path(__file__).parents[2]/"include/poinsot.h").read_text()
    assert set(re.findall(rf"^poinsot_status poinsot_{names}\(", header, re.MULTILINE)) == set(module.__all__)
    assert all(getattr(module, name).__doc__ for name in module.__all__)


def test_command():
    said = subprocess.run([sys.executable, "-m", "poinsot._app", "--version"], capture_output=True, text=True)
    assert said.returncode == 0 and poinsot.__version__ in said.stdout
