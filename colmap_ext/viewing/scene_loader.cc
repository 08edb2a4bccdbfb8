#include "colmap_ext/viewing/scene_loader.h"

#include <algorithm>
#include <new>
#include <utility>

#include <fmt/format.h>

#include "formats/picture_files.h"

namespace colmap_ext {
namespace {

// \return the outcome, in one line.
std::string SaveNumbered(const ColorImage& picture) {
  std::filesystem::path path;
  for (int i = 1; path.empty() || std::filesystem::exists(path); ++i) {
    path = fmt::format("mesh_viewer.{:03}.png", i);
  }
  try {
    WritePng(path, picture);
    return "saved " + std::filesystem::absolute(path).string();
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace

void SceneLoader::LoadAll(const ViewerOptions& options) {
  for (const std::filesystem::path& mesh : paths_.meshes) {
    worker_.Add([this, mesh, options] { LoadMesh(mesh, options); });
    if (&mesh == &paths_.meshes.front() && !paths_.folder.empty()) {
      worker_.Add([this, options] { LoadWorkspace(options); });
    }
  }
  worker_.Add([this] { Say(""); });
}

void SceneLoader::Say(const std::string& status) {
  inbox_->Put("status",
              [status](ShownScene* scene) { scene->status = status; });
}

// Adds notes that are new.
void SceneLoader::Note(const std::vector<std::string>& notes) {
  for (const std::string& note : notes) {
    if (std::ranges::find(notes_, note) == notes_.end()) {
      notes_.push_back(note);
    }
  }
  inbox_->Put("notes",
              [all = notes_](ShownScene* scene) { scene->notes = all; });
}

void SceneLoader::NoteError(const std::exception& error) {
  const bool is_memory = dynamic_cast<const std::bad_alloc*>(&error) != nullptr;
  Note({is_memory ? "out of memory; look at fewer meshes at a time"
                  : error.what()});
}

void SceneLoader::LoadMesh(const std::filesystem::path& path,
                           const ViewerOptions& options) {
  Say(fmt::format("reading {} ({} of {})", path.filename().string(),
                  ++num_meshes_, paths_.meshes.size()));
  std::vector<std::string> notes;
  auto mesh =
      std::make_shared<const ShownMesh>(ReadShownMesh(path, options, &notes));
  inbox_->Put(fmt::format("mesh {:06}", num_meshes_),
              [mesh](ShownScene* scene) { scene->meshes.push_back(mesh); });
  Note(notes);
  constexpr size_t kMaxFacets =
      150'000;  // one frame in 0.1 s or so by llvmpipe
  if (mesh->mesh.facets.size() >= 2 * kMaxFacets) {
    auto coarse =
        std::make_shared<const ShownMesh>(CoarseMesh(*mesh, kMaxFacets));
    inbox_->Put(fmt::format("stand-in {:06}", num_meshes_),
                [mesh, coarse](ShownScene* scene) {
                  scene->stand_ins[mesh.get()] = coarse;
                });
  }
}

void SceneLoader::LoadWorkspace(const ViewerOptions& options) {
  Say("reading the points and cameras");
  const ShownScene read = ReadViewerWorkspace(options, paths_, decoder_);
  inbox_->Put("workspace",
              [views = read.views, points = read.points](ShownScene* scene) {
                scene->views = views;
                scene->points = points;
              });
  Note(read.notes);
}

void SceneLoader::LoadImage(size_t index, const View& view) {
  auto image = ReadShownImage(paths_.folder, view, kImageSize, decoder_);
  if (image == nullptr) {
    Note(
        {(paths_.folder / "images" / view.name).string() + ": cannot be read"});
    return;
  }
  // One at a time: they are large.
  inbox_->Put("image", [index, image](ShownScene* scene) {
    scene->images.clear();
    scene->images[index] = image;
  });
}

void SceneLoader::LoadThumbnails(const std::vector<View>& views) {
  for (size_t i = 0; i < views.size(); ++i) {
    worker_.Add([this, i, view = views[i], count = views.size()] {
      Say(fmt::format("reading images, {} of {}", i + 1, count));
      if (auto image =
              ReadShownImage(paths_.folder, view, kThumbnailSize, decoder_)) {
        inbox_->Put(
            fmt::format("thumbnail {}", i),
            [i, image](ShownScene* scene) { scene->thumbnails[i] = image; });
      }
    });
  }
  worker_.Add([this] { Say(""); });
}

void SceneLoader::Match(const std::shared_ptr<const ShownMesh>& mesh,
                        uint32_t facet, const View& first, const View& second) {
  const auto read = [&](const View& view) {
    std::optional<GrayImage> image =
        decoder_.read_gray(paths_.folder / "images" / view.name);
    const bool fits =
        image && image->width == view.width && image->height == view.height;
    return fits ? std::move(image) : std::nullopt;
  };
  const std::optional<GrayImage> first_image = read(first);
  const std::optional<GrayImage> second_image = read(second);
  FacetMatch match;
  if (first_image && second_image) {
    match = MatchFacet(mesh->mesh, facet, first, *first_image, second,
                       *second_image);
  }
  inbox_->Put("match", [mesh, facet,
                        result = std::make_shared<const FacetMatch>(
                            std::move(match))](ShownScene* scene) {
    scene->matches[{mesh, facet}] = result;
  });
}

ViewerHost SceneLoader::Host() {
  ViewerHost host;
  host.load_image = [this](size_t index, const View& view) {
    worker_.AddUrgent("image", [this, index, view] { LoadImage(index, view); });
  };
  host.load_thumbnails = [this](const std::vector<View>& views) {
    LoadThumbnails(views);
  };
  host.match_facet = [this](std::shared_ptr<const ShownMesh> mesh,
                            uint32_t facet, const View& first,
                            const View& second) {
    worker_.AddUrgent("match", [this, mesh = std::move(mesh), facet, first,
                                second] { Match(mesh, facet, first, second); });
  };
  host.save_picture = &SaveNumbered;
  return host;
}

}  // namespace colmap_ext
