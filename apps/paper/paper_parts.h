// The subjects of the paper's sections 5 and 6, one function each (McLachlan, Modin, Verdier &
// Wilkins, SIAM J. Sci. Comput. 35, 2013). What is in each is in the file of its name.
#pragma once

#include "paper/paper_report.h"
#include "paper/paper_run.h"

namespace carnot::apps {

// All steps of all the runs, about: what the progress bar goes by.
inline constexpr double kPaperSteps = 6.8e5;

PaperPart paper_sketch();                     // figure 1: the vehicle
PaperPart paper_cosine(PaperWork& work);      // section 5: V = -cos r
PaperPart paper_straight(PaperWork& work);    // section 5: V = 0, straight line
PaperPart paper_circle(PaperWork& work);      // section 5: V = 0, circle
PaperPart paper_returns(PaperWork& work);     // section 5: leaving the circle and returning
PaperPart paper_heisenberg(PaperWork& work);  // section 6

}  // namespace carnot::apps
