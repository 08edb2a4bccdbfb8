#include "workspace/workspace.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "base/indices.h"
#include "formats/picture_files.h"
#include "formats/read_arrays.h"
#include "workspace/workspace_paths.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

View MakeView(const SparseImage& image, const SparseCamera& camera) {
  View view;
  view.name = image.name;
  view.width = static_cast<int>(camera.width);
  view.height = static_cast<int>(camera.height);
  view.fx = camera.fx;
  view.fy = camera.fy;
  view.cx = camera.cx;
  view.cy = camera.cy;
  view.cam_from_world_rotation =
      image.cam_from_world_rotation.toRotationMatrix();
  view.cam_from_world_translation = image.cam_from_world_translation;
  return view;
}

bool HasAspectOf(const View& view, const PictureSize& size) {
  const double scale_x = 1.0 * size.width / view.width;
  const double scale_y = 1.0 * size.height / view.height;
  return std::abs(view.height * scale_x - size.height) <= 1 ||
         std::abs(view.width * scale_y - size.width) <= 1;
}

// From the header of a PNG or JPEG file, else by decoding the whole picture.
std::optional<PictureSize> FindPictureSize(const fs::path& path,
                                           const PictureDecoder& decoder) {
  std::optional<PictureSize> size = ReadPictureSize(path);
  if (!size) {
    if (const std::optional<ColorImage> image = decoder.read_color(path)) {
      size = PictureSize{image->width, image->height};
    }
  }
  if (size && (size->width <= 0 || size->height <= 0)) {
    size.reset();
  }
  return size;
}

// Scales the view to its picture.
// \return what is wrong with the picture
std::string FitToPicture(const fs::path& path, const ViewRules& rules,
                         const PictureDecoder& decoder, View* view,
                         Views* result) {
  const std::optional<PictureSize> size = FindPictureSize(path, decoder);
  if (!size) {
    ++result->num_missing_images;
    return fs::exists(path) ? "cannot be read" : "no such file";
  }
  if (size->width == view->width && size->height == view->height) {
    return "";
  }
  if (!HasAspectOf(*view, *size)) {
    const std::string error =
        fmt::format("is {} x {} pixels, but its camera is {} x {}", size->width,
                    size->height, view->width, view->height);
    if (!rules.allow_other_sizes) {
      throw FileError(path, error +
                                ", which is not the same picture scaled; run "
                                "`colmap image_undistorter` again");
    }
    return error;
  }
  *view = ResizeView(*view, size->width, size->height);
  ++result->num_rescaled_images;
  return "";
}

double ReadDepthMapScale(const fs::path& dense_path, const View& view) {
  const fs::path path =
      FindDepthMap(dense_path / "stereo" / "depth_maps", view.name);
  if (path.empty()) {
    return 1;
  }
  ByteReader reader(path);
  return 1.0 * ReadDepthMapHeader(&reader).width / view.width;
}

// More than this share of the points with image indices out of range, and the
// .vis belongs to another model.
constexpr double kMaxOutOfRange = 0.01;

template <typename T>
void Reorder(const std::vector<size_t>& order, std::vector<T>* values) {
  std::vector<T> reordered;
  for (const size_t index : order) {
    reordered.push_back((*values)[index]);
  }
  *values = std::move(reordered);
}

// How many points list an image index that is not below num_images.
size_t CountOutOfRange(const Visibility& visibility, size_t num_images) {
  size_t count = 0;
  for (size_t i = 0; i < visibility.size(); ++i) {
    count += std::ranges::any_of(visibility[i], [num_images](uint32_t index) {
      return index >= num_images;
    });
  }
  return count;
}

void ExpectIndicesInRange(const Visibility& visibility, size_t num_images,
                          const fs::path& path) {
  const size_t num_out_of_range = CountOutOfRange(visibility, num_images);
  const size_t num_points = visibility.size();
  if (num_out_of_range > kMaxOutOfRange * num_points) {
    throw FileError(
        path,
        fmt::format("{} of {} points list images beyond the {} of sparse/, "
                    "so that it belongs to another model; run `colmap "
                    "stereo_fusion` again",
                    num_out_of_range, num_points, num_images));
  }
}

void ExpectFinitePoints(const std::vector<Eigen::Vector3f>& points,
                        const fs::path& path) {
  if (std::ranges::none_of(points, IsMeasurable)) {
    throw FileError(
        path, fmt::format("none of its {} points is finite", points.size()));
  }
}

