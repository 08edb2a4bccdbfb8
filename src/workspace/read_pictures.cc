#include "workspace/read_pictures.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "base/lru_cache.h"
#include "formats/errors.h"
#include "formats/read_arrays.h"
#include "workspace/workspace.h"

namespace colmap_ext {
namespace {

namespace fs = std::filesystem;

GrayImage ReadMask(const fs::path& path, const View& view,
                   const PictureDecoder& decoder) {
  std::optional<GrayImage> mask = decoder.read_gray(path);
  if (!mask) {
    throw FileError(path, "the mask cannot be read");
  }
  if (mask->width != view.width || mask->height != view.height) {
    throw FileError(
        path, fmt::format("the mask has {} x {} pixels, its image {} x {}; "
                          "undistort masks as their images are",
                          mask->width, mask->height, view.width, view.height));
  }
  for (uint8_t& pixel : mask->pixels) {
    pixel = pixel == 0 ? 0 : 255;
  }
  return *std::move(mask);
}

bool IsMasked(const GrayImage& mask, const View& view,
              const Eigen::Vector3f& point) {
  const std::optional<Eigen::Vector2d> pixel =
      PixelInImage(view, point.cast<double>());
  return pixel &&
         mask.Row(static_cast<int>(pixel->y()))[static_cast<int>(pixel->x())] ==
             0;
}

// A place in the values of the cloud's views, and its point.
struct PointPlace {
  uint64_t place;
  uint32_t point;
};

// [views]
Rows<PointPlace> ObservationsByView(const PointCloud& cloud, size_t num_views) {
  return GroupInRows<PointPlace>(num_views, [&cloud](const auto& add) {
    for (uint32_t point = 0; point < cloud.size(); ++point) {
      for (uint64_t place = cloud.views.offsets[point];
           place < cloud.views.offsets[point + 1]; ++place) {
        add(cloud.views.values[place], {place, point});
      }
    }
  });
}

// Drops the observations that are marked, and then points without any.
void DropMasked(const std::vector<uint8_t>& is_masked, MaskReport* report,
                PointCloud* cloud) {
  const std::vector<uint64_t> offsets = cloud->views.offsets;
  EditPoints(
      [&](size_t point, std::span<uint32_t> row) -> std::optional<size_t> {
        size_t size = 0;
        for (size_t k = 0; k < row.size(); ++k) {
          if (is_masked[offsets[point] + k] == 0) {
            row[size++] = row[k];
          }
        }
        report->num_masked_observations += row.size() - size;
        report->num_masked_points += size == 0;
        return size > 0 ? std::optional(size) : std::nullopt;
      },
      cloud);
}

constexpr size_t kMaxNames = 10;  // in a message

size_t CountErrors(const std::vector<std::string>& errors) {
  return errors.size() - static_cast<size_t>(std::ranges::count(errors, ""));
}

}  // namespace

fs::path FindMask(const fs::path& folder, const std::string& image_name) {
  const fs::path appended = folder / (image_name + ".png");
  if (fs::exists(appended)) {
    return appended;
  }
  const fs::path same = folder / image_name;
  return same.extension() == ".png" && fs::exists(same) ? same : fs::path();
}

ReadGrayImage MaskReader(const fs::path& folder, const std::vector<View>& views,
                         const PictureDecoder& decoder) {
  if (!fs::is_directory(folder)) {
    throw FileError(folder, "no such folder of masks");
  }
  if (std::ranges::all_of(views, [&](const View& view) {
        return FindMask(folder, view.name).empty();
      })) {
    throw FileError(folder,
                    fmt::format("it has no mask of any image, such as "
                                "{}.png",
                                views.empty() ? "image.jpg" : views[0].name));
  }
  return [folder, views, decoder](size_t view) {
    const fs::path path = FindMask(folder, views[view].name);
    return path.empty() ? GrayImage() : ReadMask(path, views[view], decoder);
  };
}

std::function<DepthMap(size_t view)> DepthMapReader(
    const fs::path& folder, const std::vector<View>& views) {
  if (std::ranges::all_of(views, [&](const View& view) {
        return FindDepthMap(folder, view.name).empty();
      })) {
    throw FileError(folder, "it has no depth map of any image, such as " +
                                views[0].name + ".geometric.bin");
  }
  return [folder, &views](size_t view) {
    const fs::path path = FindDepthMap(folder, views[view].name);
    return path.empty() ? DepthMap() : ReadDepthMap(path);
  };
}

ReadGrayImage KeepMasks(const ReadGrayImage& read_mask,
                        const std::vector<View>& views, size_t max_memory) {
  struct Bits {
    int width;
    int height;
    std::vector<bool> pixels;  // of GrayImage; true: 255
  };
  const auto kept = std::make_shared<LruCache<const Bits>>(max_memory);
  return [read_mask, views, kept](size_t view) {
    const size_t num_pixels =
        static_cast<size_t>(views[view].width) * views[view].height;
    const auto bits = kept->Get(view, num_pixels / 8, [&] {
      const GrayImage mask = read_mask(view);
      return std::make_shared<const Bits>(
          Bits{mask.width, mask.height,
               std::vector<bool>(mask.pixels.begin(), mask.pixels.end())});
    });
    GrayImage mask{bits->width, bits->height, {}};
    mask.pixels.reserve(bits->pixels.size());
    for (const bool is_kept : bits->pixels) {
      mask.pixels.push_back(is_kept ? 255 : 0);
    }
    return mask;
  };
}

MaskReport MaskCloud(const ReadGrayImage& read_mask,
                     const std::vector<View>& views, PointCloud* cloud) {
  const Rows<PointPlace> by_view = ObservationsByView(*cloud, views.size());
  std::vector<uint8_t> is_masked(cloud->views.values.size(), 0);
  std::atomic<size_t> num_masks = 0;
  tbb::parallel_for(size_t{0}, views.size(), [&](size_t view) {
    const GrayImage mask =
        by_view[view].empty() ? GrayImage() : read_mask(view);
    if (mask.pixels.empty()) {
      return;
    }
    ++num_masks;
    for (const auto& [place, point] : by_view[view]) {
      is_masked[place] = IsMasked(mask, views[view], cloud->positions[point]);
    }
  });
  MaskReport report;
  report.num_masks = num_masks;
  DropMasked(is_masked, &report, cloud);
  return report;
}

void FindUnreadable(const std::function<void(size_t view)>& read,
                    std::vector<std::string>* errors) {
  tbb::parallel_for(size_t{0}, errors->size(), [&](size_t i) {
    if (!(*errors)[i].empty()) {
      return;
    }
    try {
      read(i);
    } catch (const std::runtime_error&) {  // the caller lists the pictures
      (*errors)[i] = "cannot be read";
    }
  });
}

std::string DescribeErrors(const std::vector<View>& views,
                           const std::vector<std::string>& errors) {
  std::string text = fmt::format("{} of {}", CountErrors(errors), views.size());
  size_t num_listed = 0;
  for (size_t i = 0; i < views.size(); ++i) {
    if (errors[i].empty()) {
      continue;
    }
    if (num_listed == kMaxNames) {
      return text + "; ...";
    }
    text += (num_listed++ == 0 ? ": " : "; ") + views[i].name + " " + errors[i];
  }
  return text;
}

void ExpectPictures(const std::filesystem::path& images_path,
                    const std::vector<View>& views,
                    const std::vector<std::string>& errors) {
  if (CountErrors(errors) > 0) {
    throw FileError(images_path,
                    "images cannot be used, " + DescribeErrors(views, errors) +
                        "; run `colmap image_undistorter` again",
                    Alternative::kLeavePicturesOut);
  }
}

void RemoveUnusable(const std::filesystem::path& images_path,
                    const std::vector<std::string>& errors,
                    PointCloud* points) {
  if (errors.size() - CountErrors(errors) < 2) {
    throw FileError(images_path, "fewer than two images can be used");
  }
  const auto is_unusable = [&errors](uint32_t view) {
    return !errors[view].empty();
  };
  EditRows(
      [&](size_t, std::span<uint32_t> row) {
        return static_cast<size_t>(
            std::remove_if(row.begin(), row.end(), is_unusable) - row.begin());
      },
      &points->views);
}

ReadGrayImage PictureReader(const std::filesystem::path& images_path,
                            const std::vector<View>& views,
                            const PictureDecoder& decoder) {
  return [images_path, views, read = decoder.read_gray](size_t view) {
    const std::filesystem::path path = images_path / views[view].name;
    std::optional<GrayImage> image = read(path);
    if (!image) {
      throw FileError(path, "cannot be read any more");
    }
    return *std::move(image);
  };
}

}  // namespace colmap_ext
