#include "testing/charted_scene_runs.h"

namespace carnot::test {

template Gauss8Run<scenes::Martinet> gauss8_run;
template Gauss8Run<scenes::Engel> gauss8_run;
template Gauss8Run<scenes::Trailers<3>> gauss8_run;
template Gauss8Run<scenes::Satellite> gauss8_run;
template Gauss8Run<scenes::PlateBall> gauss8_run;
template Gauss8Run<scenes::FallingCat> gauss8_run;

}  // namespace carnot::test
