#include "colmap_ext/jobs/plan_files.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "spatial/facet_tree.h"
#include "tiles/tile_cells.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// The kinds of files, and their sections in order.
constexpr JobFileKind kSurfaceKind = {
    "CESURF02",
    "run facetwise_refiner --plan_path PLAN --input_path MESH again"};
enum SurfaceSection {
  kSurfacePositions,
  kSurfaceColors,
  kSurfaceConfidences,
  kSurfaceViewOffsets,
  kSurfaceViews,
  kSurfaceFacets,
  kSurfaceBoxes
};

constexpr JobFileKind kPatchKind = {"CEPATCH2",
                                    "remove it, and refine its tile again"};
enum PatchSection {  // those above, but with one box, and:
  kPatchIds = kSurfaceBoxes + 1,
  kPatchRemoved
};

// Facets of a block. Tens of them make a tile of the smallest surveys.
constexpr size_t kBlockFacets = 4096;

// Vertices that are not needed, but read to be done with one reading.
constexpr uint32_t kMaxGap = 256;

// Appends vertices of a file to a part.
void ReadVertices(const JobFileReader& file, uint32_t begin, uint32_t end,
                  SurfacePart* part) {
  const auto append = [](const auto& from, auto* to) {
    to->insert(to->end(), from.begin(), from.end());
  };
  VertexAttributes& attributes = part->attributes;
  append(file.Read<Eigen::Vector3f>(kSurfacePositions, begin, end),
         &part->mesh.vertices);
  append(file.ReadIfAny<Color>(kSurfaceColors, begin, end), &attributes.colors);
  append(file.ReadIfAny<float>(kSurfaceConfidences, begin, end),
         &attributes.confidences);
  const auto offsets = file.Read<uint64_t>(kSurfaceViewOffsets, begin, end + 1);
  const uint64_t first = attributes.views.values.size();
  append(file.Read<uint32_t>(kSurfaceViews, offsets.front(), offsets.back()),
         &attributes.views.values);
  for (uint32_t vertex = begin; vertex < end; ++vertex) {
    attributes.views.offsets.push_back(first + offsets[vertex - begin + 1] -
                                       offsets[0]);
    part->ids.push_back(BaseId(vertex));
  }
}

// The vertices that facets use, ascending.
std::vector<uint32_t> VerticesOf(const std::vector<Facet>& facets) {
  std::vector<uint32_t> vertices;
  for (const Facet& facet : facets) {
    vertices.insert(vertices.end(), facet.begin(), facet.end());
  }
  std::ranges::sort(vertices);
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

}  // namespace

JobFile SurfaceFile(const fs::path& folder, uint64_t identity) {
  return {folder / "refine.surface.bin", kSurfaceKind, identity};
}

JobFile PatchFile(const fs::path& folder, uint64_t identity, size_t tile) {
  return {folder / fmt::format("tile{:05}.refined.bin", tile), kPatchKind,
          identity};
}

void Write(const JobFile& file, const TriangleMesh& mesh,
           const VertexAttributes& attributes) {
  std::vector<Eigen::AlignedBox3f> boxes(
      (mesh.facets.size() + kBlockFacets - 1) / kBlockFacets);
  for (size_t facet = 0; facet < mesh.facets.size(); ++facet) {
    boxes[facet / kBlockFacets].extend(BoxOf(mesh, mesh.facets[facet]));
  }
  WriteJobFile(file, mesh.vertices, attributes.colors, attributes.confidences,
               attributes.views, mesh.facets, boxes);
}

void Write(const JobFile& file, const TilePatch& patch) {
  const VertexAttributes& attributes = patch.part.attributes;
  WriteJobFile(file, patch.part.mesh.vertices, attributes.colors,
               attributes.confidences, attributes.views, patch.part.mesh.facets,
               patch.box, patch.part.ids, patch.removed);
}

FileSurface::FileSurface(fs::path folder, uint64_t identity)
    : folder_(std::move(folder)),
      identity_(identity),
      file_(SurfaceFile(folder_, identity)),
      boxes_(file_.ReadAll<Eigen::AlignedBox3f>(kSurfaceBoxes)) {}

SurfacePart FileSurface::ReadBlock(size_t block) const {
  const size_t first = block * kBlockFacets;
  const size_t last =
      std::min(first + kBlockFacets, file_.Count<Facet>(kSurfaceFacets));
  SurfacePart part;
  part.mesh.facets = file_.Read<Facet>(kSurfaceFacets, first, last);
  const std::vector<uint32_t> vertices = VerticesOf(part.mesh.facets);
  for (size_t i = 0; i < vertices.size();) {
    size_t end = i + 1;
    while (end < vertices.size() &&
           vertices[end] - vertices[end - 1] <= kMaxGap) {
      ++end;
    }
    ReadVertices(file_, vertices[i], vertices[end - 1] + 1, &part);
    i = end;
  }
  for (Facet& facet : part.mesh.facets) {
    for (uint32_t& vertex : facet) {
      vertex = static_cast<uint32_t>(
          std::ranges::lower_bound(part.ids, BaseId(vertex)) -
          part.ids.begin());
    }
    part.facet_ids.push_back(BaseId(first + part.facet_ids.size()));
  }
  return part;
}

JobFileReader FileSurface::Patch(uint32_t tile) const {
  return JobFileReader(PatchFile(folder_, identity_, tile));
}

Eigen::AlignedBox3f FileSurface::PatchBox(uint32_t tile) const {
  return Patch(tile).Read<Eigen::AlignedBox3f>(kSurfaceBoxes, 0, 1)[0];
}

std::vector<SurfaceId> FileSurface::ReadRemoved(uint32_t tile) const {
  return Patch(tile).ReadAll<SurfaceId>(kPatchRemoved);
}

SurfacePart FileSurface::ReadPatchPart(uint32_t tile) const {
  const JobFileReader file = Patch(tile);
  SurfacePart part;
  VertexAttributes& attributes = part.attributes;
  file.ReadFrom(kSurfacePositions, &part.mesh.vertices, &attributes.colors,
                &attributes.confidences, &attributes.views, &part.mesh.facets);
  file.ReadFrom(kPatchIds, &part.ids);
  for (size_t i = 0; i < part.mesh.facets.size(); ++i) {
    part.facet_ids.push_back(PatchId(tile, i));
  }
  return part;
}

}  // namespace colmap_ext
