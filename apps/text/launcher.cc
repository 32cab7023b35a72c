#include "text/launcher.h"

#include <cstdlib>

namespace carnot::apps {

int launched_rank() {
#ifdef CARNOT_MPI
  // Of Open MPI's mpirun, and of srun by PMIx and by PMI.
  for (const char* name : {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"}) {
    if (const char* const text = std::getenv(name)) return std::atoi(text);
  }
#endif
  return -1;
}

}  // namespace carnot::apps
