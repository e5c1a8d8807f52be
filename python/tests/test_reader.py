"""The Python package against the CSV files that the same run wrote. SQUEAL names the program, MODEL the model file."""

import csv
import os
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
import squeal


def run(*arguments):
    subprocess.run([os.environ["SQUEAL"], *map(str, arguments)], check=True, capture_output=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    out = tmp_path_factory.mktemp("stability") / "results"
    run("stability", os.environ["MODEL"], "--friction", "0.2:0.6:0.2", "--band", "0:8000", "-o", out)
    return out


@pytest.fixture(scope="module")
def results(folder):
    return squeal.read_results(folder)


def column(path: Path, name: str) -> np.ndarray:
    with path.open() as file:
        return np.array([float(row[name]) for row in csv.DictReader(file)])


def test_modes_are_those_of_the_table(folder, results):
    frame = results.modes()
    table = folder / "modes.csv"
    assert results.modes().friction.nunique() == 3
    np.testing.assert_allclose(frame.frequency, column(table, "frequency_hz"), rtol=1e-9)
    np.testing.assert_allclose(frame.growth_rate, column(table, "growth_rate_per_s"), rtol=1e-6, atol=1e-5)
    assert frame.unstable.sum() > 0


def test_branches_are_those_of_the_table(folder, results):
    frame, table = results.branches(), folder / "branches.csv"
    requested = [value.friction for value in results.values if value.requested]
    assert len(frame) == len(column(table, "frequency_hz")) and set(requested) <= set(frame.friction)
    np.testing.assert_allclose(np.sort(frame.frequency), np.sort(column(table, "frequency_hz")), rtol=1e-9)


def test_unstable_modes_have_a_shape_whose_samples_are_its_values(results):
    for value in results.values:
        if value.requested:
            assert sorted(value.modes.shapes) == list(np.flatnonzero(value.modes.unstable))
        for mode, shape in value.modes.shapes.items():
            assert shape.shape == results.nodes.shape
            np.testing.assert_array_equal(shape[results.samples], value.modes.at_samples[mode])
            assert np.abs(shape).max() <= 1.0 + 1e-6


def test_contact_has_a_status_wherever_it_has_a_pressure(results):
    for value in results.values:
        assert value.pressure.shape == value.status.shape == (len(results.contact_nodes),)
        assert set(np.unique(value.status)) <= {-1, 0, 1, 2}


def test_a_super_element_has_its_modes_on_the_diagonal(tmp_path):
    path = tmp_path / "brake.se.h5"
    run("reduce", os.environ["MODEL"], "--contacts", 12, "--friction", 0.3, "-o", path)
    element = squeal.read_super_element(path)
    modes = slice(3 * len(element.points), 3 * len(element.points) + len(element.frequencies))
    np.testing.assert_allclose(np.diag(element.mass)[modes], 1.0, rtol=1e-8)
    np.testing.assert_allclose(np.diag(element.stiffness)[modes], (2 * np.pi * element.frequencies) ** 2, rtol=1e-6)
    np.testing.assert_allclose(element.stiffness, element.stiffness.T, atol=1e-6 * np.abs(element.stiffness).max())
    assert element.motion(element.load).shape == element.nodes.shape
    assert element.viscoelastic_stiffnesses is None and element.geometric_stiffness is None


def test_a_study_is_that_of_its_tables(tmp_path):
    out = tmp_path / "run"
    model = Path(os.environ["MODEL"]).resolve()
    study = f"""model = "{model}"
band = [0, 1500]
[design]
kind = "grid"
[parameter.mu]
key = "friction"
values = [0.3, 2.5]
[parameter.load]
key = "load.*.force"
factor = true
values = [0.5]
"""
    (tmp_path / "explore.toml").write_text(study)
    run("explore", tmp_path / "explore.toml", "-o", out)
    found = squeal.read_exploration(out)
    assert [own["name"] for own in found.parameters] == ["mu", "load"]
    np.testing.assert_allclose(found.values[1:], [[0.3, 0.5], [2.5, 0.5]])
    assert list(found.solved) == [True, True, False] and "friction" in found.failures[2]
    np.testing.assert_allclose(found.modes["growth_rate"], column(out / "modes.csv", "growth_rate_per_s"), rtol=1e-12)
    np.testing.assert_allclose(found.largest_growth()[0], found.modes["growth_rate"][found.modes["point"] == 0].max())
    slopes = column(out / "gradients.csv", "growth_rate_slope")
    np.testing.assert_allclose(np.sort(found.gradients.real.ravel()), np.sort(slopes), rtol=1e-12)
    assert found.answers["unstable"]["n_points"] == [1]


def test_other_files_are_refused(tmp_path, folder):
    foreign = tmp_path / "foreign.h5"
    with h5py.File(foreign, "w") as file:
        file.attrs["format"] = "another program"
    with pytest.raises(ValueError, match="no file of the format 'squeal results'"):
        squeal.read_results(foreign)
    with pytest.raises(ValueError, match="no file of the format 'squeal super-element'"):
        squeal.read_super_element(folder / "results.h5")
