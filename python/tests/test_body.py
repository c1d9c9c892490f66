import copy
import pickle
import threading
import time

import numpy as np
import poinsot
import pytest

book = [0.376, 0.627, 1.0]
published = [0.0545936805170048, -0.5930307093190378, -0.8033268997439126]  # Vilmart 2013, figure 1


@pytest.mark.parametrize("method, h, steps", [("exact", 40.0, 1), ("jacobi", 40.0, 1), ("dmv10", 0.01, 4000)])
def test_published_end(y, q, method, h, steps):
    poinsot.Body(book).rotate(y, q, h, steps, method)
    assert abs(y - published).max() < 2e-14


def test_in_place_and_returned(y, q):
    momenta, attitudes = poinsot.Body(book).rotate(y, q, 1.0)
    assert momenta is y and attitudes is q and y[0] != 0


def test_many_are_as_one(y, q):
    body = poinsot.Body(book)
    momenta, attitudes = np.tile(y, (1000, 1)), np.tile(q, (1000, 1))
    body.rotate(momenta, attitudes, 0.1, 10)
    body.rotate(y, q, 0.1, 10)
    assert (momenta == y).all() and (attitudes == q).all()


def test_back_again(crowd):
    y, q = (a.copy() for a in crowd)
    body = poinsot.Body([1, 2, 2.5])
    body.rotate(y, q, 0.3, 7)
    body.rotate(y, q, -0.3, 7)
    assert abs(y - crowd[0]).max() < 1e-14 and abs(q - crowd[1]).max() < 1e-14


@pytest.mark.parametrize("view", [lambda a: a[::2], lambda a: a[::-1], lambda a: np.asfortranarray(a),
                                  lambda a: np.hstack([a, a])[:, :a.shape[1]]])
def test_views_are_changed_too(crowd, view):
    body = poinsot.Body(book)
    wanted = body.rotate(*(np.ascontiguousarray(view(a.copy())) for a in crowd), 0.2)
    y, q = (view(a.copy()) for a in crowd)
    assert not y.flags.c_contiguous
    body.rotate(y, q, 0.2)
    assert (y == wanted[0]).all() and (q == wanted[1]).all()


def test_view_writes_into_its_base(crowd):
    both = np.hstack(crowd)
    before = both.copy()
    poinsot.Body(book).rotate(both[::2, :3], both[::2, 3:], 0.2)
    assert (both[1::2] == before[1::2]).all() and (both[::2] != before[::2]).any(axis=1).all()


@pytest.mark.parametrize("bad, error, words", [
    (lambda y, q: ([0, 1, 2], q), TypeError, "not list"),
    (lambda y, q: (np.array([0, 1, 2]), q), TypeError, "int64"),
    (lambda y, q: (y.astype(np.float32), q), TypeError, "float32"),
    (lambda y, q: (y, q[:3]), ValueError, r"\(4,\)"),
    (lambda y, q: (y[np.newaxis], q), ValueError, "one has one body"),
    (lambda y, q: (np.zeros((2, 3)), np.zeros((3, 4))), ValueError, "2 rows"),
    (lambda y, q: (q[:3], q), ValueError, "overlap"),
    (lambda y, q: (np.broadcast_to(y, (2, 3)), np.tile(q, (2, 1))), ValueError, "read-only"),
])
def test_arrays_that_cannot_be_changed(y, q, bad, error, words):
    with pytest.raises(error, match=words):
        poinsot.Body(book).rotate(*bad(y, q), 0.1)


def test_failed_bodies_keep_their_state(crowd):
    y, q = (a.copy() for a in crowd)
    y[3], q[7] = np.nan, 2.0
    with pytest.raises(poinsot.Error, match="2 of 50 bodies failed, the first of them body 3") as raised:
        poinsot.Body(book).rotate(y, q, 0.2)
    each = raised.value.each
    assert raised.value.status == poinsot.Status.PARTIAL
    assert np.flatnonzero(each).tolist() == [3, 7] and (q[7] == 2.0).all()
    wanted = poinsot.Body(book).rotate(crowd[0][:3].copy(), crowd[1][:3].copy(), 0.2)
    assert (y[:3] == wanted[0]).all()


def test_statuses_instead_of_an_exception(crowd):
    y, q = (a.copy() for a in crowd)
    y[3] = np.inf
    each = np.full(50, 99, np.int32)
    poinsot.Body(book).rotate(y, q, 0.2, status=each)
    assert np.flatnonzero(each).tolist() == [3]
    with pytest.raises(TypeError, match="int32"):
        poinsot.Body(book).rotate(y, q, 0.2, status=np.zeros(50))


def test_errors_of_the_library(y, q):
    with pytest.raises(poinsot.Error) as raised:
        poinsot.Body([1, 2, 30])
    assert raised.value.status == poinsot.Status.DOMAIN
    with pytest.raises(poinsot.Error, match="no method 'exakt'") as raised:
        poinsot.Body(book).rotate(y, q, 1.0, method="exakt")
    assert raised.value.status == poinsot.Status.METHOD
    with pytest.raises(ValueError, match="negative"):
        poinsot.Body(book).rotate(y, q, 1.0, -1)
    assert pickle.loads(pickle.dumps(raised.value)).status == poinsot.Status.METHOD


