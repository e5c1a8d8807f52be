#include "wrapper.h"
#include <malloc.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>

MPI_Comm squeal_comm_world(void) { return MPI_COMM_WORLD; }
MPI_Comm squeal_comm_self(void) { return MPI_COMM_SELF; }
int squeal_comm_fortran(MPI_Comm comm) { return (int)MPI_Comm_c2f(comm); }
MPI_Op squeal_op_sum(void) { return MPI_SUM; }
MPI_Op squeal_op_max(void) { return MPI_MAX; }
MPI_Op squeal_op_min(void) { return MPI_MIN; }
MPI_Op squeal_op_maxloc(void) { return MPI_MAXLOC; }
MPI_Errhandler squeal_errors_return(void) { return MPI_ERRORS_RETURN; }
MPI_Datatype squeal_type_double(void) { return MPI_DOUBLE; }
MPI_Datatype squeal_type_float(void) { return MPI_FLOAT; }
MPI_Datatype squeal_type_int32(void) { return MPI_INT32_T; }
MPI_Datatype squeal_type_int64(void) { return MPI_INT64_T; }
MPI_Datatype squeal_type_uint32(void) { return MPI_UINT32_T; }
MPI_Datatype squeal_type_uint64(void) { return MPI_UINT64_T; }
MPI_Datatype squeal_type_byte(void) { return MPI_BYTE; }
MPI_Datatype squeal_type_double_int(void) { return MPI_DOUBLE_INT; }

/* OpenBLAS has it, the reference BLAS has not. */
char *openblas_get_config(void) __attribute__((weak));

void squeal_libraries(char *text, size_t size)
{
  char mpi[MPI_MAX_LIBRARY_VERSION_STRING] = "";
  int length = 0;
  MPI_Get_library_version(mpi, &length);
  mpi[strcspn(mpi, ",\n")] = 0;
  snprintf(text, size, "MUMPS %s\nMETIS %d.%d.%d\nBLAS: %s\n%s", MUMPS_VERSION, METIS_VER_MAJOR, METIS_VER_MINOR,
           METIS_VER_SUBMINOR, openblas_get_config ? openblas_get_config() : "of unknown kind", mpi);
}

char *openblas_get_corename(void) __attribute__((weak));

const char *squeal_blas_kernels(void) { return openblas_get_corename ? openblas_get_corename() : NULL; }

int squeal_take_blas_buffer(void)
{
  const size_t size = (size_t)160 << 20;
  void *room = mmap(NULL, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  const PetscBLASInt n = 1;
  const double one = 1.0;
  double x = 1.0;
  if (room == MAP_FAILED) return 0;
  munmap(room, size);
  BLAStrsm_("L", "L", "N", "N", &n, &n, &one, &one, &n, &x, &n);
  return 1;
}

static struct sigaction kept[2];

void squeal_keep_handlers(void)
{
  sigaction(SIGTERM, NULL, &kept[0]);
  sigaction(SIGABRT, NULL, &kept[1]);
}

void squeal_restore_handlers(void)
{
  sigaction(SIGTERM, &kept[0], NULL);
  sigaction(SIGABRT, &kept[1], NULL);
}

void squeal_give_memory_back(void)
{
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

/* Raises a PETSc error from a callback, so that PETSc's frames follow it out. */
PetscErrorCode squeal_raise(const char *function, const char *message)
{
  return PetscError(PETSC_COMM_SELF, 0, function, "squeal", PETSC_ERR_USER, PETSC_ERROR_INITIAL, "%s", message);
}
