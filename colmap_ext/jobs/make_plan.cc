#include "colmap_ext/jobs/mesh_tiles.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "colmap_ext/jobs/plan_files.h"
#include "colmap_ext/jobs/tile_points.h"
#include "meshing/wall_layers.h"
#include "tiles/plan_vertices.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

// Points that are held to find the order of the images, to share out the
// others, and to calibrate the half pixel.
constexpr size_t kMaxPlannedPoints = 1 << 20;
constexpr size_t kPiecePoints = 1 << 18;

// Of max_memory_gb, for masks that are kept. A choice.
constexpr double kMaskShare = 0.25;

// What thinning takes, GB a point. Measured on: fountain tiled.
constexpr double kThinningGb = 400e-9;

class Planner {
 public:
  Planner(const PlannerOptions& options, const PictureDecoder& decoder,
          const Progress& progress, PlanReport* report)
      : options_(options),
        decoder_(decoder),
        progress_(progress),
        report_(report),
        files_(FindFusedFiles(options.mesher.InputPath(),
                              options.mesher.workspace)),
        num_points_(CountPlyVertices(files_.path)) {
    plan_.folder = options.output_path;
  }

  Plan Run() {
    Identify();
    if (IsThere()) {
      report_->is_kept = true;
      return ReadPlan(plan_.folder);
    }
    fs::remove(PlanPath(plan_.folder));
    Report(progress_, "Sampling the points", 0);
    WorkspaceOptions sampled = options_.mesher.workspace;
    sampled.max_points = kMaxPlannedPoints;
    sample_ = ReadWorkspace(options_.mesher.InputPath(), sampled, decoder_);
    report_->workspace = sample_.report;
    plan_.views = sample_.views;
    CalibrateHalfPixel();
    plan_.region = options_.mesher.scene.region.Resolve(sample_.views,
                                                        sample_.sparse_points);
    ReadMasks();
    CropSample();
    const SplitTree tree = SplitSample(num_tiles_);
    for (const Eigen::AlignedBox3f& cell : tree.Cells()) {
      plan_.tiles.emplace_back().cell = cell;
    }
    TilePoints points(plan_, tree, num_points_, options_.mesher, read_mask_,
                      report_);
    ShareOut(&points);
    ThinTiles(&points);
    plan_.merger_memory_gb = MergerMemoryGb(plan_, options_);
    WritePlan(plan_);
    return plan_;
  }

 private:
  void Identify() {
    num_tiles_ = options_.num_tiles > 0
                     ? static_cast<size_t>(options_.num_tiles)
                     : NumTilesForMemory(options_, num_points_);
    PlannerOptions typed = options_;
    std::string& masks = typed.mesher.scene.mask_path;
    if (!masks.empty()) {  // jobs may run elsewhere
      masks = fs::absolute(masks).string();
    }
    JobInputs& inputs = plan_.inputs;
    inputs.AddOptions(&AddPlannerOptions, typed);
    for (const char* name : {"workspace_path", "output_path", "fused_path",
                             "sparse_path", "max_memory_gb", "num_threads"}) {
      inputs.options.erase(name);
    }
    inputs.options["num_tiles"] = std::to_string(num_tiles_);
    plan_.sparse_path = SparsePath();
    inputs.AddFiles(Files());
    if (!masks.empty()) {
      inputs.options["masks"] = HashOfMasks(masks);
    }
    plan_.workspace_path = fs::absolute(options_.mesher.workspace_path);
    plan_.Identify();
  }

  fs::path SparsePath() const {
    const MesherOptions& mesher = options_.mesher;
    return fs::absolute(FindSparseFolder(
        mesher.workspace.sparse_path.empty()
            ? FindDenseFolder(mesher.InputPath(), mesher.workspace)
            : mesher.workspace.sparse_path));
  }

  // All that the plan is made of, except the masks.
  std::vector<fs::path> Files() const {
    const std::string& region = options_.mesher.scene.region.text;
    std::vector<fs::path> files = {files_.path, files_.visibility_path};
    for (const auto& entry : fs::directory_iterator(plan_.sparse_path)) {
      files.push_back(entry.path());
    }
    if (fs::exists(region)) {
      files.emplace_back(region);
    }
    return files;
  }

  // One of all masks: the jobs that mesh a tile do not read them, and do not
  // check each.
  static std::string HashOfMasks(const fs::path& masks) {
    JobInputs inputs;
    std::vector<fs::path> files;
    std::error_code ignored;  // reported when the masks are read
    for (const auto& file : fs::recursive_directory_iterator(masks, ignored)) {
      files.push_back(file.path());
    }
    inputs.AddFiles(files);
    return fmt::format("{:016x}", inputs.Hash(0));
  }

