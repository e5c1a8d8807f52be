"""Seconds that DOLFINx takes to assemble stiffness and mass of the mesh that benches/assembly.rs wrote to a folder.

The same elements: quadratic displacements on quadratic geometry, 4 points for the stiffness, 14 for the mass (degree 5). One material
for the whole mesh. The generated C code is compiled with -O3 -march=native; its compilation is not counted.
"""

import sys
import time

import numpy as np
import ufl
from mpi4py import MPI
import dolfinx
from dolfinx import fem
from dolfinx.fem import petsc

folder = sys.argv[1]
nodes = np.fromfile(f"{folder}/nodes", dtype="<f8").reshape(-1, 3)
tets = np.fromfile(f"{folder}/tets", dtype="<u4").reshape(-1, 10).astype(np.int64)

tetrahedron = ufl.Cell("tetrahedron", geometric_dimension=3)
geometry = ufl.Mesh(ufl.VectorElement("Lagrange", tetrahedron, 2))
order = dolfinx.cpp.io.perm_vtk(dolfinx.mesh.CellType.tetrahedron, 10)
mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, np.ascontiguousarray(tets[:, order]), nodes, geometry)
space = fem.VectorFunctionSpace(mesh, ("Lagrange", 2))
u, v = ufl.TrialFunction(space), ufl.TestFunction(space)

young, poisson, density = 210e9, 0.3, 7800.0
mu = young / (2 * (1 + poisson))
lame = young * poisson / ((1 + poisson) * (1 - 2 * poisson))


def strain(w):
    return ufl.sym(ufl.grad(w))


def stress(w):
    return 2 * mu * strain(w) + lame * ufl.tr(strain(w)) * ufl.Identity(3)


dx = ufl.Measure("dx", domain=mesh)
options = {"cffi_extra_compile_args": ["-O3", "-march=native"]}
forms = [
    fem.form(ufl.inner(stress(u), strain(v)) * dx(metadata={"quadrature_degree": 2}), jit_params=options),
    fem.form(density * ufl.inner(u, v) * dx(metadata={"quadrature_degree": 5}), jit_params=options),
]


def assemble():
    """Both matrices: seconds of their patterns and of their values, and the first one."""
    start = time.perf_counter()
    matrices = [petsc.create_matrix(form) for form in forms]
    middle = time.perf_counter()
    for matrix, form in zip(matrices, forms):
        petsc.assemble_matrix(matrix, form)
        matrix.assemble()
    end = time.perf_counter()
    volume = sum_of_entries(matrices[1]) / (3 * density)
    for matrix in matrices:
        matrix.destroy()
    return middle - start, end - middle, volume


def sum_of_entries(matrix):
    ones = matrix.createVecRight()
    ones.set(1.0)
    return (matrix * ones).sum()


first, *others = [assemble() for _ in range(5)]
best = min(others, key=lambda seconds: seconds[0] + seconds[1])
for pattern, values, volume in [first, best]:
    print(pattern, values, volume)
