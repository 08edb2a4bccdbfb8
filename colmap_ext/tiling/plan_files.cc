#include "colmap_ext/tiling/plan_files.h"

#include <algorithm>
#include <span>
#include <string>
#include <utility>

#include "formats/errors.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// What the sections of the files are, in their order.
constexpr char kVerticesKind[] = "CEVERT03";
enum VerticesSection {
  kPositions,
  kRayOffsets,
  kRayViews,
  kRayAlphas,
  kSupports,
  kColors,
  kViewOffsets,
  kViews,
  kIsEnd,
  kNumVerticesSections
};

constexpr char kBlocksKind[] = "CEBLOCK3";
enum BlocksSection {
  kTileBegins,
  kBegins,
  kBoxes,
  kBlockViewOffsets,
  kBlockViews,
  kSum,
  kHaveEnds,
  kNumBlocksSections
};

constexpr char kCutKind[] = "CECUT004";
enum CutSection {
  kCutIds,
  kCutNumOwn,
  kCutFirstCells,
  kCutCells,
  kCutLabels,
  kCutCapacities,
  kCutSource,
  kCutSink,
  kCutUnknown,
  kCutShared,
  kNumCutSections
};

// \throw FileError if the tile is not done
fs::path DoneCutPath(const fs::path& folder, size_t tile) {
  const fs::path path = CutPath(folder, tile);
  if (!fs::exists(path)) {
    throw FileError(path, "tile " + std::to_string(tile) +
                              " is not done: run delaunay_manifold_mesher "
                              "--plan " +
                              folder.string() + " --tile " +
                              std::to_string(tile));
  }
  return path;
}

}  // namespace

void WriteVertices(const fs::path& folder, uint64_t identity, size_t tile,
                   const TileVertices& vertices) {
  SectionWriter file(VerticesPath(folder, tile), kVerticesKind, identity,
                     kNumVerticesSections);
  file.Add(vertices.positions);
  file.Add(vertices.observations.offsets);
  file.Add(vertices.observations.views);
  file.Add(vertices.observations.alphas);
  file.Add(vertices.supports);
  file.Add(vertices.colors);
  file.Add(vertices.views.offsets);
  file.Add(vertices.views.values);
  file.Add(vertices.observations.is_end);
  file.Commit();
}

void WriteBlocks(const fs::path& folder, uint64_t identity,
                 const PlanBlocks& blocks) {
  SectionWriter file(BlocksPath(folder), kBlocksKind, identity,
                     kNumBlocksSections);
  file.Add(blocks.tile_begins);
  file.Add(blocks.begins);
  file.Add(blocks.boxes);
  file.Add(blocks.views.offsets);
  file.Add(blocks.views.values);
  file.Add(std::vector<double>(blocks.sum.data(), blocks.sum.data() + 3));
  file.Add(blocks.have_ends);
  file.Commit();
}

void WriteCut(const fs::path& folder, uint64_t identity, size_t tile,
              const TileCut& cut, const TileSeam& seam) {
  SectionWriter file(CutPath(folder, tile), kCutKind, identity,
                     kNumCutSections);
  file.Add(cut.tile.ids);
  file.Add(std::vector<uint32_t>(1, cut.tile.num_own));
  file.Add(cut.tile.tetrahedra.vertex_cells);
  file.Add(cut.tile.tetrahedra.cells);
  file.Add(cut.labels.known);
  file.Add(cut.graph.capacities);
  file.Add(cut.graph.source);
  file.Add(cut.graph.sink);
  file.Add(seam.unknown);
  file.Add(seam.shared);
  file.Commit();
}

bool HasVertices(const fs::path& folder, uint64_t identity, size_t tile) {
  return HasSections(VerticesPath(folder, tile), kVerticesKind, identity,
                     kNumVerticesSections);
}

bool HasCut(const fs::path& folder, uint64_t identity, size_t tile) {
  return HasSections(CutPath(folder, tile), kCutKind, identity,
                     kNumCutSections);
}

FilePlan::FilePlan(const fs::path& folder, const Plan& plan)
    : files_([folder](size_t tile) { return VerticesPath(folder, tile); },
             kVerticesKind, plan.identity, kNumVerticesSections,
             plan.tiles.size()) {
  const SectionReader file(BlocksPath(folder), kBlocksKind, plan.identity,
                           kNumBlocksSections);
  blocks_.tile_begins = file.ReadAll<uint32_t>(kTileBegins);
  blocks_.begins = file.ReadAll<uint32_t>(kBegins);
  blocks_.boxes = file.ReadAll<Eigen::AlignedBox3f>(kBoxes);
  blocks_.views = Rows<uint32_t>(file.ReadAll<uint64_t>(kBlockViewOffsets),
                                 file.ReadAll<uint32_t>(kBlockViews));
  const auto sum = file.Read<double>(kSum, 0, 3);
  blocks_.sum = Eigen::Vector3d(sum.data());
  blocks_.have_ends = file.ReadAll<uint8_t>(kHaveEnds);
  if (blocks_.NumTiles() != plan.tiles.size()) {
    throw FileError(BlocksPath(folder), "damaged: plan again by mesh_planner");
  }
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
  const uint64_t to = read.offsets.back();
  read.views = file->Read<uint32_t>(kRayViews, from, to);
  read.alphas = file->Read<float>(kRayAlphas, from, to);
  if (file->Count<uint8_t>(kIsEnd) > 0) {
    read.is_end = file->Read<uint8_t>(kIsEnd, begin - first, end - first);
  }
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
    const auto colors = file->Count<Color>(kColors) > 0
                            ? file->Read<Color>(kColors, begin, end)
                            : std::vector<Color>();
    const auto is_end = file->Count<uint8_t>(kIsEnd) > 0
                            ? file->Read<uint8_t>(kIsEnd, begin, end)
                            : std::vector<uint8_t>(end - begin, 0);
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
    : files_([folder](size_t tile) { return DoneCutPath(folder, tile); },
             kCutKind, plan.identity, kNumCutSections, plan.tiles.size()) {}

TileSeam FileParts::ReadSeam(uint32_t tile) const {
  return {files_.Open(tile)->ReadAll<UnknownCell>(kCutUnknown),
          files_.Open(tile)->ReadAll<SharedCell>(kCutShared)};
}

TilePart FileParts::ReadPart(uint32_t tile) const {
  const auto file = files_.Open(tile);
  TilePart part;
  part.tile.ids = file->ReadAll<uint32_t>(kCutIds);
  part.tile.num_own = file->Read<uint32_t>(kCutNumOwn, 0, 1)[0];
  Tetrahedralization& tetrahedra = part.tile.tetrahedra;
  tetrahedra.cells = file->ReadAll<Tetrahedralization::Cell>(kCutCells);
  tetrahedra.points.assign(part.tile.ids.size(), Eigen::Vector3f::Zero());
  tetrahedra.vertex_cells = file->ReadAll<uint32_t>(kCutFirstCells);
  part.labels = file->ReadAll<uint8_t>(kCutLabels);
  return part;
}

PartVertices FileParts::ReadVertices(uint32_t tile) const {
  return {files_.Open(tile)->ReadAll<uint32_t>(kCutIds),
          files_.Open(tile)->ReadAll<uint32_t>(kCutFirstCells)};
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
  read.graph.capacities =
      file->Read<std::array<uint32_t, 4>>(kCutCapacities, begin, end);
  read.graph.source = file->Read<uint32_t>(kCutSource, begin, end);
  read.graph.sink = file->Read<uint32_t>(kCutSink, begin, end);
  return read;
}

}  // namespace colmap_ext
