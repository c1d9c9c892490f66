import copy
import os
import pickle
import signal
import threading

import numpy as np
import poinsot
import pytest

top_end = [1.922573381663007, 0.7720232344670848, -0.2011054792035490]  # Hairer and Vilmart 2006, section 5


def top(**options):
    plan = poinsot.Plan(**options)
    assert plan.add_class([0.6, 0.8, 1.0]) == 0
    return plan


def start():
    return np.array([1.8, 0.4, -0.9]), np.array([1.0, 0.0, 0.0, 0.0])


def upwards(q):
    """The vertical in the body frame: the third row of the rotation matrix."""
    w, x, y, z = np.moveaxis(q, -1, 0)
    return np.stack([2*(x*z - w*y), 2*(y*z + w*x), 1 - 2*(x*x + y*y)], axis=-1)


def gravity(t, q):
    return np.cross(upwards(q), [0.0, 0.0, 1.0])


def test_heavy_top():
    plan = top()
    plan.add_effect("gravity", centre=[0, 0, 1], weight=1)
    y, q = plan.step(*start(), 0.02, steps=500)
    assert abs(y - top_end).max() < 1e-11
    kinetic, potential = plan.energy(y, q)
    assert abs(kinetic + potential - 4.205) < 1e-14*4.205  # 15 kicks a step, 500 steps, plain sums
    assert abs(plan.momentum(y, q)[2] + 0.9) < 1e-14


def test_torque_function_of_one_body():
    shapes = set()

    def torque(t, q):
        shapes.add(q.shape)
        return gravity(t, q)

    y, q = top().step(*start(), 0.02, steps=500, torque=torque)
    assert abs(y - top_end).max() < 1e-11 and shapes == {(4,)}


def test_torque_function_of_many(crowd):
    plan = top()
    plan.add_effect("gravity", centre=[0, 0, 1])
    wanted = plan.step(*(a.copy() for a in crowd), 0.02, 20)
    kept = []

    def torque(t, q):
        kept.append((t, q))
        return gravity(t, q)

    y, q = top().step(*(a.copy() for a in crowd), 0.02, 20, t=3.0, torque=torque)
    assert abs(y - wanted[0]).max() < 1e-13 and abs(q - wanted[1]).max() < 1e-13
    assert kept[0][0] >= 3.0 and kept[-1][0] <= 3.4 + 1e-12
    assert all(abs(np.linalg.norm(q, axis=1) - 1).max() < 1e-12 for _, q in kept)  # copies, so still attitudes


def test_torque_with_the_scalar_last():
    y, q = start()
    last = np.roll(q, -1)
    seen = []
    top(order="xyzw").step(y, last, 0.1, 3, torque=lambda t, q: seen.append(q) or gravity(t, np.roll(q, 1)))
    wanted = top().step(*start(), 0.1, 3, torque=gravity)
    assert (y == wanted[0]).all() and (np.roll(last, 1) == wanted[1]).all()


@pytest.mark.parametrize("failure", [ZeroDivisionError, KeyboardInterrupt, SystemExit])
def test_exceptions_in_a_torque_propagate(failure):
    calls = []

    def torque(t, q):
        calls.append(t)
        if t > 0.5:
            raise failure("here")
        return gravity(t, q)

    y, q = start()
    with pytest.raises(failure, match="here"):
        top().step(y, q, 0.1, 1000, torque=torque)
    assert len(calls) < 200
    wanted = top().step(*start(), 0.1, 5, torque=gravity)  # the state before the step that was stopped
    assert (y == wanted[0]).all() and (q == wanted[1]).all()


@pytest.fixture
def interrupts():
    """Ctrl-C raises, also where the tests run in the background of a script, whose programs ignore it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


def test_ctrl_c_during_steps(interrupts):
    """It stops the steps, and the program's own handler is back."""
    before = signal.getsignal(signal.SIGINT)
    plan = top()

    def torque(t, q):
        if 1 < t < 1.01:
            os.kill(os.getpid(), signal.SIGINT)
        return gravity(t, q)

    with pytest.raises(KeyboardInterrupt):
        plan.step(*start(), 0.01, 100000, torque=torque)
    assert signal.getsignal(signal.SIGINT) is before


