#pragma once

#include <filesystem>

#include "evaluation/observability.h"

namespace colmap_ext {

// Reads the voxels of an observability mask from a NumPy file (.npy, format 1.0
// to 3.0): an array [X, Y, Z] of uint8, int8 or bool, in C or Fortran order.
// DTU's ObsMask*.mat become such by
//   numpy.save(npy_path, scipy.io.loadmat(mat_path)["ObsMask"]).
//
// \return with the origin and the resolution still to be set.
// \throw FileError if the file is missing, truncated, or not such an array.
ObservabilityMask ReadNpyMask(const std::filesystem::path& path);

}  // namespace colmap_ext
