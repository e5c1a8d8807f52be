#include <petscsnes.h>
#include <slepcpep.h>
#include <metis.h>
#include "shim.h"
