"""`make bench` is not run by `make test`; what it calls must still fit."""

import pytest

from studies.benchmark import parts


@pytest.mark.slow
def test_parts_of_a_step_are_called_as_the_march_calls_them(coefficients, monkeypatch):
    monkeypatch.setattr(parts, "coefficients", lambda: (coefficients, 0.0))
    monkeypatch.setattr(parts, "CALLS", 1)
    names, times, calls = zip(*parts.of_a_step("elastic"), strict=True)
    assert "Morison drag" in names and min(times) > 0 and min(calls) > 0
