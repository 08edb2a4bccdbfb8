#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/region.h"
#include "viewer/shown_scene.h"

namespace colmap_ext {

// The files that a mesh of the viewer is read from.
struct ShownMeshPaths {
  std::filesystem::path mesh;
  std::filesystem::path labels;  // see ViewerOptions; may be empty
  std::filesystem::path errors;
  std::optional<Region> region;  // what is shown of it; nothing: all
};

// Reads a mesh or cloud, and its .vis if there is one. Facets with a vertex
// that is not finite are left out. Labels and errors are taken if they are of a
// mesh of as many facets or vertices.
// \param notes  gets a line for whatever does not fit the mesh.
// \throw FileError if a file can not be read.
ShownMesh ReadShownMesh(const ShownMeshPaths& paths,
                        std::vector<std::string>* notes);

}  // namespace colmap_ext
