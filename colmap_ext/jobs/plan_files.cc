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

const Plan& ExpectDone(const fs::path& folder, const Plan& plan) {
  for (size_t tile = 0; tile < plan.tiles.size(); ++tile) {
    const fs::path path = CutFile(folder, plan.identity, tile).path;
    if (!fs::exists(path)) {
      throw FileError(path, fmt::format("tile {0} is not done: run "
                                        "delaunay_manifold_mesher --plan_path "
                                        "{1} --tile {0}",
                                        tile, folder.string()));
    }
  }
  return plan;
}

}  // namespace

JobFile BlocksFile(const fs::path& folder, uint64_t identity) {
  return {folder / "blocks.bin", kBlocksKind, identity};
}

JobFile VerticesFile(const fs::path& folder, uint64_t identity, size_t tile) {
  return {folder / fmt::format("tile{:05}.vertices.bin", tile), kVerticesKind,
          identity};
}

JobFile CutFile(const fs::path& folder, uint64_t identity, size_t tile) {
  return {folder / fmt::format("tile{:05}.cut.bin", tile), kCutKind, identity};
}

void Write(const JobFile& file, const TileVertices& vertices) {
  const Observations& observations = vertices.observations;
  WriteJobFile(file, vertices.positions, observations.offsets,
               observations.values, observations.is_end, vertices.supports,
               vertices.noises, vertices.colors, vertices.views);
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

TileFiles::TileFiles(const fs::path& folder, const Plan& plan, Find find)
    : folder_(folder), identity_(plan.identity), find_(find), open_(kMaxOpen) {
  for (size_t tile = 0; tile < plan.tiles.size(); ++tile) {
    Open(tile);
  }
}

std::shared_ptr<const JobFileReader> TileFiles::Open(size_t tile) const {
  return open_.Get(tile, 1, [&] {
    return std::make_shared<const JobFileReader>(
        find_(folder_, identity_, tile));
  });
}

FilePlan::FilePlan(const fs::path& folder, const Plan& plan)
    : files_(folder, plan, &VerticesFile) {
  const JobFileReader file(BlocksFile(folder, plan.identity));
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
    : files_(folder, ExpectDone(folder, plan), &CutFile) {}

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

}  // namespace colmap_ext