void AppendPoint(const CloudPiece& from, size_t point, SeenCloud* to) {
  to->cloud.positions.push_back(from.cloud.positions[point]);
  AppendIfAny(from.cloud.normals, point, &to->cloud.normals);
  AppendIfAny(from.cloud.colors, point, &to->cloud.colors);
  to->visibility.AddRow(from.visibility[point]);
}

void SampleFusedCloud(const FusedFiles& files, size_t max_points,
                      SeenCloud* seen) {
  constexpr size_t kPiecePoints = 1 << 18;
  const size_t num_points = CountPlyVertices(files.path);
  const size_t stride =
      std::max<size_t>(1, (num_points + max_points - 1) / max_points);
  size_t first = 0;  // of the piece
  StreamCloud(files.path, files.visibility_path, kPiecePoints,
              [&](const CloudPiece& piece) {
                const size_t size = piece.cloud.positions.size();
                for (size_t i = 0; i < size; ++i) {
                  if ((first + i) % stride == 0) {
                    AppendPoint(piece, i, seen);
                  }
                }
                first += size;
              });
}

SeenCloud ReadFusedCloud(const FusedFiles& files, size_t max_points) {
  SeenCloud seen{{}, files};
  if (max_points < SIZE_MAX) {
    SampleFusedCloud(files, max_points, &seen);
  } else {
    seen.cloud = ReadPlyCloud(files.path);
    seen.visibility =
        ReadVisibility(files.visibility_path, seen.cloud.positions.size());
  }
  if (seen.visibility.values.empty()) {
    throw FileError(seen.path, "no points that any image sees");
  }
  return seen;
}

// \pre the workspace's views are in the order of the model's images.
void OrderImages(const SparseModel& model, const WorkspaceOptions& options,
                 const PictureDecoder& decoder, SeenCloud seen,
                 Workspace* workspace) {
  const fs::path images_path = workspace->report.path / "images";
  ExpectFinitePoints(seen.cloud.positions, seen.path);
  ExpectIndicesInRange(seen.visibility, model.images.size(),
                       seen.visibility_path);
  workspace->report.order =
      FindImageOrder({seen.cloud, seen.visibility, model, workspace->views,
                      images_path, decoder, seen.visibility_path},
                     options.image_order);
  workspace->report.is_order_verified = true;
  const std::vector<size_t>& order = workspace->report.order.order.images;
  Reorder(order, &workspace->views);
  Reorder(order, &workspace->camera_scales);
  Reorder(order, &workspace->depth_map_scales);
  Reorder(order, &workspace->picture_errors);
  workspace->cloud =
      FilterCloud(std::move(seen.cloud), std::move(seen.visibility),
                  order.size(), &workspace->report.points);
}

void MakeSparseCloud(const SparseModel& model, Workspace* workspace) {
  if (!model.point_positions.empty()) {
    ExpectFinitePoints(model.point_positions, workspace->report.sparse_path);
  }
  const std::map<uint32_t, size_t> index_of_id = ImageIndices(model);
  Visibility visibility;
  visibility.offsets = model.track_image_ids.offsets;
  for (const uint32_t image_id : model.track_image_ids.values) {
    const auto it = index_of_id.find(image_id);
    visibility.values.push_back(it != index_of_id.end()
                                    ? static_cast<uint32_t>(it->second)
                                    : std::numeric_limits<uint32_t>::max());
  }
  workspace->cloud = FilterCloud(
      {model.point_positions, {}, model.point_colors}, std::move(visibility),
      model.images.size(), &workspace->report.points);
}

