"""Studies of many parameters."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ._file import opened, table

FORMAT, VERSION = "squeal exploration", 1


@dataclass(frozen=True)
class Exploration:
    """What `squeal explore` has found at n points of k parameters; the first point is the nominal one."""

    about: dict
    """Title, model and mesh with their SHA-256, program, band, criterion."""
    parameters: list
    """Of each: name, keys, factor, nominal, from and to (quantiles 5 and 95 %), difference."""
    values: np.ndarray
    """Values of the parameters, n x k."""
    solved: np.ndarray
    """Whether modes were found, n."""
    failures: dict
    """Why the others failed, by their numbers."""
    modes: np.ndarray
    """One row a mode: point, growth_rate (1/s), omega (rad/s), backward_error, unstable, nominal, share, doubtful."""
    gradients: np.ndarray
    """Derivatives of the nominal eigenvalues by each parameter, complex, k x m; NaN where there is none."""
    answers: dict
    """Tables of numbers (unstable, instabilities, hopf, bins, growth_rate, indices): a dictionary of columns each."""

    def largest_growth(self) -> np.ndarray:
        """The largest growth rate of each point, 1/s; NaN where it failed."""
        largest = np.full(len(self.values), -np.inf)
        np.maximum.at(largest, self.modes["point"], self.modes["growth_rate"])
        return np.where(np.isfinite(largest), largest, np.nan)


def read_exploration(path) -> Exploration:
    """Reads the results of `squeal explore`: its folder, or the results.h5 in it.

    Raises ValueError where the file is of another kind or version, OSError where it cannot be opened.
    """
    path = Path(path)
    with opened(path / "results.h5" if path.is_dir() else path, FORMAT, VERSION) as file:
        slopes = file["gradients"][...]
        return Exploration(
            about=table(file, "about"),
            parameters=table(file, "parameters").get("parameter", []),
            values=file["values"][...],
            solved=file["status"][...] == 1,
            failures={row["point"]: row["reason"] for row in table(file, "failures").get("failure", [])},
            modes=file["modes"][...],
            gradients=slopes[..., 0] + 1j * slopes[..., 1],
            answers={
                name: _columns(file[name]) for name in ("unstable", "instabilities", "hopf", "bins", "growth_rate", "indices")
            },
        )


def _columns(dataset) -> dict:
    names = dataset.attrs["columns"]
    names = (names.decode() if isinstance(names, bytes) else str(names)).split(",")
    return dict(zip(names, dataset[...].T, strict=True))
