#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "base/rows.h"
#include "formats/byte_reader.h"
#include "formats/errors.h"
#include "mesh/triangle_mesh.h"
#include "scene/point_cloud.h"

namespace colmap_ext {

// The images that see each point, as the file has them: [P] image indices, not
// sorted, not checked.
using Visibility = Rows<uint32_t>;

// What a .vis lies beside, and what to do where the two do not fit.
struct VisibilityOwner {
  const char* name;
  const char* what_to_do;
  std::optional<Alternative> alternative;
};

// What users bring: a cloud that was cropped or cleaned in an editor, which
// leaves the .vis behind (COLMAP's issue 592), or that never had one (966).
inline constexpr VisibilityOwner kFusedCloud = {
    "cloud",
    "run `colmap stereo_fusion` again, whose two files belong together, or "
    "crop with a tool that drops the same points from both",
    Alternative::kUseSparsePoints};

// Reads a fused.ply.vis: uint64 P, then for each point uint32 n and n times
// uint32 image index, little-endian.
//
// \param num_points  of the cloud beside it.
// \param owner  what it lies beside, for the messages.
// \throw FileError if the file is missing, truncated, too long, or of another
//        number of points; it says what to do. Never allocates more than the
//        file's size justifies.
Visibility ReadVisibility(const std::filesystem::path& path, size_t num_points,
                          const VisibilityOwner& owner = kFusedCloud);

// Reads the same piece by piece.
class VisibilityReader {
 public:
  // \throw FileError as ReadVisibility(), for what the header shows
  VisibilityReader(const std::filesystem::path& path, size_t num_points,
                   const VisibilityOwner& owner = kFusedCloud);

  // Appends the rows of the next points.
  // \throw FileError if the file ends before
  void Read(size_t num_points, Visibility* visibility);

  uint64_t RemainingBytes() const { return reader_.Remaining(); }
  void ExpectEnd() const { reader_.ExpectEnd(); }

 private:
  ByteReader reader_;
  size_t point_ = 0;  // the next one
};

struct PlyCloud {
  std::vector<Eigen::Vector3f> positions;  // [P], may be NaN or infinite
  std::vector<Eigen::Vector3f> normals;    // [P] or empty
  std::vector<Color> colors;               // [P] or empty
  std::vector<float> confidences{};        // [P] in [0, 1] or empty
  std::vector<int32_t> labels{};           // [P] or empty; -1: none
};

// Reads the vertices of a PLY file: ASCII or binary of either byte order, the
// properties in any order and of any numeric type; colours are taken if they
// are uchar, confidences if they are float or double, the property label if it
// is int. Other properties, lists, and elements are skipped.
//
// COLMAP's reader (util/ply) is not used, as it aborts on what it does
// not expect and trusts counts, and none is packaged apart from libraries that
// bring a mesh type or more along.
//
// \throw FileError if the file is missing, truncated, or not such a PLY, or if
//        it has more points than 32-bit indices can number. Never allocates
//        more than the file's size justifies.
PlyCloud ReadPlyCloud(const std::filesystem::path& path);

// Points that follow each other in a cloud, and the images that see them.
struct CloudPiece {
  PlyCloud cloud;
  Visibility visibility;
};

// How many points a PLY file has.
// \throw FileError as ReadPlyCloud()
uint64_t CountPlyVertices(const std::filesystem::path& path);

// Reads a cloud and its .vis piece by piece, without ever holding more.
// \param visit  gets each piece, of max_points but the last
// \throw FileError as ReadPlyCloud() and ReadVisibility()
void StreamCloud(const std::filesystem::path& path,
                 const std::filesystem::path& visibility_path,
                 size_t max_points,
                 const std::function<void(CloudPiece piece)>& visit);

// Reads a triangle mesh, or a point cloud, which is one without facets, from a
// PLY file: ASCII or binary of either byte order, numbers of any type, faces as
// the list vertex_index or vertex_indices. Other properties and elements are
// skipped. Vertices may be NaN or infinite.
//
// \throw FileError if the file is missing, truncated, or not such a PLY; if it
//        has no vertices, or more vertices or half-edges than 32-bit indices
//        can number; if a face has not three corners, or a vertex that is
//        not there.
TriangleMesh ReadPlyMesh(const std::filesystem::path& path);

struct ColoredMesh {
  TriangleMesh mesh;
  std::vector<Color> colors;             // [V] or empty
  std::vector<float> confidences;        // [V] in [0, 1] or empty
  std::vector<Eigen::Vector3f> normals;  // [V] or empty
  std::vector<int32_t> labels;           // [F] or empty; -1: none
  std::vector<std::string> label_names;  // of the labels, as far as the file
                                         // names them
};

// The same with the vertices' colours, if they have uchar ones, their
// confidences, if they have float or double ones, clamped to [0, 1], their
// normals, and the facets' labels as WriteLabeledMesh() writes them.
ColoredMesh ReadColoredPlyMesh(const std::filesystem::path& path);

}  // namespace colmap_ext
