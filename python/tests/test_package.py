import subprocess
import sys

import poinsot


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


def test_command():
    said = subprocess.run([sys.executable, "-m", "poinsot._app", "--version"], capture_output=True, text=True)
    assert said.returncode == 0 and poinsot.__version__ in said.stdout
