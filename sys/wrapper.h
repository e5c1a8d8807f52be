#include <petscsnes.h>
#include <slepcpep.h>
#include <petscblaslapack.h>
#include <metis.h>
#include "shim.h"
