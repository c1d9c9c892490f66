import numpy as np
import poinsot
import pytest


def test_jacobi():
    u, m = np.linspace(-3, 3, 7), np.array([[0.0], [0.5], [1.0]])
    sn, cn, dn = poinsot.elliptic.jacobi(u, m)
    assert sn.shape == (3, 7) and abs(sn**2 + cn**2 - 1).max() < 1e-15 and abs(dn**2 + m*sn**2 - 1).max() < 1e-15
    assert abs(sn[0] - np.sin(u)).max() < 1e-15 and abs(sn[2] - np.tanh(u)).max() < 1e-15


def test_numbers_and_the_complement():
    sn, _, dn = poinsot.elliptic.jacobi(0.7, 1.0, 1e-30)
    assert isinstance(sn, float) and abs(sn - np.tanh(0.7)) < 1e-15 and abs(dn - 1/np.cosh(0.7)) < 1e-15


def test_out_of_the_domain():
    with pytest.raises(poinsot.Error, match="element 1 .* m = 2.0") as raised:
        poinsot.elliptic.jacobi([1.0, 1.0], [0.0, 2.0])
    sn = raised.value.result[0]
    assert raised.value.status == poinsot.Status.DOMAIN and abs(sn[0] - np.sin(1.0)) < 1e-15 and np.isnan(sn[1])
