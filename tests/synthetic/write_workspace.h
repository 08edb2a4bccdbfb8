#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "scene/view.h"
#include "tests/synthetic/dense_scene.h"

// Reading and writing by COLMAP itself, in any version from 3.8 on.
namespace colmap_ext::synthetic {

// Writes the scene as a COLMAP dense workspace, but for the images through
// COLMAP's own writers: images/*.png, sparse/*.bin, fused.ply, fused.ply.vis;
// with the depth maps also stereo/{depth_maps,normal_maps,fusion.cfg}; and the
// ground truth: truth/mesh.ply, truth/cameras.txt, truth/images.txt and, where
// they were kept, the depths that the pixels' centers see (those of stereo/
// belong to the corners), as truth/depth_maps/NAME.geometric.bin. Files that
// are there are overwritten. Image ids are in random order, as an incremental
// reconstruction leaves them.
//
// \throw FileError, std::filesystem_error where a file or folder cannot be
//        written.
void WriteWorkspace(const DenseScene& scene, uint64_t seed,
                    const std::string& path);

// Reads a sparse model, binary or else text, with COLMAP, and writes it as this
// version does in binary form.
// \return the positions of the images in the order that COLMAP reads them from
//         the latter, by name: what fused.ply.vis refers to.
std::map<std::string, int> ConvertModel(const std::string& path,
                                        const std::string& binary_path);

// The cameras of a sparse model in any form that COLMAP reads, in its order.
// \throw std::runtime_error for cameras other than pinhole ones.
std::vector<View> ReadViews(const std::string& sparse_path);

}  // namespace colmap_ext::synthetic
