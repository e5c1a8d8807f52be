#include <petscsnes.h>
#include <slepcpep.h>
#include <petscblaslapack.h>
#include <dmumps_c.h>
#include <smumps_c.h>
#include <metis.h>
#include "shim.h"
