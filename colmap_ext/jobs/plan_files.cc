#include "colmap_ext/jobs/plan_files.h"

#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "base/indices.h"
#include "mesh/adjacency.h"
#include "spatial/facet_tree.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// The kinds of files, and their sections in order.
constexpr JobFileKind kVerticesKind = {"CEVERT05", "run mesh_planner again"};
enum VerticesSection {
  kPositions,
  kRayOffsets,
  kRays,
  kIsEnd,
  kSupports,
  kNoises,
  kColors,
  kViewOffsets,
  kViews
};

constexpr JobFileKind kBlocksKind = {"CEBLOCK4", "run mesh_planner again"};

constexpr JobFileKind kCutKind = {"CECUT006",
                                  "remove it, and run its tile again"};
enum CutSection {
  kCutIds,
  kCutNumOwn,
  kCutFirstCells,
  kCutCells,
  kCutLabels,
  kCutCapacities,
  kCutUnknown,
  kCutShared
};

// Files of a kind that are open at once. Of the 1,024 that a process may
// usually open the merger needs twice as many, and some more. A choice.
constexpr size_t kMaxOpen = 128;

const Plan& ExpectDone(const Plan& plan) {
  for (size_t tile = 0; tile < plan.tiles.size(); ++tile) {
    const fs::path path = CutFile(plan, tile).path;
    if (!fs::exists(path)) {
      throw FileError(path, fmt::format("tile {0} is not done: run "
                                        "delaunay_manifold_mesher --plan_path "
                                        "{1} --tile {0}",
                                        tile, plan.folder.string()));
    }
  }
  return plan;
}

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
  VertexAttributes& attributes = part->attributes;
  Append(file.Read<Eigen::Vector3f>(kSurfacePositions, begin, end),
         &part->mesh.vertices);
  Append(file.ReadIfAny<Color>(kSurfaceColors, begin, end), &attributes.colors);
  Append(file.ReadIfAny<float>(kSurfaceConfidences, begin, end),
         &attributes.confidences);
  const auto offsets = file.Read<uint64_t>(kSurfaceViewOffsets, begin, end + 1);
  const uint64_t first = attributes.views.values.size();
  Append(file.Read<uint32_t>(kSurfaceViews, offsets.front(), offsets.back()),
         &attributes.views.values);
  for (uint32_t vertex = begin; vertex < end; ++vertex) {
    attributes.views.offsets.push_back(first + offsets[vertex - begin + 1] -
                                       offsets[0]);
    part->ids.push_back(BaseId(vertex));
  }
}

}  // namespace

JobFile BlocksFile(const Plan& plan) {
  return {plan.folder / "blocks.bin", kBlocksKind, plan.identity};
}

JobFile VerticesFile(const Plan& plan, size_t tile) {
  return {plan.folder / fmt::format("tile{:05}.vertices.bin", tile),
          kVerticesKind, plan.identity};
}

JobFile CutFile(const Plan& plan, size_t tile) {
  return {plan.folder / fmt::format("tile{:05}.cut.bin", tile), kCutKind,
          plan.identity};
}

void Write(const JobFile& file, const TileVertices& vertices) {
  const Observations& observations = vertices.observations;
  WriteJobFile(file, vertices.positions, observations.offsets,
               observations.values, observations.is_end, vertices.supports,
               vertices.noises, vertices.attributes.colors,
               vertices.attributes.views);
}

void Write(const JobFile& file, const PlanBlocks& blocks) {
  WriteJobFile(file, blocks.tile_begins, blocks.begins, blocks.boxes,
               blocks.views, blocks.sum, blocks.have_ends);
}

void Write(const JobFile& file, const TileCut& cut, const TileSeam& seam) {
  WriteJobFile(file, cut.tile.ids, cut.tile.num_own,
               cut.tile.tetrahedra.vertex_cells, cut.tile.tetrahedra.cells,
               cut.labels.known, cut.graph, seam.unknown, seam.shared);
}

TileFiles::TileFiles(const Plan& plan, Find find)
    : plan_(plan), find_(find), open_(kMaxOpen) {
  for (size_t tile = 0; tile < plan.tiles.size(); ++tile) {
    Open(tile);
  }
}

std::shared_ptr<const JobFileReader> TileFiles::Open(size_t tile) const {
  return open_.Get(tile, 1, [&] {
    return std::make_shared<const JobFileReader>(find_(plan_, tile));
  });
}

FilePlan::FilePlan(const Plan& plan) : files_(plan, &VerticesFile) {
  const JobFileReader file(BlocksFile(plan));
  file.ReadFrom(0, &blocks_.tile_begins, &blocks_.begins, &blocks_.boxes,
                &blocks_.views, &blocks_.sum, &blocks_.have_ends);
}

std::vector<Eigen::Vector3f> FilePlan::ReadPositions(uint32_t begin,
                                                     uint32_t end) const {
  if (begin == end) {
    return {};
  }
  const uint32_t tile = blocks_.TileOf(begin);
  const uint32_t first = blocks_.FirstVertex(tile);
  return files_.Open(tile)->Read<Eigen::Vector3f>(kPositions, begin - first,
                                                  end - first);
}