  // A plan that cannot be read is made again.
  bool IsThere() const {
    try {
      const Plan plan = ReadPlan(plan_.folder);
      const FilePlan files(plan);
      return plan.identity == plan_.identity;
    } catch (const FileError&) {
      return false;
    }
  }

  void CalibrateHalfPixel() {
    if (options_.mesher.half_pixel == HalfPixelCorrection::kOff) {
      return;
    }
    Report(progress_, "Correcting the half pixel", 0);
    HalfPixelReport half_pixel;
    if (options_.mesher.half_pixel == HalfPixelCorrection::kAuto) {
      const PointCloud dense =
          num_points_ <= kMaxPlannedPoints ? sample_.cloud : ReadDenseSample();
      half_pixel.slope = RegressHalfPixel(
          dense,
          HalfPixelOffsets(dense, sample_.views, sample_.depth_map_scales),
          sample_.sparse_points);
      half_pixel.scale = CalibratedScale(half_pixel.slope);
    }
    report_->half_pixel = half_pixel;
  }

  // All points of some of many parts of space: as dense as the cloud.
  PointCloud ReadDenseSample() {
    constexpr size_t kPartPoints = 4096;
    const size_t num_parts =
        std::min(num_points_ / kPartPoints, sample_.cloud.size() / 16);
    const SplitTree parts = SplitSample(num_parts);
    const size_t stride =
        (num_points_ + kMaxPlannedPoints - 1) / kMaxPlannedPoints;
    PointCloud dense;
    ForEachPiece([&](const PointCloud& piece) {
      for (size_t point = 0; point < piece.size(); ++point) {
        if (parts.PartOf(piece.positions[point]) % stride == 0) {
          dense.positions.push_back(piece.positions[point]);
          dense.views.AddRow(piece.views[point]);
        }
      }
    });
    return dense;
  }

  void ReadMasks() {
    const std::string& path = options_.mesher.scene.mask_path;
    if (!path.empty()) {
      read_mask_ =
          KeepMasks(MaskReader(path, sample_.views, decoder_), sample_.views,
                    static_cast<size_t>(kMaskShare * 1e9 *
                                        std::min(options_.max_memory_gb, 1e6)));
    }
  }

  // Leaves what masks and the region do.
  void CropSample() {
    if (read_mask_) {
      const MaskReport of_sample =
          MaskCloud(read_mask_, sample_.views, &sample_.cloud);
      report_->masks = MaskReport{of_sample.num_masks};
    }
    if (plan_.region) {
      WeightedCloud weighted{std::move(sample_.cloud), {}, 0};
      weighted.weights.resize(weighted.cloud.size());
      CropCloud(*plan_.region, sample_.views, &weighted);
      sample_.cloud = std::move(weighted.cloud);
    }
    if (num_tiles_ * kMinTileSample > sample_.cloud.size()) {
      ThrowTooFew();
    }
  }

  [[noreturn]] void ThrowTooFew() const {
    throw FileError(files_.path,
                    fmt::format("too few points for {} tiles: take fewer, "
                                "or a larger region",
                                num_tiles_));
  }

  // By points and rays, which take about as long.
  SplitTree SplitSample(size_t num_parts) const {
    constexpr float kRay = 0.5f;  // of what a point takes
    std::vector<float> weights;
    for (size_t i = 0; i < sample_.cloud.size(); ++i) {
      weights.push_back(
          1 + kRay * static_cast<float>(sample_.cloud.views[i].size()));
    }
    return {sample_.cloud.positions, weights, num_parts};
  }

  // The points that can be meshed, some at a time.
  template <typename Visit>
  void ForEachPiece(const Visit& visit) {
    size_t num_done = 0;
    StreamCloud(
        files_.path, files_.visibility_path, kPiecePoints,
        [&](CloudPiece piece) {
          num_done += piece.cloud.positions.size();
          FilterReport ignored;
          visit(FilterCloud(std::move(piece.cloud), std::move(piece.visibility),
                            sample_.views.size(), &ignored));
          Report(
              progress_, "Sharing out the points",
              static_cast<double>(num_done) / static_cast<double>(num_points_));
        });
  }

  void ShareOut(TilePoints* points) {
    ForEachPiece([&](PointCloud piece) {
      Correct(&piece);
      for (size_t point = 0; point < piece.size(); ++point) {
        if (const auto tile = points->Add(piece, point)) {
          ++plan_.tiles[*tile].num_points;
        }
      }
    });
    points->CollectEnds();
  }

