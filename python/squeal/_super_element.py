"""Super-elements."""

from dataclasses import dataclass

import numpy as np

from ._file import opened, table

FORMAT, VERSION = "squeal super-element", 6


@dataclass(frozen=True)
class SuperElement:
    """A super-element. Its n coordinates: 3 a retained point, fixed-interface modes, residual modes; or basis vectors."""

    about: dict
    """Its origin (model, mesh, friction, band, samples), its contact pairs, the parts."""
    points: np.ndarray
    """Retained points, n_p x 3, m."""
    frequencies: np.ndarray
    """Of the fixed-interface modes, Hz."""
    mass: np.ndarray
    """n x n."""
    damping: np.ndarray
    """n x n."""
    stiffness: np.ndarray
    """n x n, without contact, of viscoelastic materials that at rest."""
    structural_damping: np.ndarray | None
    """n x n, N/m; None where no stiffness has a loss factor."""
    viscoelastic_stiffnesses: np.ndarray | None
    """n_v x n x n, of each law in about["viscoelastic"] at rest, part of stiffness; None where there is no law."""
    geometric_stiffness: np.ndarray | None
    """n x n, of the equilibrium at about["origin"]["prestress_at_friction"]; None without prestress."""
    load: np.ndarray
    """Generalised forces of the loads, n."""
    preload: np.ndarray
    """Generalised forces of the equilibrium it was made about, n."""
    contacts: dict
    """One array a quantity, one row a contact: pair, position, normal, direction, speed, weight, gap, ...

    Of a Galerkin super-element also motion, 3 n_c x n: displacements of the contacts for a unit of each coordinate."""
    nodes: np.ndarray
    """Corners of the outer surface, n_s x 3, m."""
    triangles: np.ndarray
    """Triangles of the outer surface."""
    basis: np.ndarray
    """Displacements of the corners for a unit of each coordinate, n x n_s x 3."""

    def motion(self, coordinates: np.ndarray) -> np.ndarray:
        """Displacements of the corners of the surface, n_s x 3, of a vector of coordinates (real or complex)."""
        return np.tensordot(coordinates, self.basis, axes=1)


def read_super_element(path) -> SuperElement:
    """Reads the file of `squeal reduce`.

    Raises ValueError where the file is of another kind or version, OSError where it cannot be opened.
    """
    with opened(path, FORMAT, VERSION) as file:
        surface = file["surface"]
        n, nodes = file["mass"].shape[0], surface["nodes"][...]
        names = ("points", "frequencies", "mass", "damping", "stiffness", "load", "preload")
        optional = {
            name: file[name][...].reshape(-1, n, n) if name in file else None
            for name in ("structural_damping", "viscoelastic_stiffnesses", "geometric_stiffness")
        }
        for name in ("structural_damping", "geometric_stiffness"):
            optional[name] = None if optional[name] is None else optional[name][0]
        return SuperElement(
            about=table(file, "about"),
            **{name: file[name][...] for name in names},
            **optional,
            contacts={name: rows[...] for name, rows in file["contacts"].items()},
            nodes=nodes,
            triangles=surface["triangles"][...],
            basis=surface["basis"][...].reshape(n, len(nodes), 3),
        )
