"""The results of a stability analysis."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ._file import opened, table

FORMAT, VERSION = "squeal results", 2


@dataclass(frozen=True)
class Modes:
    """The modes at one friction value, by frequency. Each field has one entry a mode."""

    eigenvalue: np.ndarray
    """lambda = growth rate + i omega, 1/s; complex."""
    backward_error: np.ndarray
    """Normwise backward error of the eigenpair."""
    unstable: np.ndarray
    """Whether the mode grows; bool."""
    at_samples: np.ndarray
    """Displacements at `Results.samples`: modes x samples x 3, complex."""
    shapes: dict
    """Displacements at all nodes of the surface, nodes x 3, complex, of the modes that have them (by place)."""

    @property
    def frequency(self) -> np.ndarray:
        """|Im lambda| / 2 pi, Hz."""
        return np.abs(self.eigenvalue.imag) / (2 * np.pi)

    @property
    def growth_rate(self) -> np.ndarray:
        """Re lambda, 1/s."""
        return self.eigenvalue.real

    @property
    def damping_ratio(self) -> np.ndarray:
        """-Re lambda / |lambda|."""
        return -self.eigenvalue.real / np.abs(self.eigenvalue)

    def __len__(self) -> int:
        return len(self.eigenvalue)


@dataclass(frozen=True)
class Value:
    """One friction value."""

    friction: float
    """Friction coefficient of the swept pairs."""
    requested: bool
    """Whether the user asked for the value; else the tracking of modes needed it."""
    modes: Modes
    pressure: np.ndarray
    """Normal pressure at `Results.contact_nodes`, Pa."""
    status: np.ndarray
    """There: 0 open, 1 slip, 2 stick, -1 no contact point."""
    record: dict
    """Seconds, checks of the equilibrium, count of modes, forces of the contact pairs, Newton steps."""
    sources: list
    """What explains the unstable modes: a dict each, `mode` its place in `modes`."""


@dataclass(frozen=True)
class Results:
    """The results of `squeal stability`."""

    about: dict
    """The model, the mesh, the program, the parts and the contact pairs."""
    values: list
    """One `Value` a friction value, by friction."""
    nodes: np.ndarray
    """Nodes of the outer surface, n x 3, m."""
    triangles: np.ndarray
    """Triangles of the outer surface, m x 3; normals point out."""
    part: np.ndarray
    """Part of each triangle: index into about["parts"]."""
    samples: np.ndarray
    """Nodes at which every mode is known."""
    contact_nodes: np.ndarray
    """Nodes of the slave faces, n x 3, m."""
    contact_triangles: np.ndarray
    """Triangles of the slave faces, m x 3; none where contacts are single points."""
    points: np.ndarray
    """Points of the branches: fields branch, mode, friction, growth_rate (1/s), omega (rad/s)."""
    hopf: list
    """Hopf points, a dict each."""
    failure: dict
    """Why the analysis ended early; empty where it did not."""

    def modes(self):
        """All modes at the requested friction values as a pandas data frame, one row a mode."""
        import pandas

        columns = ("frequency", "growth_rate", "damping_ratio", "unstable", "backward_error")
        frames = [
            pandas.DataFrame({"friction": value.friction, "mode": np.arange(1, len(value.modes) + 1)}
                             | {name: getattr(value.modes, name) for name in columns})
            for value in self.values if value.requested
        ]
        return pandas.concat(frames, ignore_index=True)

    def branches(self):
        """The branches of modes as a pandas data frame, one row a point of a branch."""
        import pandas

        points = self.points
        return pandas.DataFrame({
            "branch": points["branch"],
            "mode": points["mode"],
            "friction": points["friction"],
            "frequency": np.abs(points["omega"]) / (2 * np.pi),
            "growth_rate": points["growth_rate"],
        })

    def shape_mesh(self, value: Value, mode: int, phase: float = 0.0, scale: float = 0.0):
        """The outer surface with a mode's displacements Re(phi exp(i phase)), as pyvista.PolyData.

        `mode` is a place in `value.modes` that has a shape (`value.modes.shapes`). The point data `displacement` has
        the displacements; with `scale` (m) the nodes are moved, so that the largest displacement has this length.
        Raises KeyError where the mode has no shape.
        """
        import pyvista

        if mode not in value.modes.shapes:
            raise KeyError(f"mode {mode} has no shape at all nodes; those that have one: {sorted(value.modes.shapes)}")
        displacement = np.real(value.modes.shapes[mode] * np.exp(1j * phase))
        faces = np.column_stack([np.full(len(self.triangles), 3), self.triangles])
        mesh = pyvista.PolyData(self.nodes + scale * displacement, faces.ravel())
        mesh.point_data["displacement"] = displacement
        mesh.cell_data["part"] = self.part
        return mesh


def read_results(path) -> Results:
    """Reads the results of `squeal stability`: a results folder, or the file results.h5 in it.

    Raises ValueError where the file is of another kind or version, OSError where it cannot be opened.
    """
    path = Path(path)
    path = path / "results.h5" if path.is_dir() else path
    with opened(path, FORMAT, VERSION) as file:
        surface, contact = file["surface"], file["contact"]
        values = [_value(group) for group in file["values"].values()]
        diagram = file.get("diagram")
        return Results(
            about=table(file, "about"),
            values=sorted(values, key=lambda value: value.friction),
            nodes=surface["nodes"][...],
            triangles=surface["triangles"][...],
            part=surface["part"][...],
            samples=surface["samples"][...],
            contact_nodes=contact["nodes"][...],
            contact_triangles=contact["triangles"][...],
            points=diagram["points"][...] if diagram else np.empty(0, _POINT),
            hopf=table(diagram, "hopf").get("hopf", []) if diagram else [],
            failure=table(file, "failure") if "failure" in file else {},
        )


_POINT = [("branch", "u4"), ("mode", "u4"), ("friction", "f8"), ("growth_rate", "f8"), ("omega", "f8")]


def _value(group) -> Value:
    rows, record = group["modes"][...], table(group, "record")
    shapes = _complex(group["shapes"][...])
    return Value(
        friction=record["friction"],
        requested=record["asked"],
        modes=Modes(
            eigenvalue=rows["growth_rate"] + 1j * rows["omega"],
            backward_error=rows["backward_error"],
            unstable=rows["unstable"].astype(bool),
            at_samples=_complex(group["sampled"][...]),
            shapes={int(mode): shape for mode, shape in zip(group["shaped"][...], shapes)},
        ),
        pressure=group["pressure"][...],
        status=group["status"][...],
        record=record,
        sources=table(group, "sources").get("sources", []),
    )


def _complex(numbers: np.ndarray) -> np.ndarray:
    """Real and imaginary part stand in the last index."""
    return numbers[..., 0] + 1j * numbers[..., 1]