def test_tensor():
    turn, _ = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))
    tensor = turn @ np.diag(book) @ turn.T
    body = poinsot.Body.from_tensor((tensor + tensor.T)/2)
    assert abs(np.sort(body.moments) - book).max() < 1e-14
    assert abs(body.axes @ np.diag(body.moments) @ body.axes.T - tensor).max() < 1e-14
    with pytest.raises(ValueError, match=r"\(3, 3\)"):
        poinsot.Body.from_tensor(book)


def test_copies(y, q):
    for body in (poinsot.Body(book), poinsot.Body.from_tensor(np.diag(book))):
        for other in (copy.copy(body), pickle.loads(pickle.dumps(body))):
            first, second = body.rotate(y.copy(), q.copy(), 3.0), other.rotate(y.copy(), q.copy(), 3.0)
            assert (first[0] == second[0]).all() and (first[1] == second[1]).all()


def test_no_bodies():
    y, q = poinsot.Body(book).rotate(np.empty((0, 3)), np.empty((0, 4)), 1.0)
    assert y.shape == (0, 3) and q.shape == (0, 4)


def test_other_threads_run_meanwhile(crowd):
    """The GIL is free during a call: another thread counts while this one turns."""
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0)

    thread = threading.Thread(target=count)
    y, q = np.tile(crowd[0], (200, 1)), np.tile(crowd[1], (200, 1))
    body = poinsot.Body(book)
    thread.start()
    try:
        before = counted[0]
        for _ in range(100):  # one call is more than enough on any machine that runs the other thread at all
            body.rotate(y, q, 1e-3, 1000)
            if counted[0] > before + 1:
                break
    finally:
        stop.set()
        thread.join()
    assert counted[0] > before + 1


def test_points():
    """Eight equal masses on the corners of a box: I1 = 8 m (b^2 + c^2) and so on, wherever it stands."""
    a, b, c = 3.0, 2.0, 1.0
    corners = np.array([[x, y, z] for x in (-a, a) for y in (-b, b) for z in (-c, c)])
    turn, _ = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))
    body = poinsot.Body.from_points(np.full(8, 0.5), corners @ turn.T + [10, 20, 30])
    assert body.moments == pytest.approx([4*(b*b + c*c), 4*(a*a + c*c), 4*(a*a + b*b)], rel=1e-14)
    assert body.centre == pytest.approx([10, 20, 30], rel=1e-15) and body.mass == 4
    inside = (corners @ turn.T) @ body.axes
    assert np.allclose(np.sort(abs(inside), axis=0), np.sort(abs(corners), axis=0), atol=1e-13)
    for other in (copy.copy(body), pickle.loads(pickle.dumps(body))):
        assert (other.axes == body.axes).all() and (other.centre == body.centre).all()


def test_points_on_a_line():
    body = poinsot.Body.from_points([1, 1], [[0, 0, 0], [2, 2, 1]])
    assert body.moments.tolist() == [0, body.moments[1], body.moments[1]] and body.moments[1] == pytest.approx(4.5, rel=1e-15)
    y, q = body.rotate(np.array([0.0, 0.6, -0.8]), np.array([1.0, 0, 0, 0]), 3.0)
    assert y == pytest.approx([0, 0.6, -0.8], abs=1e-15)


@pytest.mark.parametrize("mass, x, error, words", [
    ([1, -1], [[0, 0, 0], [1, 0, 0]], poinsot.Error, "zero or positive"),
    ([0, 0], [[0, 0, 0], [1, 0, 0]], poinsot.Error, "not all zero"),
    ([1], [[1, 2, 3]], poinsot.Error, "a point does not turn"),
    ([1, 1, 1], [[0, 0, 0], [1, 0, 0]], ValueError, r"mass must have the shape \(2,\)"),
    ([1, 1], [[0, 0], [1, 0]], ValueError, r"x must have the shape \(2, 3\)"),
    ([], np.empty((0, 3)), ValueError, "at least one"),
])
def test_points_that_are_no_body(mass, x, error, words):
    with pytest.raises(error, match=words):
        poinsot.Body.from_points(mass, x)


def test_moments_are_those_of_the_class():
    """Of a linear body exactly zero, as the library takes it."""
    turn, _ = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))
    tensor = turn @ np.diag([0, 1.0, 1.0]) @ turn.T
    assert poinsot.Body.from_tensor((tensor + tensor.T)/2).moments[0] == 0


def test_sentences():
    with pytest.raises(poinsot.Error, match="30"):
        poinsot.Body([1, 2, 30])
    with pytest.raises(poinsot.Error, match="symmetric"):
        poinsot.Body.from_tensor([[1, 0, 0], [0.5, 1, 0], [0, 0, 1]])
