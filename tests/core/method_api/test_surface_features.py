"""Spectrum and features of a surface, where triangles without width upset the solver."""

import numpy as np
import pytest

from addon.core.method_api import surface_features as module
from addon.core.method_api.settings import Settings
from addon.core.method_api.surface_features import detected
from addon.core.run.errors import SolverError
from addon.core.run.monitor import Monitor


@pytest.mark.parametrize(("failures", "share"), [(0, None), (1, 0.01), (2, 0.1)])
def test_edges_get_longer_until_there_is_a_spectrum_and_it_is_told_once(figure, monkeypatch, failures, share):
    tried = []

    def failing(stiffness, mass, count, monitor):
        tried.append(mass.sum())
        if len(tried) <= failures:
            raise SolverError("inaccurate_spectrum", residual=1.0)
        return compute(stiffness, mass, count, monitor)

    compute = module.compute_spectrum
    monkeypatch.setattr(module, "compute_spectrum", failing)
    monitor = Monitor()
    vertices, faces = figure
    found = detected(vertices, faces, None, Settings(), monitor)
    assert len(tried) == failures + 1
    assert (np.diff(tried) >= 0).all()  # longer edges, larger triangles
    assert found.mass.sum() == pytest.approx(tried[-1])
    told = [warning for warning in monitor.warnings if warning.kind == "flat_triangles"]
    assert [warning.numbers["share"] for warning in told] == ([] if share is None else [share])


def test_where_no_length_helps_the_error_is_told(figure, monkeypatch):
    def failing(*_):
        raise SolverError("inaccurate_spectrum", residual=1.0)

    monkeypatch.setattr(module, "compute_spectrum", failing)
    vertices, faces = figure
    with pytest.raises(SolverError, match="accurate"):
        detected(vertices, faces, None, Settings(), Monitor())
