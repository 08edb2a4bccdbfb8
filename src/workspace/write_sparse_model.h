#pragma once

#include <filesystem>

#include "workspace/sparse_model.h"

namespace colmap_ext {

// Whether every frame of the model is one image, by a rig of one camera, as in
// all models before COLMAP 3.12: then images can move one by one.
// \pre the model was read in full
bool HasOneImageFrames(const SparseModel& model);

// Writes a model in COLMAP's binary format: cameras, images with their
// observations, points with their tracks and errors, and, where there are any,
// rigs and frames. The folder is made if it is not there; all files get their
// names together, after they have reached the disk. What belongs to a model of
// another COLMAP version is removed.
// \pre the model was read in full, has pinhole cameras alone, and
//      HasOneImageFrames()
// \throw FileError if it can not be written: no file is changed then.
void WriteSparseModel(const std::filesystem::path& folder,
                      const SparseModel& model);

}  // namespace colmap_ext
