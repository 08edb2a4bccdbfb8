#pragma once

#include <filesystem>

#include <Eigen/Core>

namespace colmap_ext {

// Reads a similarity transform, homogeneous, of points as columns: 16 numbers,
// a 4 x 4 matrix row by row, as COLMAP 3.8's model_aligner writes it, or 8, its
// scale, quaternion (w x y z) and translation, as later ones do.
// \throw FileError if the file is missing, or has no such transform: one that
//        mirrors or shears is none.
Eigen::Matrix4d ReadTransform(const std::filesystem::path& path);

}  // namespace colmap_ext