def test_a_timer_interrupts_steps(interrupts):
    """Ctrl-C while the library computes: the next Python code would be the callback's first line."""
    plan = poinsot.Plan(threads=1)
    plan.add_class([1, 2, 2.5])
    y, q = np.tile([1.0, 2.0, 3.0], (200000, 1)), np.tile([1.0, 0.0, 0.0, 0.0], (200000, 1))
    zero = np.zeros_like(y)
    timer = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        plan.step(y, q, 1e-3, 100000, torque=lambda t, q: zero)
    timer.join()


@pytest.mark.parametrize("answer, words", [([1, 2], r"\(3,\)"), (None, r"\(3,\)"), ("up", "string|convert")])
def test_wrong_torques(answer, words):
    with pytest.raises((ValueError, TypeError), match=words):
        top().step(*start(), 0.1, torque=lambda t, q: answer)


def test_torque_that_is_not_finite():
    with pytest.raises(poinsot.Error) as raised:
        top().step(*start(), 0.1, torque=lambda t, q: [0, np.nan, 0])
    assert raised.value.status == poinsot.Status.PARTIAL and raised.value.each.tolist()[0] != 0


def test_kick_and_drift_are_a_step():
    kicks, drifts = poinsot.splitting_flows("strang")
    y, q = start()
    plan = top()
    for kick, drift in zip(kicks, drifts):
        if kick:
            plan.kick(y, q, kick*0.1, gravity(0, q))
        if drift:
            plan.drift(y, q, drift*0.1)
    wanted = top(splitting="strang").step(*start(), 0.1, torque=gravity)
    assert abs(y - wanted[0]).max() < 1e-15 and abs(q - wanted[1]).max() < 1e-15


def test_dissipate_is_the_middle_of_baoab(crowd):
    plan = poinsot.Plan(splitting="baoab", seed=4)
    plan.add_class([0.6, 0.8, 1.0])
    plan.add_effect("langevin", rate=1, temperature=0.5)
    y, q = (a.copy() for a in crowd)
    plan.drift(y, q, 0.05)
    plan.dissipate(y, q, 0.1, 6)
    plan.drift(y, q, 0.05)
    wanted = plan.step(*(a.copy() for a in crowd), 0.1, first=6)
    assert np.array_equal(y, wanted[0]) and np.array_equal(q, wanted[1])
    with pytest.raises(poinsot.Error):
        plan.dissipate(y, q, -0.1, 6)


def test_kick_of_rows(crowd):
    y, q = (a.copy() for a in crowd)
    torque = np.asfortranarray(crowd[0])
    top().kick(y, q, 0.5, torque)
    assert abs(y - 1.5*crowd[0]).max() < 1e-15
    with pytest.raises(ValueError, match="3 rows for 50"):
        top().kick(y, q, 0.5, torque[:3])


def test_classes_count_from_0(crowd):
    plan = poinsot.Plan()
    moments = [[1, 2, 2.5], [3, 3, 1]]
    assert [plan.add_class(m) for m in moments] == [0, 1]
    which = np.arange(50) % 2
    y, q = plan.drift(*(a.copy() for a in crowd), 0.2, body_class=which)
    for k, m in enumerate(moments):
        wanted = poinsot.Body(m).rotate(*(a[k::2].copy() for a in crowd), 0.2)
        assert (y[k::2] == wanted[0]).all() and (q[k::2] == wanted[1]).all()
    with pytest.raises(TypeError, match="integers"):
        plan.drift(y, q, 0.2, body_class=which*1.0)
    with pytest.raises(poinsot.Error):
        plan.drift(y, q, 0.2, body_class=np.full(50, 2))


