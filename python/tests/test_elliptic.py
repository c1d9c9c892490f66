import numpy as np
import poinsot
import pytest
from poinsot import elliptic


def test_jacobi():
    u, m = np.linspace(-3, 3, 7), np.array([[0.0], [0.5], [1.0]])
    sn, cn, dn = elliptic.jacobi(u, m)
    assert sn.shape == (3, 7) and abs(sn**2 + cn**2 - 1).max() < 1e-15 and abs(dn**2 + m*sn**2 - 1).max() < 1e-15
    assert abs(sn[0] - np.sin(u)).max() < 1e-15 and abs(sn[2] - np.tanh(u)).max() < 1e-15
    am = elliptic.jacobi_am(u, m)
    assert abs(np.sin(am) - sn).max() < 1e-15 and abs(elliptic.f(am[:2], m[:2]) - u).max() < 2e-15


def test_numbers_and_the_complement():
    sn, _, dn = elliptic.jacobi(0.7, 1.0, 1e-30)
    assert isinstance(sn, float) and abs(sn - np.tanh(0.7)) < 1e-15 and abs(dn - 1/np.cosh(0.7)) < 1e-15
    assert abs(elliptic.k(1.0, 1e-30) - np.log(4e15)) < 3e-14  # 4 units


def test_complete_integrals():
    """Digital Library of Mathematical Functions, 19.2, 19.6; Gamma(1/4)."""
    assert abs(elliptic.k(0.5) - 1.8540746773013719184) < 1e-15
    assert abs(elliptic.e(0.5) - 1.3506438810476755025) < 1e-15
    assert (elliptic.k(0.0), elliptic.e(0.0), elliptic.e(1.0)) == pytest.approx((np.pi/2, np.pi/2, 1.0), rel=1e-15)
    assert abs(elliptic.pi(0.75, 0.0) - np.pi) < 2e-15  # pi/2/sqrt(1 - nu)
    m = np.linspace(0.05, 0.95, 19)
    legendre = elliptic.e(m)*elliptic.k(1 - m) + elliptic.e(1 - m)*elliptic.k(m) - elliptic.k(m)*elliptic.k(1 - m)
    assert abs(legendre - np.pi/2).max() < 4e-15


def test_incomplete_integrals():
    m = np.linspace(0.0, 0.9, 10)
    assert abs(elliptic.f(np.pi/2, m) - elliptic.k(m)).max() < 2e-15
    assert abs(elliptic.e_incomplete(np.pi/2, m) - elliptic.e(m)).max() < 2e-15
    assert abs(elliptic.pi_incomplete(-0.5, np.pi/2, m) - elliptic.pi(-0.5, m)).max() < 2e-15
    assert abs(elliptic.pi_incomplete(0.0, 0.8, m) - elliptic.f(0.8, m)).max() < 1e-15


def test_carlson():
    """Values of Carlson 1995, Numerical computation of real or complex elliptic integrals, section 3."""
    assert abs(elliptic.carlson_rf(1.0, 2.0, 0.0) - 1.3110287771461) < 1e-13
    assert abs(elliptic.carlson_rc(0.0, 0.25) - np.pi) < 1e-15
    assert abs(elliptic.carlson_rc(0.25, -2.0) - np.log(2)/3) < 1e-15
    assert abs(elliptic.carlson_rd(0.0, 2.0, 1.0) - 1.7972103521034) < 1e-13
    assert abs(elliptic.carlson_rj(2.0, 3.0, 4.0, 5.0) - 0.14297579667157) < 3e-14
    assert abs(elliptic.carlson_rj(2.0, 3.0, 4.0, -0.5) - 0.24723819703052) < 1e-13
    assert elliptic.carlson_rf([1.0, 4.0], [[1.0], [4.0]], 1.0).shape == (2, 2)


def test_out_of_the_domain():
    with pytest.raises(poinsot.Error, match="element 1: .* m = 2.0 .* m from 0 to 1") as raised:
        elliptic.jacobi([1.0, 1.0], [0.0, 2.0])
    sn = raised.value.result[0]
    assert raised.value.status == poinsot.Status.DOMAIN and abs(sn[0] - np.sin(1.0)) < 1e-15 and np.isnan(sn[1])


@pytest.mark.parametrize("call, words", [
    (lambda: elliptic.jacobi_am(2e15, 0.5), r"^u = 2000000000000000.0, m = 0.5 is out of the domain: \|u\|"),
    (lambda: elliptic.k([[0.5, 1.0], [1.0, -1.0]]), r"element \(0, 1\): m = 1.0 is .*\(2 more without an answer\)"),
    (lambda: elliptic.e(1.5), "m is from 0 to 1"),
    (lambda: elliptic.pi(1.0, 0.5), "nu is below 1"),
    (lambda: elliptic.f(2.0, 1.0), "quarter turn"),
    (lambda: elliptic.e_incomplete(np.inf, 0.5), "phi = inf"),
    (lambda: elliptic.pi_incomplete(2.0, 1.5, 0.5), "pole"),
    (lambda: elliptic.carlson_rf(0.0, 0.0, 1.0), "one of them 0"),
    (lambda: elliptic.carlson_rc(1.0, 0.0), "y not 0"),
    (lambda: elliptic.carlson_rd(1.0, 1.0, 0.0), "z positive"),
    (lambda: elliptic.carlson_rj(1.0, 1.0, 1.0, 0.0), "p not 0"),
])
def test_sentences(call, words):
    with pytest.raises(poinsot.Error, match=words):
        call()


def test_arrays_that_do_not_fit():
    with pytest.raises(ValueError, match=r"\(2,\) of u, \(3,\) of m"):
        elliptic.jacobi([1, 2], [0, 0, 0])
    with pytest.raises(TypeError, match="real"):
        elliptic.k(0.5j)
    assert elliptic.k([]).shape == (0,)
