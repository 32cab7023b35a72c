// Whether this process is one of several that mpirun or srun started for one call.
#pragma once

namespace carnot::apps {

// Its number among them, from 0; -1 where nothing launched it, and in a build without MPI.
int launched_rank();

// False of all but the first of them: what each would say, that one says.
inline bool speaks_for_all() { return launched_rank() <= 0; }

}  // namespace carnot::apps