def test_find_class():
    """Moments that differ by rounding are of one class; copies of the plan have the same numbers."""
    random = np.random.default_rng(6)
    plan = poinsot.Plan()
    numbers = [plan.find_class(m*(1 + 1e-9*random.normal(size=3))) for m in np.tile([[1, 2, 2.5], [2.5, 2, 1]], (100, 1))]
    assert numbers == [0, 1]*100
    assert plan.find_class([1, 2, 2.6]) == 2 and plan.find_class([1, 2, 2.52], tolerance=0.1) == 0
    for other in (copy.copy(plan), pickle.loads(pickle.dumps(plan))):
        assert other.find_class([1, 2, 2.6]) == 2 and other.add_class([1, 1, 1]) == 3
    with pytest.raises(poinsot.Error, match="tolerance"):
        plan.find_class([1, 2, 2.5], -1.0)


def test_effect_on_a_class():
    plan = poinsot.Plan()
    for _ in range(2):
        plan.add_class([0.6, 0.8, 1.0])
    plan.add_effect("gravity", centre=np.array([0, 0, 1.0]), body_class=1)
    y, q = (np.tile(a, (2, 1)) for a in start())
    plan.step(y, q, 0.02, 10, body_class=[0, 1])
    free = top().drift(*start(), 0.2)
    assert abs(y[0] - free[0]).max() < 1e-14 and abs(y[1] - free[0]).max() > 1e-3
    with pytest.raises(TypeError, match="body_class"):
        plan.add_effect("gravity", centre=[0, 0, 1], **{"class": 1})


def test_rotor_that_changes():
    def plan(name, **keys):
        made = poinsot.Plan(splitting="srkn6")
        made.add_class([0.6, 0.8, 1.0])
        made.add_effect(name, **keys)
        return made

    wheel = plan("gyrostat", times=[0, 1, 1, 2], table=[[0, 0, 0.1], [0, 0, 1], [0, 0.5, 1], [0, 0, 0]])
    y, q = wheel.step(*start(), 0.01, steps=200)
    assert abs(np.linalg.norm(y) - np.linalg.norm(start()[0])) < 1e-13
    with pytest.raises(poinsot.Error, match="not given the time"):
        wheel.drift(y, q, 0.1)
    constant = plan("gyrostat", times=[0, 1], table=[[0.1, 0.2, 0.3]]*2).step(*start(), 0.01, steps=200)
    same = plan("gyrostat", rotor=[0.1, 0.2, 0.3]).step(*start(), 0.01, steps=200)
    assert abs(constant[0] - same[0]).max() < 1e-15


@pytest.mark.parametrize("layout", ["native", "lammps", "dl_poly", "hoomd"])
def test_layouts_and_views(layout, crowd):
    plan = poinsot.Plan(layout=layout)
    plan.add_class([1, 2, 2.5])
    k = 4 if layout == "hoomd" else 3
    momenta = np.zeros((50, k))
    momenta[:, :3] = crowd[0]
    q = crowd[1]
    wanted = plan.drift(momenta.copy(), q.copy(), 0.1)
    both = np.hstack([momenta, q, np.full((50, 2), 7.0)])
    plan.drift(both[:, :k], both[:, k:k + 4], 0.1)
    assert (both[:, :k] == wanted[0]).all() and (both[:, k:k + 4] == wanted[1]).all() and (both[:, k + 4:] == 7).all()
    y, q = np.asfortranarray(momenta), np.asfortranarray(q)
    plan.drift(y, q, 0.1)
    assert (y == wanted[0]).all() and (q == wanted[1]).all()
    y, q = momenta[::-1].copy()[::-1], crowd[1][::-1].copy()[::-1]
    plan.drift(y, q, 0.1)
    assert (y == wanted[0]).all() and (q == wanted[1]).all()


def test_bits_do_not_depend_on_threads(crowd):
    y, q = np.tile(crowd[0], (20, 1)), np.tile(crowd[1], (20, 1))
    ends = [top(threads=k).drift(y.copy(), q.copy(), 0.1) for k in (1, 2, 7, None)]
    assert all((end[0] == ends[0][0]).all() and (end[1] == ends[0][1]).all() for end in ends)


