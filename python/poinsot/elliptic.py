"""Elliptic functions and integrals of arrays, accurate to a few ULP for every modulus.

The parameter is m = k^2, from 0 to 1; pass m1 = 1 - m if you know it more accurately than 1 - m gives, near m = 1. nu is the one in
1 - nu sin^2. Arguments are broadcast against each other; numbers give numbers. An element outside the domain is NaN in the
arrays, and the call raises poinsot.Error, whose `result` has them: the other elements are valid.

>>> print(k(0.5).round(12))
1.854074677301
"""
from __future__ import annotations

from typing import Any, Optional

from numpy.typing import ArrayLike

from ._elementwise import NUMBER, evaluate

__all__ = ["carlson_rc", "carlson_rd", "carlson_rf", "carlson_rj", "e", "e_incomplete", "f", "jacobi", "jacobi_am", "k", "pi",
           "pi_incomplete"]

_numbers = "x, y, z must not be negative, at most one of them 0"


def _function(name: str, domain: str, results: int = 1, **given: Optional[ArrayLike]) -> Any:
    return evaluate(name, {key: (value, NUMBER) for key, value in given.items()}, (NUMBER,)*results, domain)


def jacobi(u: ArrayLike, m: ArrayLike, m1: Optional[ArrayLike] = None) -> tuple[Any, Any, Any]:
    """sn, cn and dn of u, |u| <= 1e15."""
    values: tuple[Any, Any, Any] = _function("jacobi", "|u| is at most 1e15, and m from 0 to 1", 3, u=u, m=m, m1=m1)
    return values


def jacobi_am(u: ArrayLike, m: ArrayLike, m1: Optional[ArrayLike] = None) -> Any:
    """The amplitude am of u, |u| <= 1e15."""
    return _function("jacobi_am", "|u| is at most 1e15, and m from 0 to 1", u=u, m=m, m1=m1)


def k(m: ArrayLike, m1: Optional[ArrayLike] = None) -> Any:
    """The complete integral of the first kind K(m), m < 1."""
    return _function("elliptic_k", "m is from 0 to below 1", m=m, m1=m1)


def e(m: ArrayLike, m1: Optional[ArrayLike] = None) -> Any:
    """The complete integral of the second kind E(m)."""
    return _function("elliptic_e", "m is from 0 to 1", m=m, m1=m1)


def pi(nu: ArrayLike, m: ArrayLike, m1: Optional[ArrayLike] = None) -> Any:
    """The complete integral of the third kind Pi(nu, m), nu < 1, m < 1."""
    return _function("elliptic_pi", "nu is below 1, and m from 0 to below 1", nu=nu, m=m, m1=m1)


def f(phi: ArrayLike, m: ArrayLike, m1: Optional[ArrayLike] = None) -> Any:
    """The incomplete integral of the first kind F(phi, m), |phi| <= 1e15; m = 1 below a quarter turn only."""
    return _function("elliptic_f", "|phi| is at most 1e15, and m from 0 to below 1, or 1 below a quarter turn", phi=phi, m=m, m1=m1)


def e_incomplete(phi: ArrayLike, m: ArrayLike, m1: Optional[ArrayLike] = None) -> Any:
    """The incomplete integral of the second kind E(phi, m), |phi| <= 1e15."""
    return _function("elliptic_e_incomplete", "|phi| is at most 1e15, and m from 0 to 1", phi=phi, m=m, m1=m1)


def pi_incomplete(nu: ArrayLike, phi: ArrayLike, m: ArrayLike, m1: Optional[ArrayLike] = None) -> Any:
    """The incomplete integral of the third kind Pi(nu; phi, m), |phi| <= 1e15, not through a pole (nu sin^2 = 1)."""
    return _function("elliptic_pi_incomplete", "|phi| is at most 1e15, m from 0 to 1, and the integral must not reach a pole, "
                     "nu sin^2 = 1 or m sin^2 = 1", nu=nu, phi=phi, m=m, m1=m1)


def carlson_rf(x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Any:
    """Carlson's R_F(x, y, z): arguments not negative, at most one of them 0."""
    return _function("carlson_rf", _numbers, x=x, y=y, z=z)


def carlson_rc(x: ArrayLike, y: ArrayLike) -> Any:
    """Carlson's R_C(x, y): x not negative, y not 0; of a negative y the principal value."""
    return _function("carlson_rc", "x must not be negative, y not 0", x=x, y=y)


def carlson_rd(x: ArrayLike, y: ArrayLike, z: ArrayLike) -> Any:
    """Carlson's R_D(x, y, z): x and y not negative, at most one of them 0, z positive."""
    return _function("carlson_rd", "x and y must not be negative, at most one of them 0, and z positive", x=x, y=y, z=z)


def carlson_rj(x: ArrayLike, y: ArrayLike, z: ArrayLike, p: ArrayLike) -> Any:
    """Carlson's R_J(x, y, z, p): x, y, z not negative, at most one of them 0, p not 0; of a negative p the principal value."""
    return _function("carlson_rj", _numbers + "; p not 0", x=x, y=y, z=z, p=p)
