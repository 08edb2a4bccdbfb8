#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace colmap_ext {

// What delaunay_manifold_mesher writes.
inline constexpr const char* kMesherOutput = "meshed-delaunay-manifold.ply";

// The folder that has one of the files: the given one or, in the layouts of
// automatic_reconstructor (WS/dense/0) and of hand-made workspaces (WS/dense),
// the only one below it; empty if none has.
// \throw FileError if the path is that of no folder, or several have one: it
//        lists them.
std::filesystem::path FindFolderWith(const std::vector<std::string>& files,
                                     const std::filesystem::path& path);

// The folder that has fused.ply.
// \throw FileError if there is none, or several.
std::filesystem::path FindDenseFolder(const std::filesystem::path& path);

// The same where the points lie elsewhere: the folder that has stereo/, as
// image_undistorter makes it, or fused.ply; the given one if none has.
// \throw FileError if there are several.
std::filesystem::path FindUndistortedFolder(const std::filesystem::path& path);

// The folder that has the sparse model of a workspace: PATH/sparse or
// PATH/sparse/0 or, where the path is that of a model itself, PATH.
// \throw FileError if there is none.
std::filesystem::path FindSparseFolder(const std::filesystem::path& path);

// To be asked before hours of work, not after them: whether all outputs can be
// written, none of them replaces an input, and each is a file of its own.
// \param outputs  files; empty paths are left out
// \param inputs  files, or folders of files; need not be there
// \throw FileError if not.
void ExpectOutputs(const std::vector<std::filesystem::path>& outputs,
                   const std::vector<std::filesystem::path>& inputs);

// What commands read of a dense workspace, and other files.
// \param folder  of the workspace; empty: none
// \param fused, sparse  the points and the cameras; empty: the workspace's
std::vector<std::filesystem::path> WorkspaceInputs(
    const std::filesystem::path& folder, const std::filesystem::path& fused,
    const std::filesystem::path& sparse,
    std::vector<std::filesystem::path> others = {});

}  // namespace colmap_ext