def test_long_calls_take_a_team(crowd, monkeypatch):
    monkeypatch.setattr("poinsot._plan._THREADED", 0.0)
    plan = top()
    plan.add_effect("gravity", centre=[0, 0, 1])
    y, q = plan.step(*(a.copy() for a in crowd), 0.02, 20)
    assert plan._team is not None
    plan = top(threads=1)
    plan.add_effect("gravity", centre=[0, 0, 1])
    wanted = plan.step(*(a.copy() for a in crowd), 0.02, 20)
    assert plan._team is None and (y == wanted[0]).all() and (q == wanted[1]).all()


def test_carry_and_noise_go_on(crowd):
    plan = poinsot.Plan(seed=5)
    plan.add_class([1, 2, 2.5])
    plan.add_effect("langevin", friction=[0.1, 0.2, 0.3], temperature=1.5)
    wanted = plan.step(*(a.copy() for a in crowd), 0.1, 8, id=np.arange(50), carry=np.zeros((50, 7)))
    y, q = (a.copy() for a in crowd)
    carry = np.zeros((50, 7))
    plan.step(y, q, 0.1, 3, id=np.arange(50), carry=carry)
    plan.step(y, q, 0.1, 5, t=0.3, first=3, id=range(50), carry=carry)
    assert (y == wanted[0]).all() and (q == wanted[1]).all() and carry.any()
    with pytest.raises(TypeError, match="carry"):
        plan.step(y, q, 0.1, carry=np.zeros((50, 6)))


def test_what_is_only_read_may_be_anything():
    plan = top()
    kinetic, potential = plan.energy([[1, 0, 0], [0, 1, 0]], [[1, 0, 0, 0]]*2)
    assert abs(kinetic - [1/1.2, 1/1.6]).max() < 1e-15 and not potential.any()
    assert plan.degrees_of_freedom([1, 0, 0], [1, 0, 0, 0]) == 3


def test_tensor_class_keeps_its_frame():
    turn, _ = np.linalg.qr(np.random.default_rng(2).normal(size=(3, 3)))
    tensor = turn @ np.diag([0.6, 0.8, 1.0]) @ turn.T
    plan = poinsot.Plan()
    plan.add_class_tensor((tensor + tensor.T)/2)
    y, q = start()
    axes = plan.class_axes(0)
    diagonal = axes.T @ tensor @ axes
    assert abs(diagonal - np.diag(np.diag(diagonal))).max() < 1e-14
    with pytest.raises(poinsot.Error, match="no class 1"):
        plan.class_axes(1)
    kinetic, _ = plan.energy(y, q)
    assert abs(kinetic - y @ np.linalg.solve(tensor, y)/2) < 1e-14
    momentum = plan.momentum(y, q)
    plan.drift(y, q, 3.0)
    assert abs(plan.momentum(y, q) - momentum).max() < 1e-13


@pytest.mark.parametrize("make, words", [
    (lambda: poinsot.Plan(method="exakt"), "exakt"),
    (lambda: poinsot.Plan(splitting="srkn7"), "srkn7"),
    (lambda: poinsot.Plan(layout="gromacs"), "gromacs"),
    (lambda: poinsot.Plan(threads=-1), "threads"),
    (lambda: poinsot.Plan(colour="red"), "colour"),
    (lambda: top().add_effect("gravity", centr=[0, 0, 1]), "'centr'.*'centre'"),
    (lambda: top().add_effect("levity"), "levity"),
])
def test_sentences(make, words):
    with pytest.raises(poinsot.Error, match=words):
        make()


