#include "colmap_ext/jobs/plan_files.h"

#include <span>

#include <fmt/format.h>

#include "formats/errors.h"

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

// Files that are open at once, as a plan may have more tiles than a process may
// open files. Of the 1,024 that a process may usually open the merger needs
// twice as many, and some more. A choice.
constexpr size_t kMaxOpen = 128;

}  // namespace

fs::path BlocksPath(const fs::path& folder) { return folder / "blocks.bin"; }

fs::path VerticesPath(const fs::path& folder, size_t tile) {
  return folder / fmt::format("tile{:05}.vertices.bin", tile);
}

fs::path CutPath(const fs::path& folder, size_t tile) {
  return folder / fmt::format("tile{:05}.cut.bin", tile);
}

void WriteVertices(const fs::path& folder, uint64_t identity, size_t tile,
                   const TileVertices& vertices) {
  JobFileWriter file(VerticesPath(folder, tile), kVerticesKind, identity);
  const Observations& observations = vertices.observations;
  file.Add(vertices.positions, observations.offsets, observations.values,
           observations.is_end, vertices.supports, vertices.colors,
           vertices.views);
  file.Commit();
}

void WriteBlocks(const fs::path& folder, uint64_t identity,
                 const PlanBlocks& blocks) {
  JobFileWriter file(BlocksPath(folder), kBlocksKind, identity);
  file.Add(blocks.tile_begins, blocks.begins, blocks.boxes, blocks.views,
           blocks.sum, blocks.have_ends);
  file.Commit();
}

void WriteCut(const fs::path& folder, uint64_t identity, size_t tile,
              const TileCut& cut, const TileSeam& seam) {
  JobFileWriter file(CutPath(folder, tile), kCutKind, identity);
  file.Add(cut.tile.ids, cut.tile.num_own, cut.tile.tetrahedra.vertex_cells,
           cut.tile.tetrahedra.cells, cut.labels.known, cut.graph, seam.unknown,
           seam.shared);
  file.Commit();
}

bool HasVertices(const fs::path& folder, uint64_t identity, size_t tile) {
  return HasJobFile(VerticesPath(folder, tile), kVerticesKind, identity);
}

bool HasCut(const fs::path& folder, uint64_t identity, size_t tile) {
  return HasJobFile(CutPath(folder, tile), kCutKind, identity);
}

FilePlan::FilePlan(const fs::path& folder, const Plan& plan)
    : folder_(folder), identity_(plan.identity), open_(kMaxOpen) {
  const JobFileReader file(BlocksPath(folder), kBlocksKind, identity_);
  file.ReadFrom(0, &blocks_.tile_begins, &blocks_.begins, &blocks_.boxes,
                &blocks_.views, &blocks_.sum, &blocks_.have_ends);
  for (size_t tile = 0; tile < plan.tiles.size(); ++tile) {
    Open(tile);
  }
}

std::shared_ptr<const JobFileReader> FilePlan::Open(size_t tile) const {
  return open_.Get(tile, 1, [&] {
    return std::make_shared<const JobFileReader>(VerticesPath(folder_, tile),
                                                 kVerticesKind, identity_);
  });
}

std::vector<Eigen::Vector3f> FilePlan::ReadPositions(uint32_t begin,
                                                     uint32_t end) const {
  if (begin == end) {
    return {};
  }
  const uint32_t tile = blocks_.TileOf(begin);
  const uint32_t first = blocks_.FirstVertex(tile);
  return Open(tile)->Read<Eigen::Vector3f>(kPositions, begin - first,
                                           end - first);
}

Observations FilePlan::ReadObservations(uint32_t begin, uint32_t end) const {
  Observations read;
  if (begin == end) {
    return read;
  }
  const uint32_t tile = blocks_.TileOf(begin);
  const uint32_t first = blocks_.FirstVertex(tile);
  const auto file = Open(tile);
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
    const auto file = Open(tile);
    const auto supports = file->Read<float>(kSupports, begin, end);
    const auto colors = file->ReadIfAny<Color>(kColors, begin, end);
    auto is_end = file->ReadIfAny<uint8_t>(kIsEnd, begin, end);
    is_end.resize(end - begin, 0);
    const auto offsets = file->Read<uint64_t>(kViewOffsets, begin, end + 1);
    const auto views =
        file->Read<uint32_t>(kViews, offsets.front(), offsets.back());
    for (; it != ids.end() && *it < blocks_.begins[block + 1]; ++it) {
      const uint32_t vertex = *it - first - begin;
      read.supports.push_back(supports[vertex]);
      if (!colors.empty()) {
        read.colors.push_back(colors[vertex]);
      }
      read.observations.is_end.push_back(is_end[vertex]);
      read.views.AddRow(std::span(views).subspan(
          offsets[vertex] - offsets[0], offsets[vertex + 1] - offsets[vertex]));
    }
  }
  return read;
}

FileParts::FileParts(const fs::path& folder, const Plan& plan)
    : folder_(folder), identity_(plan.identity), open_(kMaxOpen) {
  for (size_t tile = 0; tile < plan.tiles.size(); ++tile) {
    if (!fs::exists(CutPath(folder, tile))) {
      throw FileError(CutPath(folder, tile),
                      fmt::format("tile {0} is not done: run "
                                  "delaunay_manifold_mesher --plan_path {1} "
                                  "--tile "
                                  "{0}",
                                  tile, folder.string()));
    }
    Open(tile);
  }
}

std::shared_ptr<const JobFileReader> FileParts::Open(size_t tile) const {
  return open_.Get(tile, 1, [&] {
    return std::make_shared<const JobFileReader>(CutPath(folder_, tile),
                                                 kCutKind, identity_);
  });
}

TileSeam FileParts::ReadSeam(uint32_t tile) const {
  TileSeam seam;
  Open(tile)->ReadFrom(kCutUnknown, &seam.unknown, &seam.shared);
  return seam;
}

TilePart FileParts::ReadPart(uint32_t tile) const {
  TilePart part;
  Tetrahedralization& tetrahedra = part.tile.tetrahedra;
  Open(tile)->ReadFrom(kCutIds, &part.tile.ids, &part.tile.num_own,
                       &tetrahedra.vertex_cells, &tetrahedra.cells,
                       &part.labels);
  tetrahedra.points.assign(part.tile.ids.size(), Eigen::Vector3f::Zero());
  return part;
}

PartVertices FileParts::ReadVertices(uint32_t tile) const {
  const auto file = Open(tile);
  return {file->ReadAll<uint32_t>(kCutIds),
          file->ReadAll<uint32_t>(kCutFirstCells)};
}

uint32_t FileParts::NumCells(uint32_t tile) const {
  return static_cast<uint32_t>(Open(tile)->Count<uint8_t>(kCutLabels));
}

PartCells FileParts::ReadCells(uint32_t tile, uint32_t begin,
                               uint32_t end) const {
  const auto file = Open(tile);
  PartCells read;
  read.cells = file->Read<Tetrahedralization::Cell>(kCutCells, begin, end);
  read.labels = file->Read<uint8_t>(kCutLabels, begin, end);
  read.graph = file->Read<NodeCapacities>(kCutCapacities, begin, end);
  return read;
}

}  // namespace colmap_ext
