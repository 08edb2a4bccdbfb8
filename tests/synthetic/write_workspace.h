#pragma once

#include <cstdint>
#include <string>

#include "tests/synthetic/dense_scene.h"

namespace colmap_ext::synthetic {

// Writes the scene as a dense workspace of COLMAP 3.8: images/*.png,
// sparse/*.bin, fused.ply, fused.ply.vis; with the depth maps also
// stereo/{depth_maps,normal_maps,fusion.cfg}; and the ground truth:
// truth/mesh.ply, truth/cameras.txt, truth/images.txt and, where they were
// kept, the depths that the pixels' centers see (those of stereo/ belong to the
// corners), as truth/depth_maps/NAME.geometric.bin. Files that are there are
// overwritten. Image ids are in random order, as an incremental reconstruction
// leaves them.
//
// \throw FileError, std::filesystem_error where a file or folder cannot be
//        written.
void WriteWorkspace(const DenseScene& scene, uint64_t seed,
                    const std::string& path);

}  // namespace colmap_ext::synthetic
