"""States that many tests begin from."""
import numpy as np
import pytest


@pytest.fixture
def y():
    return np.array([0.0, 0.6, -0.8])


@pytest.fixture
def q():
    return np.array([1.0, 0.0, 0.0, 0.0])


@pytest.fixture
def crowd():
    """Momenta and attitudes of 50 bodies."""
    random = np.random.default_rng(1)
    q = random.normal(size=(50, 4))
    return random.normal(size=(50, 3)), q/np.linalg.norm(q, axis=1)[:, np.newaxis]