def test_a_plan_without_classes():
    """It takes bodies that bring their moments, no others."""
    wanted = top().drift(*start(), 0.1)
    plan = poinsot.Plan()
    y, q = plan.drift(*(a[np.newaxis] for a in start()), 0.1, moments=[[0.6, 0.8, 1.0]])
    assert abs(y - wanted[0]).max() < 1e-15 and abs(q - wanted[1]).max() < 1e-15
    with pytest.raises(poinsot.Error, match="1 of 1 bodies failed") as raised:
        plan.drift(*start(), 0.1)
    assert raised.value.each.tolist() == [poinsot.Status.DOMAIN]


def test_closed_plan():
    plan = top().ready()
    with pytest.raises(poinsot.Error, match="cannot be changed"):
        plan.add_class([1, 1, 1])
    with pytest.raises(TypeError, match="body_clas"):
        plan.drift(*start(), 0.1, body_clas=[0])


def test_copies():
    plan = poinsot.Plan("dmv8", "srkn4", order="xyzw", threads=1)
    plan.add_class([0.6, 0.8, 1.0])
    plan.add_effect("gravity", centre=[0, 0, 1])
    y, q = start()
    wanted = plan.step(y.copy(), np.roll(q, -1), 0.05, 5)
    for other in (copy.deepcopy(plan), pickle.loads(pickle.dumps(plan))):
        assert other.add_class([1, 2, 2.5]) == 1  # takes changes again
        ends = other.step(y.copy(), np.roll(q, -1), 0.05, 5, body_class=None)
        assert (ends[0] == wanted[0]).all() and (ends[1] == wanted[1]).all()


def test_shared_by_threads(crowd):
    plan = top()
    wanted = plan.drift(*(a.copy() for a in crowd), 0.1)
    ends = []
    workers = [threading.Thread(target=lambda: ends.append(plan.drift(*(a.copy() for a in crowd), 0.1))) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(ends) == 4 and all((end[0] == wanted[0]).all() for end in ends)


def test_rows_of_choice(crowd):
    plan = top()
    which = np.array([7, 3, 40])
    wanted = plan.drift(crowd[0][which], crowd[1][which], 0.1)
    y, q = (a.copy() for a in crowd)
    plan.drift(y, q, 0.1, y_at=which, q_at=which)
    rest = np.setdiff1d(np.arange(50), which)
    assert (y[which] == wanted[0]).all() and (q[which] == wanted[1]).all()
    assert (y[rest] == crowd[0][rest]).all() and (q[rest] == crowd[1][rest]).all()
    y, q = crowd[0].copy(), crowd[1][which]
    plan.drift(y, q, 0.1, y_at=which)
    assert (y[which] == wanted[0]).all() and (q == wanted[1]).all()
    with pytest.raises(poinsot.Error) as raised:
        plan.drift(y, q, 0.1, y_at=[0, 1, 50])
    assert raised.value.status == poinsot.Status.SIZE
    with pytest.raises(ValueError, match="y_at has 2 rows, q has 3"):
        plan.drift(y, q, 0.1, y_at=[0, 1])


def test_moments_of_each_body(crowd):
    scale = np.linspace(0.5, 2, 50)
    wanted = [poinsot.Body(s*np.array([0.6, 0.8, 1.0])).rotate(y.copy(), q.copy(), 0.1) for s, y, q in zip(scale, *crowd)]
    plan = top()
    scaled = plan.drift(*(a.copy() for a in crowd), 0.1, scale=scale)
    own = plan.drift(*(a.copy() for a in crowd), 0.1, moments=scale[:, np.newaxis]*[0.6, 0.8, 1.0])
    for y, q in (scaled, own):
        assert abs(y - [end[0] for end in wanted]).max() < 1e-14 and abs(q - [end[1] for end in wanted]).max() < 1e-14
    with pytest.raises(ValueError, match="scale"):
        plan.drift(*(a.copy() for a in crowd), 0.1, scale=scale[:3])


def test_skipped_bodies(crowd):
    y, q = (a.copy() for a in crowd)
    top().drift(y, q, 0.1, body_class=np.where(np.arange(50) == 4, -1, 0))
    assert (y[4] == crowd[0][4]).all() and (y[5] != crowd[0][5]).any()
