import numpy as np
import poinsot
import pytest
from poinsot import quaternion

conventions = ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"]
i, j, k = np.eye(4)[1:]


@pytest.fixture
def attitudes():
    return quaternion.random(200, 7)


def apart(p, q):
    return quaternion.distance(p, q).max()


def test_hamilton():
    assert (quaternion.multiply(i, j) == k).all() and (quaternion.multiply(j, i) == -k).all()
    assert quaternion.multiply(np.zeros((5, 1, 4)), np.zeros((3, 4))).shape == (5, 3, 4)


def test_random():
    q = quaternion.random((5, 40), 7)
    assert q.shape == (5, 40, 4) and (q.reshape(-1, 4) == quaternion.random(200, 7)).all()
    assert abs(np.linalg.norm(q, axis=-1) - 1).max() < 1e-15 and not (q == quaternion.random((5, 40), 8)).any()
    with pytest.raises(ValueError, match="negative"):
        quaternion.random(-1, 7)
    with pytest.raises(ValueError, match="64 bits"):
        quaternion.random(1, 2**63)


def test_algebra(attitudes):
    p = attitudes[::-1]*np.linspace(0.5, 2, 200)[:, np.newaxis]
    one = np.array([1.0, 0, 0, 0])
    assert abs(quaternion.multiply(p, quaternion.inverse(p)) - one).max() < 1e-15
    assert (quaternion.conjugate(attitudes) == attitudes*[1, -1, -1, -1]).all()
    assert abs(np.linalg.norm(quaternion.normalize(p), axis=1) - 1).max() < 1e-15
    assert abs(quaternion.exp(quaternion.log(p)) - p).max() < 4e-15
    assert quaternion.exp([0, np.pi/4, 0, 0]) == pytest.approx([0.5**0.5, 0.5**0.5, 0, 0], rel=1e-15)


def test_rotate_is_the_matrix(attitudes):
    v = np.random.default_rng(3).normal(size=(200, 3))
    m = quaternion.to_matrix(attitudes)
    assert m.shape == (200, 3, 3) and abs(np.linalg.det(m) - 1).max() < 2e-15
    w = quaternion.rotate(attitudes, v)
    assert abs(w - np.einsum("nij,nj->ni", m, v)).max() < 4e-15
    assert abs(quaternion.rotate_back(attitudes, w) - v).max() < 4e-15
    assert quaternion.rotate(attitudes, [0, 0, 1]) == pytest.approx(m[:, :, 2], abs=1e-15)


def test_there_and_back(attitudes):
    q = attitudes
    assert apart(quaternion.from_matrix(quaternion.to_matrix(q)), q) < 2e-15
    assert apart(quaternion.nearest(3*quaternion.to_matrix(q)), q) < 4e-15
    assert apart(quaternion.from_rotation_vector(quaternion.to_rotation_vector(q)), q) < 2e-15
    axis, angle = quaternion.to_axis_angle(q)
    assert axis.shape == (200, 3) and angle.shape == (200,) and apart(quaternion.from_axis_angle(5*axis, angle), q) < 2e-15
    assert apart(quaternion.from_cayley(quaternion.to_cayley(q)), q) < 2e-15


@pytest.mark.parametrize("convention", conventions)
def test_euler(attitudes, convention):
    angles = quaternion.to_euler(convention, attitudes)
    assert apart(quaternion.from_euler(convention, angles), attitudes) < 4e-15
    turns = [quaternion.from_axis_angle(np.eye(3)["xyz".index(axis)], angles[:, n]) for n, axis in enumerate(convention)]
    assert apart(quaternion.multiply(turns[0], quaternion.multiply(turns[1], turns[2])), attitudes) < 4e-15


def test_between(attitudes):
    p, q = attitudes[:100], attitudes[100:]
    assert apart(quaternion.slerp(p, q, 0.0), p) < 2e-15 and apart(quaternion.slerp(p, q, 1.0), q) < 2e-15
    middle = quaternion.slerp(p, q, 0.5)
    assert abs(quaternion.distance(middle, p) - quaternion.distance(middle, q)).max() < 4e-15
    assert quaternion.slerp(p[0], q[0], np.linspace(0, 1, 11)).shape == (11, 4)
    a, b = np.random.default_rng(4).normal(size=(2, 100, 3))
    turned = quaternion.rotate(quaternion.shortest_arc(a, b), a)/np.linalg.norm(a, axis=1)[:, np.newaxis]
    assert abs(turned - b/np.linalg.norm(b, axis=1)[:, np.newaxis]).max() < 4e-15


def test_numbers():
    assert isinstance(quaternion.distance(i, j), float)
    axis, angle = quaternion.to_axis_angle([1, 0, 0, 0])
    assert axis.tolist() == [1, 0, 0] and isinstance(angle, float) and angle == 0


def test_without_an_answer():
    with pytest.raises(poinsot.Error, match=r"element 1: q = \[2.0, 0.0, 0.0, 0.0\] is out of the domain: .*1e-6") as raised:
        quaternion.to_matrix([[1, 0, 0, 0], [2, 0, 0, 0]])
    assert raised.value.status == poinsot.Status.DOMAIN
    assert (raised.value.result[0] == np.eye(3)).all() and np.isnan(raised.value.result[1]).all()


@pytest.mark.parametrize("call, words", [
    (lambda: quaternion.inverse([0, 0, 0, 0]), "must not be zero"),
    (lambda: quaternion.normalize([0, 0, 0, np.inf]), "finite"),
    (lambda: quaternion.exp([800, 0, 0, 0]), "709"),
    (lambda: quaternion.to_cayley([0, 1, 0, 0]), "half-turn"),
    (lambda: quaternion.from_matrix(np.diag([1, 1, -1])), "determinant"),
    (lambda: quaternion.nearest(np.zeros((3, 3))), "nearest"),
    (lambda: quaternion.from_axis_angle([0, 0, 0], 1), "axis"),
    (lambda: quaternion.shortest_arc([0, 0, 0], [0, 0, 1]), "not zero"),
    (lambda: quaternion.from_euler("xxz", [0, 0, 0]), "Euler angles 'xxz'; allowed are xyz"),
])
def test_sentences(call, words):
    with pytest.raises(poinsot.Error, match=words):
        call()


def test_shapes():
    with pytest.raises(ValueError, match=r"q must have the shape \(\.\.\., 4\), not \(3,\)"):
        quaternion.conjugate([1, 2, 3])
    with pytest.raises(ValueError, match=r"m must have the shape \(\.\.\., 3, 3\), not \(9,\)"):
        quaternion.from_matrix(np.zeros(9))
    with pytest.raises(ValueError, match=r"\(2,\) of q, \(3,\) of v"):
        quaternion.rotate(np.tile(i, (2, 1)), np.zeros((3, 3)))
    assert quaternion.to_matrix(np.empty((0, 4))).shape == (0, 3, 3)
