/* What PETSc and MPI offer as macros only. */
#include <petscsys.h>
MPI_Comm squeal_comm_world(void);
MPI_Comm squeal_comm_self(void);
int squeal_comm_fortran(MPI_Comm comm);
MPI_Op squeal_op_sum(void);
MPI_Op squeal_op_max(void);
MPI_Op squeal_op_min(void);
MPI_Op squeal_op_maxloc(void);
MPI_Errhandler squeal_errors_return(void);
MPI_Datatype squeal_type_double(void);
MPI_Datatype squeal_type_float(void);
MPI_Datatype squeal_type_int32(void);
MPI_Datatype squeal_type_int64(void);
MPI_Datatype squeal_type_uint32(void);
MPI_Datatype squeal_type_uint64(void);
MPI_Datatype squeal_type_byte(void);
MPI_Datatype squeal_type_double_int(void);
PetscErrorCode squeal_raise(const char *function, const char *message);
/* PETSc's own, which it declares in a private header. */
PetscErrorCode PetscObjectStateGet(PetscObject object, PetscObjectState *state);
/* Has the C library give freed memory back to the system. */
void squeal_give_memory_back(void);
/* Writes the names and versions of MUMPS, METIS, BLAS and MPI, a line each. */
void squeal_libraries(char *text, size_t size);
/* The kernels that OpenBLAS has chosen; NULL of another BLAS. */
const char *squeal_blas_kernels(void);
/* Has BLAS take its buffer of at most 160 MB of address space; 0 where there is no room for it. */
int squeal_take_blas_buffer(void);
/* METIS has handlers of its own for SIGTERM and SIGABRT while it works, and gives others back with other flags. */
void squeal_keep_handlers(void);
void squeal_restore_handlers(void);
/* BLAS and LAPACK that PETSc's headers leave out. */
void dtrsv_(const char *uplo, const char *trans, const char *diag, const int *n, const double *a, const int *lda,
            double *x, const int *incx);
void zgesv_(const int *n, const int *columns, void *a, const int *lda, int *pivots, void *b, const int *ldb, int *info);
void zgeev_(const char *jobvl, const char *jobvr, const int *n, void *a, const int *lda, void *values, void *left,
            const int *ldl, void *right, const int *ldr, void *work, const int *n_work, double *rwork, int *info);
void dsygvd_(const int *kind, const char *jobz, const char *uplo, const int *n, double *a, const int *lda, double *b,
             const int *ldb, double *values, double *work, const int *n_work, int *integers, const int *n_integers,
             int *info);
