#include "formats/read_ply_mesh.h"

#include <string>
#include <utility>

#include <fmt/format.h>

#include "formats/byte_reader.h"
#include "formats/errors.h"
#include "formats/ply_header.h"
#include "formats/ply_numbers.h"
#include "formats/read_ply_cloud.h"

namespace colmap_ext {

namespace {

bool IsCornerList(const PlyProperty& property) {
  return property.is_list &&
         (property.name == "vertex_index" || property.name == "vertex_indices");
}

Facet ReadFacet(const PlyProperty& list, uint64_t face,
                const std::filesystem::path& path, PlyNumberReader* numbers) {
  const uint64_t num_corners = numbers->ReadLength(list);
  if (num_corners != 3) {
    throw FileError(
        path,
        fmt::format("face {} has {} corners, but only triangles are read; "
                    "triangulate the mesh first",
                    face, num_corners));
  }
  Facet facet;
  for (uint32_t& corner : facet) {
    const double vertex = numbers->Read(list.type);
    if (!(vertex >= 0 && vertex <= 4294967295.0) ||
        vertex != static_cast<double>(static_cast<uint32_t>(vertex))) {
      throw FileError(
          path,
          fmt::format("damaged: face {} has a corner that is no vertex's index",
                      face));
    }
    corner = static_cast<uint32_t>(vertex);
  }
  return facet;
}

std::vector<Facet> ReadFacets(const PlyElement& element,
                              const std::filesystem::path& path,
                              PlyNumberReader* numbers) {
  std::vector<Facet> facets;
  for (uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      if (IsCornerList(property)) {
        facets.push_back(ReadFacet(property, i, path, numbers));
      } else {
        numbers->Skip(property);
      }
    }
    if (facets.size() != i + 1) {
      throw FileError(path,
                      "its faces do not have one list vertex_index or "
                      "vertex_indices");
    }
  }
  return facets;
}

void CheckFacets(const TriangleMesh& mesh, const std::filesystem::path& path) {
  for (size_t i = 0; i < mesh.facets.size(); ++i) {
    for (const uint32_t vertex : mesh.facets[i]) {
      if (vertex >= mesh.vertices.size()) {
        throw FileError(
            path,
            fmt::format("damaged: face {} has vertex {}, but there are {}", i,
                        vertex, mesh.vertices.size()));
      }
    }
  }
}

}  // namespace

ColoredMesh ReadColoredPlyMesh(const std::filesystem::path& path) {
  ByteReader reader(path);
  const PlyHeader header = ReadPlyHeader(&reader);
  PlyNumberReader numbers(&reader, header.format, "the mesh");
  ColoredMesh read;
  TriangleMesh& mesh = read.mesh;
  for (const PlyElement& element : header.elements) {
    numbers.ExpectRoomFor(element);
    if (element.name == "vertex") {
      PlyCloud vertices = ReadPlyVertices(element, path, &numbers);
      mesh.vertices = std::move(vertices.positions);
      read.colors = std::move(vertices.colors);
      read.confidences = std::move(vertices.confidences);
    } else if (element.name == "face") {
      mesh.facets = ReadFacets(element, path, &numbers);
    } else {
      numbers.Skip(element);
    }
  }
  if (mesh.vertices.empty()) {
    throw FileError(path, "it has no vertices");
  }
  CheckFacets(mesh, path);
  return read;
}

TriangleMesh ReadPlyMesh(const std::filesystem::path& path) {
  return ReadColoredPlyMesh(path).mesh;
}

}  // namespace colmap_ext