  // Puts the half pixel right.
  void Correct(PointCloud* piece) const {
    if (!report_->half_pixel) {
      return;
    }
    const std::vector<Eigen::Vector3f> offsets =
        HalfPixelOffsets(*piece, sample_.views, sample_.depth_map_scales);
    for (size_t point = 0; point < piece->size(); ++point) {
      piece->positions[point] +=
          static_cast<float>(report_->half_pixel->scale) * offsets[point];
    }
  }

  // Some tiles at a time, as many as there are threads and memory for. What
  // comes out is the same as one after the other.
  void ThinTiles(TilePoints* points) {
    const ManifoldMeshingOptions& meshing = options_.mesher.meshing;
    PlanBlocks blocks;
    std::vector<EdgeSample> edges;
    const size_t group = NumTilesAtOnce();
    for (size_t begin = 0; begin < num_tiles_; begin += group) {
      Report(progress_, "Thinning the tiles",
             static_cast<double>(begin) / static_cast<double>(num_tiles_));
      std::vector<WeightedCloud> clouds;
      for (size_t tile = begin; tile < std::min(begin + group, num_tiles_);
           ++tile) {
        clouds.push_back(points->Take(tile));
        if (clouds.back().num_points == 0) {
          ThrowTooFew();
        }
      }
      std::vector<TileVertices> thinned(clouds.size());
      std::vector<size_t> num_weaker(clouds.size(), 0);
      tbb::parallel_for(size_t{0}, clouds.size(), [&](size_t i) {
        if (meshing.drop_weaker_layers) {
          num_weaker[i] = DropWeakerLayers(sample_.views, &clouds[i]);
        }
        thinned[i] =
            ThinTile(std::move(clouds[i]), sample_.views, meshing.thinning);
        clouds[i] = {};
      });
      for (size_t i = 0; i < thinned.size(); ++i) {
        report_->num_weaker_points += num_weaker[i];
        Write(begin + i, thinned[i], &blocks);
        edges.push_back(std::move(thinned[i].edges));
        thinned[i] = {};
      }
    }
    colmap_ext::Write(BlocksFile(plan_), blocks);
    plan_.distance_sigma =
        options_.distance_sigma > 0
            ? options_.distance_sigma
            : meshing.distance_sigma_factor * MergedPercentile(edges);
    if (!(plan_.distance_sigma > 0)) {
      throw FileError(files_.path,
                      "the points of no tile span a volume: take a larger "
                      "region, or mask less");
    }
  }

  size_t NumTilesAtOnce() const {
    size_t most = 1;
    for (const PlannedTile& tile : plan_.tiles) {
      most = std::max<size_t>(most, tile.num_points);
    }
    const double memory_gb = kThinningGb * static_cast<double>(most);
    const auto at_once = static_cast<size_t>(
        std::clamp(options_.max_memory_gb / memory_gb, 1.0, 1e6));
    return std::min(
        at_once, static_cast<size_t>(tbb::this_task_arena::max_concurrency()));
  }

  void Write(size_t tile, const TileVertices& vertices, PlanBlocks* blocks) {
    colmap_ext::Write(VerticesFile(plan_, tile), vertices);
    AddTile(vertices.positions, vertices.observations, blocks);
    PlannedTile& planned = plan_.tiles[tile];
    planned.num_vertices = vertices.positions.size();
    planned.num_rays = vertices.observations.values.size();
    planned.memory_gb = TileMemoryGb(planned.num_vertices);
    planned.core_seconds = TileSeconds(planned.num_vertices);
  }

  // Points of the sample that a tile has to have.
  static constexpr size_t kMinTileSample = 16;

  const PlannerOptions& options_;
  const PictureDecoder& decoder_;
  const Progress& progress_;
  PlanReport* report_;
  const FusedFiles files_;
  const size_t num_points_;
  size_t num_tiles_ = 1;
  Workspace sample_;
  ReadGrayImage read_mask_;  // or nothing
  Plan plan_;
};

}  // namespace

Plan MakePlan(const PlannerOptions& options, const PictureDecoder& decoder,
              const Progress& progress, PlanReport* report) {
  std::error_code error;
  const bool is_new = fs::create_directories(options.output_path, error);
  if (error) {
    throw FileError(options.output_path, "cannot be made: " + error.message());
  }
  const FolderLock lock(options.output_path);
  report->is_locked = lock.IsLocked();
  try {
    return Planner(options, decoder, progress, report).Run();
  } catch (...) {
    if (is_new) {  // leaves no folder behind that has nothing but the lock
      fs::remove(fs::path(options.output_path) / "plan.lock", error);
      fs::remove(options.output_path, error);
    }
    throw;
  }
}

}  // namespace colmap_ext