Observations FilePlan::ReadObservations(uint32_t begin, uint32_t end) const {
  Observations read;
  if (begin == end) {
    return read;
  }
  const uint32_t tile = blocks_.TileOf(begin);
  const uint32_t first = blocks_.FirstVertex(tile);
  const auto file = files_.Open(tile);
  read.offsets =
      file->Read<uint64_t>(kRayOffsets, begin - first, end - first + 1);
  const uint64_t from = read.offsets.front();
  read.values = file->Read<Observation>(kRays, from, read.offsets.back());
  read.is_end = file->ReadIfAny<uint8_t>(kIsEnd, begin - first, end - first);
  for (uint64_t& offset : read.offsets) {
    offset -= from;
  }
  return read;
}

TileVertices FilePlan::ReadAttributes(const std::vector<uint32_t>& ids) const {
  TileVertices read;
  for (auto it = ids.begin(); it != ids.end();) {
    const uint32_t block = blocks_.BlockOf(*it);
    const uint32_t tile = blocks_.TileOf(*it);
    const uint32_t first = blocks_.FirstVertex(tile);
    const uint32_t begin = blocks_.begins[block] - first;
    const uint32_t end = blocks_.begins[block + 1] - first;
    const auto file = files_.Open(tile);
    const auto supports = file->Read<float>(kSupports, begin, end);
    const auto noises = file->Read<float>(kNoises, begin, end);
    const auto colors = file->ReadIfAny<Color>(kColors, begin, end);
    auto is_end = file->ReadIfAny<uint8_t>(kIsEnd, begin, end);
    is_end.resize(end - begin, 0);
    const auto offsets = file->Read<uint64_t>(kViewOffsets, begin, end + 1);
    const auto views =
        file->Read<uint32_t>(kViews, offsets.front(), offsets.back());
    for (; it != ids.end() && *it < blocks_.begins[block + 1]; ++it) {
      const uint32_t vertex = *it - first - begin;
      read.supports.push_back(supports[vertex]);
      read.noises.push_back(noises[vertex]);
      AppendIfAny(colors, vertex, &read.attributes.colors);
      read.observations.is_end.push_back(is_end[vertex]);
      read.attributes.views.AddRow(std::span(views).subspan(
          offsets[vertex] - offsets[0], offsets[vertex + 1] - offsets[vertex]));
    }
  }
  return read;
}

FileParts::FileParts(const Plan& plan) : files_(ExpectDone(plan), &CutFile) {}

TileSeam FileParts::ReadSeam(uint32_t tile) const {
  TileSeam seam;
  files_.Open(tile)->ReadFrom(kCutUnknown, &seam.unknown, &seam.shared);
  return seam;
}

TilePart FileParts::ReadPart(uint32_t tile) const {
  TilePart part;
  Tetrahedralization& tetrahedra = part.tile.tetrahedra;
  files_.Open(tile)->ReadFrom(kCutIds, &part.tile.ids, &part.tile.num_own,
                              &tetrahedra.vertex_cells, &tetrahedra.cells,
                              &part.labels);
  tetrahedra.points.assign(part.tile.ids.size(), Eigen::Vector3f::Zero());
  return part;
}

PartVertices FileParts::ReadVertices(uint32_t tile) const {
  const auto file = files_.Open(tile);
  return {file->ReadAll<uint32_t>(kCutIds),
          file->ReadAll<uint32_t>(kCutFirstCells)};
}

uint32_t FileParts::NumCells(uint32_t tile) const {
  return static_cast<uint32_t>(files_.Open(tile)->Count<uint8_t>(kCutLabels));
}

PartCells FileParts::ReadCells(uint32_t tile, uint32_t begin,
                               uint32_t end) const {
  const auto file = files_.Open(tile);
  PartCells read;
  read.cells = file->Read<Tetrahedralization::Cell>(kCutCells, begin, end);
  read.labels = file->Read<uint8_t>(kCutLabels, begin, end);
  read.graph = file->Read<NodeCapacities>(kCutCapacities, begin, end);
  return read;
}

JobFile SurfaceFile(const RefinementPlan& plan) {
  return {plan.folder / "refine.surface.bin", kSurfaceKind, plan.identity};
}

JobFile PatchFile(const RefinementPlan& plan, size_t tile) {
  return {plan.folder / fmt::format("tile{:05}.refined.bin", tile), kPatchKind,
          plan.identity};
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

FileSurface::FileSurface(const RefinementPlan& plan)
    : plan_(plan),
      file_(SurfaceFile(plan)),
      boxes_(file_.ReadAll<Eigen::AlignedBox3f>(kSurfaceBoxes)) {}

SurfacePart FileSurface::ReadBlock(size_t block) const {
  const size_t first = block * kBlockFacets;
  const size_t last =
      std::min(first + kBlockFacets, file_.Count<Facet>(kSurfaceFacets));
  SurfacePart part;
  part.mesh.facets = file_.Read<Facet>(kSurfaceFacets, first, last);
  const std::vector<uint32_t> vertices =
      VerticesOf(part.mesh, Iota(last - first));
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
      vertex = IndexOf(part.ids, BaseId(vertex));
    }
    part.facet_ids.push_back(BaseId(first + part.facet_ids.size()));
  }
  return part;
}

JobFileReader FileSurface::Patch(uint32_t tile) const {
  return JobFileReader(PatchFile(plan_, tile));
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
