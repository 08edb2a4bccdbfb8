#include "colmap_ext/tiling/surface_files.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "tiles/tile_cells.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// What the sections of the files are, in their order.
constexpr char kSurfaceKind[] = "CESURF01";
enum SurfaceSection {
  kPositions,
  kColors,
  kConfidences,
  kViewOffsets,
  kViews,
  kFacets,
  kBoxes,
  kNumSurfaceSections
};

constexpr char kPatchKind[] = "CEPATCH1";
enum PatchSection {  // those above, but with one box, and:
  kIds = kNumSurfaceSections,
  kRemoved,
  kNumPatchSections
};

// Facets of a block. Tens of them make a tile of the smallest surveys.
constexpr size_t kBlockFacets = 4096;

// Vertices that are not needed, but read to be done with one reading.
constexpr uint32_t kMaxGap = 256;

void AddMesh(const TriangleMesh& mesh, const VertexAttributes& attributes,
             SectionWriter* file) {
  file->Add(mesh.vertices);
  file->Add(attributes.colors);
  file->Add(attributes.confidences);
  file->Add(attributes.views.offsets);
  file->Add(attributes.views.values);
  file->Add(mesh.facets);
}

// Appends vertices of a file to a part.
void ReadVertices(const SectionReader& file, uint32_t begin, uint32_t end,
                  SurfacePart* part) {
  const auto append = [](const auto& from, auto* to) {
    to->insert(to->end(), from.begin(), from.end());
  };
  append(file.Read<Eigen::Vector3f>(kPositions, begin, end),
         &part->mesh.vertices);
  VertexAttributes& attributes = part->attributes;
  if (file.Count<Color>(kColors) > 0) {
    append(file.Read<Color>(kColors, begin, end), &attributes.colors);
  }
  if (file.Count<float>(kConfidences) > 0) {
    append(file.Read<float>(kConfidences, begin, end), &attributes.confidences);
  }
  const auto offsets = file.Read<uint64_t>(kViewOffsets, begin, end + 1);
  const auto views =
      file.Read<uint32_t>(kViews, offsets.front(), offsets.back());
  for (size_t i = 0; i + 1 < offsets.size(); ++i) {
    attributes.views.values.insert(
        attributes.views.values.end(),
        views.begin() + static_cast<ptrdiff_t>(offsets[i] - offsets[0]),
        views.begin() + static_cast<ptrdiff_t>(offsets[i + 1] - offsets[0]));
    attributes.views.EndRow();
  }
  for (uint32_t vertex = begin; vertex < end; ++vertex) {
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

fs::path SurfacePath(const fs::path& folder) {
  return folder / "refine.surface.bin";
}

fs::path PatchPath(const fs::path& folder, size_t tile) {
  return folder / fmt::format("tile{:05}.refined.bin", tile);
}

void WriteSurface(const fs::path& folder, uint64_t identity,
                  const TriangleMesh& mesh,
                  const VertexAttributes& attributes) {
  std::vector<Eigen::AlignedBox3f> boxes;
  for (size_t first = 0; first < mesh.facets.size(); first += kBlockFacets) {
    const size_t last = std::min(first + kBlockFacets, mesh.facets.size());
    Eigen::AlignedBox3f box;
    for (size_t facet = first; facet < last; ++facet) {
      box.extend(BoxOf(mesh, mesh.facets[facet]));
    }
    boxes.push_back(box);
  }
  SectionWriter file(SurfacePath(folder), kSurfaceKind, identity,
                     kNumSurfaceSections);
  AddMesh(mesh, attributes, &file);
  file.Add(boxes);
  file.Commit();
}

void WritePatch(const fs::path& folder, uint64_t identity, size_t tile,
                const TilePatch& patch) {
  SectionWriter file(PatchPath(folder, tile), kPatchKind, identity,
                     kNumPatchSections);
  AddMesh(patch.part.mesh, patch.part.attributes, &file);
  file.Add(std::vector<Eigen::AlignedBox3f>{patch.box});
  file.Add(patch.part.ids);
  file.Add(patch.removed);
  file.Commit();
}

bool HasSurface(const fs::path& folder, uint64_t identity) {
  return HasSections(SurfacePath(folder), kSurfaceKind, identity,
                     kNumSurfaceSections);
}

bool HasPatch(const fs::path& folder, uint64_t identity, size_t tile) {
  return HasSections(PatchPath(folder, tile), kPatchKind, identity,
                     kNumPatchSections);
}

FileSurface::FileSurface(fs::path folder, uint64_t identity)
    : folder_(std::move(folder)),
      identity_(identity),
      file_(SurfacePath(folder_), kSurfaceKind, identity, kNumSurfaceSections) {
  boxes_ = file_.ReadAll<Eigen::AlignedBox3f>(kBoxes);
}

SurfacePart FileSurface::ReadBlock(size_t block) const {
  const size_t first = block * kBlockFacets;
  const size_t last =
      std::min(first + kBlockFacets, file_.Count<Facet>(kFacets));
  SurfacePart part;
  part.mesh.facets = file_.Read<Facet>(kFacets, first, last);
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

SectionReader FileSurface::Patch(uint32_t tile) const {
  return {PatchPath(folder_, tile), kPatchKind, identity_, kNumPatchSections};
}

Eigen::AlignedBox3f FileSurface::PatchBox(uint32_t tile) const {
  return Patch(tile).Read<Eigen::AlignedBox3f>(kBoxes, 0, 1)[0];
}

std::vector<SurfaceId> FileSurface::ReadRemoved(uint32_t tile) const {
  return Patch(tile).ReadAll<SurfaceId>(kRemoved);
}

SurfacePart FileSurface::ReadPatchPart(uint32_t tile) const {
  const SectionReader file = Patch(tile);
  SurfacePart part;
  part.mesh.facets = file.ReadAll<Facet>(kFacets);
  ReadVertices(file, 0,
               static_cast<uint32_t>(file.Count<Eigen::Vector3f>(kPositions)),
               &part);
  part.ids = file.ReadAll<SurfaceId>(kIds);
  for (size_t i = 0; i < part.mesh.facets.size(); ++i) {
    part.facet_ids.push_back(PatchId(tile, i));
  }
  return part;
}

}  // namespace colmap_ext
