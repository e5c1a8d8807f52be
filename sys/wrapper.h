#include <petscsnes.h>
#include <slepcpep.h>
#include <petscblaslapack.h>
#include <dmumps_c.h>
#include <smumps_c.h>
#include <metis.h>
#include "shim.h"

/* What `squeal` is written for: real scalars, and 32-bit integers of MUMPS and METIS. */
#ifdef PETSC_USE_COMPLEX
#error "This PETSc has complex scalars. Give PETSC_DIR and PETSC_ARCH of one with real scalars"
#endif
_Static_assert(sizeof(MUMPS_INT) == 4,
               "This MUMPS has 64-bit integers. Give MUMPS_LIBRARIES of one with 32-bit integers");
_Static_assert(sizeof(idx_t) == 4 && sizeof(real_t) == 4,
               "This METIS has other than 32-bit numbers. Give METIS_LIBRARY of one that has them");
