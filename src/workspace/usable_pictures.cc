#include "workspace/usable_pictures.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include "base/rows.h"
#include "formats/errors.h"

namespace colmap_ext {
namespace {

constexpr size_t kMaxNames = 10;  // in a message

size_t CountErrors(const std::vector<std::string>& errors) {
  return errors.size() -
         static_cast<size_t>(std::count(errors.begin(), errors.end(), ""));
}

}  // namespace

void FindUnreadable(const std::function<void(size_t view)>& read,
                    std::vector<std::string>* errors) {
  tbb::parallel_for(size_t{0}, errors->size(), [&](size_t i) {
    if (!(*errors)[i].empty()) {
      return;
    }
    try {
      read(i);
    } catch (const std::runtime_error&) {  // the caller lists the pictures
      (*errors)[i] = "can not be read";
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
                    "images can not be used, " + DescribeErrors(views, errors) +
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
        const auto end = std::remove_if(row.begin(), row.end(), is_unusable);
        return static_cast<size_t>(end - row.begin());
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
      throw FileError(path, "can not be read any more");
    }
    return *std::move(image);
  };
}

}  // namespace colmap_ext
