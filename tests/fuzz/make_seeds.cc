// Usage: make_seeds FOLDER
//
// Writes sound files to FOLDER/<reader>/, from which the fuzzer starts.

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "formats/write_mesh.h"
#include "tests/workspace/sphere_workspace.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

void WriteClouds(const fs::path& folder) {
  SphereWorkspace sphere = SphereWorkspace::Small();
  WriteFile(folder / "ply_cloud" / "normals", sphere.Ply());
  sphere.write_normals = false;
  WriteFile(folder / "ply_cloud" / "plain", sphere.Ply());
  WriteFile(folder / "visibility" / "sphere", sphere.Vis());
  WriteFile(folder / "ply_cloud" / "text",
            "ply\nformat ascii 1.0\ncomment c\nelement camera 1\n"
            "property list uchar float params\nelement vertex 2\n"
            "property double x\nproperty float y\nproperty int z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\n"
            "property list int short tags\nend_header\n"
            "2 1 2\n1 2 3 4 5 6 0\n-1.5 nan 1e3 7 8 9 2 5 6\n");
  WriteFile(folder / "ply_cloud" / "big_endian",
            "ply\nformat binary_big_endian 1.0\nelement vertex 1\n"
            "property float x\nproperty float y\nproperty float z\nend_header\n"
            "?8??abcdefgh");
}

void WriteMeshes(const fs::path& folder) {
  const TriangleMesh mesh = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                             {{0, 2, 1}, {0, 1, 3}}};
  fs::create_directories(folder / "ply_mesh");
  WriteColoredMesh(folder / "ply_mesh" / "colored", mesh,
                   std::vector<Color>(4, {1, 2, 3}));
  WriteColoredMesh(folder / "ply_mesh" / "plain", mesh, {});
  WriteMesh(folder / "ply_mesh" / "confident", mesh,
            {{}, Rows<uint32_t>(4), {0, 0.25F, 0.5F, 1}});
  fs::remove(VisibilityPath(folder / "ply_mesh" / "confident"));
  WriteFile(folder / "ply_mesh" / "text",
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
            "property float y\nproperty float z\nelement face 1\n"
            "property list uchar int vertex_indices\nproperty int label\n"
            "property list uchar float texcoord\nend_header\n"
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 9 2 0.5 0.5\n");
}

// The first byte names the file of the model (FuzzSparseModel()).
void WriteSparseModels(const fs::path& folder) {
  const SphereWorkspace sphere = SphereWorkspace::Small();
  char selector = 0;
  for (const std::string name : {"cameras", "images", "points3D", "frames"}) {
    WriteFile(folder / "sparse_model_binary" / name,
              selector + sphere.ModelFile(name + ".bin"));
    WriteFile(folder / "sparse_model_text" / name,
              selector + sphere.ModelFile(name + ".txt"));
    ++selector;
  }
}

void WriteEvaluationFiles(const fs::path& folder) {
  WriteFile(folder / "region" / "corners", "# 1\n-1,2 3\n4 5 6.5e1\n");
  WriteFile(folder / "region" / "oriented",
            "0 1 0 0 0 1 1 0 0\n.5 -1 2\n1 2 3\n");
  WriteFile(folder / "depth_map" / "map", "3&2&1&" + std::string(24, 'x'));
  for (const char* order : {"False", "True"}) {
    const std::string header =
        std::string("{'descr': '|u1', 'fortran_order': ") + order +
        ", 'shape': (2, 3, 4), }\n";
    std::string bytes("\x93NUMPY\x01\x00", 8);
    Append(static_cast<uint16_t>(header.size()), &bytes);
    WriteFile(folder / "npy_mask" / order,
              bytes + header + std::string(24, '\1'));
  }
}

void WritePictures(const fs::path& folder) {
  WriteFile(folder / "picture_size" / "png",
            std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\1\2\0\0\0\7", 24));
  WriteFile(
      folder / "picture_size" / "jpeg",
      std::string(
          "\xff\xd8\xff\xe0\0\4ab\xff\xff\xc4\0\3x\xff\xc2\0\x11\x08\0\5\1\1",
          23));
}

}  // namespace
}  // namespace colmap_ext

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "Usage: make_seeds FOLDER" << std::endl;
    return EXIT_FAILURE;
  }
  const std::filesystem::path folder = argv[1];
  colmap_ext::WriteClouds(folder);
  colmap_ext::WriteMeshes(folder);
  colmap_ext::WriteSparseModels(folder);
  colmap_ext::WriteEvaluationFiles(folder);
  colmap_ext::WritePictures(folder);
  return EXIT_SUCCESS;
}
