// The result of an atlas as an HDF5 file, for h5py, MATLAB and Julia.
//
// One data set per column, shaped like the grid, or with one entry per problem; where more than one
// geodesic is asked for, with the rank as the last dimension. The values on the axes of a grid are
// data sets called like the coordinates; other lists have from_NAME and to_NAME. Attributes of the
// file repeat the call. What there is not is NaN, -1 or an empty text.
#pragma once

#include <memory>
#include <string>

#include "atlas/atlas_output.h"

namespace carnot::apps {

std::unique_ptr<AtlasWriter> make_hdf5_writer(const std::string& path,
                                              const std::string& name,
                                              const AtlasLayout& layout);

}  // namespace carnot::apps
