#pragma once

#include <filesystem>

namespace colmap_ext {

// The folder that has fused.ply: the given one or, in the layouts of
// automatic_reconstructor (WS/dense/0) and of hand-made workspaces (WS/dense),
// the only one below it.
// \throw FileError if there is none, or several: it lists them.
std::filesystem::path FindDenseFolder(const std::filesystem::path& path);

// The folder that has the sparse model of a workspace: PATH/sparse or
// PATH/sparse/0 or, where the path is that of a model itself, PATH.
// \throw FileError if there is none.
std::filesystem::path FindSparseFolder(const std::filesystem::path& path);

}  // namespace colmap_ext