// \param read_cloud  empty for the sparse points.
Workspace Assemble(const fs::path& folder, const WorkspaceOptions& options,
                   const PictureDecoder& decoder,
                   const std::function<SeenCloud()>& read_cloud) {
  const bool is_dense = read_cloud != nullptr;
  Workspace workspace;
  WorkspaceReport& report = workspace.report;
  report.path = folder;
  report.sparse_path = FindSparseFolder(
      options.sparse_path.empty() ? report.path : options.sparse_path);
  const SparseModel model = ReadSparseModel(report.sparse_path);
  if (model.images.empty()) {
    throw FileError(report.sparse_path, "the model has no images");
  }
  static_cast<Views&>(workspace) = ReadViews(
      report.path, model, {!is_dense, options.allow_other_sizes}, decoder);
  report.num_missing_images = workspace.num_missing_images;
  report.num_rescaled_images = workspace.num_rescaled_images;
  report.num_sparse_points = model.point_positions.size();
  if (is_dense) {
    OrderImages(model, options, decoder, read_cloud(), &workspace);
  } else {
    MakeSparseCloud(model, &workspace);
  }
  if (workspace.cloud.size() == 0) {
    throw FileError(report.path, "no points that can be meshed");
  }
  for (const Eigen::Vector3f& point : model.point_positions) {
    if (IsMeasurable(point)) {
      workspace.sparse_points.push_back(point);
    }
  }
  return workspace;
}

}  // namespace

Views ReadViews(const fs::path& dense_path, const SparseModel& model,
                const ViewRules& rules, const PictureDecoder& decoder) {
  Views result;
  for (const SparseImage& image : model.images) {
    const SparseCamera& camera = model.cameras.at(image.camera_id);
    if (!camera.is_pinhole && !rules.allow_distortion) {
      throw FileError(
          dense_path,
          fmt::format("camera {} is distorted ({}), which no dense workspace's "
                      "is; run `colmap image_undistorter` first",
                      image.camera_id, camera.model_name));
    }
    if (!camera.has_focal_length) {
      throw FileError(
          dense_path,
          fmt::format("camera {} is a panorama ({}), which cannot be meshed; "
                      "cut it into pinhole images first",
                      image.camera_id, camera.model_name));
    }
    View view = MakeView(image, camera);
    result.picture_errors.push_back(FitToPicture(
        dense_path / "images" / image.name, rules, decoder, &view, &result));
    result.camera_scales.push_back(1.0 * static_cast<double>(camera.width) /
                                   view.width);
    result.depth_map_scales.push_back(ReadDepthMapScale(dense_path, view));
    result.views.push_back(std::move(view));
  }
  return result;
}

PointCloud FilterCloud(PlyCloud cloud, Visibility visibility, size_t num_images,
                       FilterReport* report) {
  report->num_points = cloud.positions.size();
  report->num_out_of_range = CountOutOfRange(visibility, num_images);
  PointCloud filtered{std::move(cloud.positions), std::move(cloud.colors),
                      std::move(visibility)};
  tbb::parallel_for(size_t{0}, filtered.views.size(),
                    [&](size_t i) { std::ranges::sort(filtered.views[i]); });
  const auto edit = [&](size_t point,
                        std::span<uint32_t> row) -> std::optional<size_t> {
    const auto end = std::ranges::lower_bound(row, num_images);
    const auto unique_end = std::unique(row.begin(), end);
    report->num_with_repeats += unique_end != end;
    if (!IsMeasurable(filtered.positions[point])) {
      ++report->num_not_finite;
      return std::nullopt;
    }
    if (unique_end == row.begin()) {
      ++report->num_without_views;
      return std::nullopt;
    }
    return static_cast<size_t>(unique_end - row.begin());
  };
  EditPoints(edit, &filtered);
  return filtered;
}

fs::path FindDenseFolder(const fs::path& path,
                         const WorkspaceOptions& options) {
  return options.fused_path.empty() ? FindDenseFolder(path)
                                    : FindUndistortedFolder(path);
}

Workspace ReadWorkspace(const fs::path& path, const WorkspaceOptions& options,
                        const PictureDecoder& decoder) {
  if (options.input_type == InputType::kDense) {
    return Assemble(FindDenseFolder(path, options), options, decoder, [&] {
      return ReadFusedCloud(FindFusedFiles(path, options), options.max_points);
    });
  }
  return Assemble(path, options, decoder, nullptr);
}

FusedFiles FindFusedFiles(const fs::path& path,
                          const WorkspaceOptions& options) {
  const fs::path fused = options.fused_path.empty()
                             ? FindDenseFolder(path, options) / "fused.ply"
                             : options.fused_path;
  return {fused, fused.string() + ".vis"};
}

Workspace ReadMeshWorkspace(const fs::path& folder,
                            const WorkspaceOptions& options,
                            const PictureDecoder& decoder, SeenCloud vertices) {
  return Assemble(folder, options, decoder,
                  [&vertices] { return std::move(vertices); });
}

}  // namespace colmap_ext
