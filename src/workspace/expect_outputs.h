#pragma once

#include <filesystem>
#include <vector>

namespace colmap_ext {

// To be asked before hours of work, not after them: whether all outputs can be
// written, none of them replaces an input, and each is a file of its own.
// \param outputs  files; empty paths are left out
// \param inputs  files, or folders of files; need not be there
// \throw FileError if not.
void ExpectOutputs(const std::vector<std::filesystem::path>& outputs,
                   const std::vector<std::filesystem::path>& inputs);

// What commands read of a dense workspace.
// \param fused, sparse  the points and the cameras; empty: the workspace's
std::vector<std::filesystem::path> WorkspaceInputs(
    const std::filesystem::path& folder, const std::filesystem::path& fused,
    const std::filesystem::path& sparse);

}  // namespace colmap_ext
