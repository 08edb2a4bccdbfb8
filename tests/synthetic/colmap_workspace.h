#pragma once

#include <map>
#include <string>
#include <vector>

#include "scene/view.h"
#include "tests/synthetic/fuse.h"
#include "tests/synthetic/render.h"
#include "tests/synthetic/stereo.h"

// Reading and writing by COLMAP itself, in any version from 3.8 on.
namespace colmap_ext::synthetic {

// \throw std::runtime_error if the file cannot be written.
void WriteImage(const std::string& path, const ColorImage& image);

// Reads a sparse model, binary or else text, with COLMAP, and writes it as this
// version does in binary form.
// \return the positions of the images in the order that COLMAP reads them from
//         the latter, by name: what fused.ply.vis refers to.
std::map<std::string, int> ConvertModel(const std::string& path,
                                        const std::string& binary_path);

// The cameras of a sparse model in any form that COLMAP reads, in its order.
// \throw std::runtime_error for cameras other than pinhole ones.
std::vector<View> ReadViews(const std::string& sparse_path);

// fused.ply and fused.ply.vis.
// \param positions [views] of the images in COLMAP's order
void WriteFusedPoints(const std::string& ply_path, const FusedPoints& points,
                      const std::vector<int>& positions);

// COLMAP's file of a depth map.
// \param depths [height * width], row by row, scene units; 0 for none
void WriteDepths(const std::string& path, int width, int height,
                 const std::vector<float>& depths);

// COLMAP's file of a depth map's normals.
void WriteNormals(const std::string& path, const DepthMap& map,
                  const View& view);

}  // namespace colmap_ext::synthetic
