from pathlib import Path

import numpy as np
import poinsot
import pytest

book = {"scene": {"t_end": 1, "h": 0.01, "method": "dmv10"},
        "bodies": {"moments": [0.376, 0.627, 1.0], "y": np.array([0, 0.6, -0.8])}, "output": {"every": 0.1}}


def test_shipped_scene():
    run = poinsot.run("free-body")
    assert run.t.shape == (2001,) and run.q.shape == (2001, 1, 4) and run.y.shape == (2001, 1, 3)
    assert run.t[-1] == 40 and abs(run.y[-1, 0] - [0.0545936805170048, -0.5930307093190378, -0.8033268997439126]).max() < 1e-14
    assert np.ptp(run.energy) < 1e-15 and (run.energy == run.kinetic + run.potential).all()
    assert run.summary["method"] == "dmv10" and run.summary["steps"] == 4000
    assert (run.summary["body 1 y"] == run.y[-1, 0]).all() and "state" in str(run.summary)
    assert run.folder is None


def test_every_form_of_a_scene(tmp_path):
    wanted = poinsot.run(book)
    text = """! the same
       &scene t_end = 1, h = 0.01, method = 'dmv10' /
       &bodies moments = 0.376, 0.627, 1.0, y = 0, 0.6, -0.8 /
       &output every = 0.1 /
    """
    file = tmp_path/"a book.nml"
    file.write_text(text)
    for scene in (text, file, str(file)):
        assert (poinsot.run(scene).q == wanted.q).all()


def test_several_kinds_of_bodies():
    scene = {**book, "bodies": [{"moments": [1, 2, 2.5], "count": 3, "y": [1, 2, 3]}, {"shape": "water"}]}
    run = poinsot.run(scene, set={"scene.t_end": 0.5, "bodies(2).y": [0, 0, 1]})
    assert run.body.tolist() == [0, 1, 2, 3] and run.t[-1] == 0.5
    assert (run.y[:, 0] == run.y[:, 2]).all() and (run.y[0, 3] == [0, 0, 1]).all()


def test_files_are_kept(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    run = poinsot.run(book, out="here")
    assert run.folder == tmp_path/"here"
    assert {"summary.txt", "trajectory.csv", "restart.txt"} <= {f.name for f in Path("here").iterdir()}


def test_a_scene_without_output():
    run = poinsot.run({k: v for k, v in book.items() if k != "output"})
    assert run.t.shape == (0,) and run.q.shape == (0, 1, 4) and run.summary["steps"] == 100


@pytest.mark.parametrize("scene, words", [
    ("free-bod", "nearest .* one is 'free-body'"),
    ({**book, "scene": {"t_end": 1, "h": -1}}, "h = -1.0 must be positive"),
    ({**book, "gravitation": {}}, "gravitation"),
])
def test_sentences(scene, words):
    with pytest.raises(poinsot.Error, match=words) as raised:
        poinsot.run(scene)
    assert raised.value.status == poinsot.Status.SCENE and not str(raised.value).startswith("poinsot:")


def test_what_is_no_scene():
    with pytest.raises(TypeError, match="bodies"):
        poinsot.run({**book, "bodies": 3})


def test_cost():
    cost = poinsot.cost("heavy-top", budget="3s", splittings=["srkn6", "omelyan4"], methods="exact", tol=[1e-6])
    assert set(cost.points["splitting"]) == {"srkn6", "omelyan4"} and "1e-06" in str(cost)
    row = cost.cheapest(1e-6)
    assert row["method"] == "exact" and row["momentum_median"] <= 1e-6 and f"exact + {row['splitting']}" in cost.text
    assert cost.cheapest(1e-30) is None


def test_choose():
    choice = poinsot.choose("heavy-top", 1e-6, budget="3s", splittings=["srkn6", "omelyan4"])
    assert choice["splitting"] in ("srkn6", "omelyan4") and choice["step h"] > 0
    assert poinsot.run(choice.scene).summary["splitting"] == choice["splitting"]
