#include "colmap_ext/viewing/scene_loader.h"

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/format.h>

#include "viewer/facet_match.h"

namespace colmap_ext {

void SceneLoader::LoadAll(const ViewerOptions& options) {
  for (const ShownMeshPaths& mesh : paths_.meshes) {
    worker_.Add([this, mesh] { LoadMesh(mesh); });
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

void SceneLoader::Note(const std::vector<std::string>& notes) {
  notes_.insert(notes_.end(), notes.begin(), notes.end());
  inbox_->Put("notes",
              [all = notes_](ShownScene* scene) { scene->notes = all; });
}

void SceneLoader::LoadMesh(const ShownMeshPaths& paths) {
  Say(fmt::format("reading {} ({} of {})", paths.mesh.filename().string(),
                  ++num_meshes_, paths_.meshes.size()));
  try {
    std::vector<std::string> notes;
    auto mesh = std::make_shared<const ShownMesh>(ReadShownMesh(paths, &notes));
    inbox_->Put(fmt::format("mesh {:06}", num_meshes_),
                [mesh](ShownScene* scene) { scene->meshes.push_back(mesh); });
    Note(notes);
  } catch (const std::exception& error) {
    Note({error.what()});
  }
}

void SceneLoader::LoadWorkspace(const ViewerOptions& options) {
  Say("reading the points and cameras");
  try {
    ViewerWorkspace workspace = ReadViewerWorkspace(options, paths_, decoder_);
    views_ = workspace.views;
    inbox_->Put("workspace",
                [views = views_, points = workspace.points](ShownScene* scene) {
                  scene->views = views;
                  scene->points = points;
                });
    Note(workspace.notes);
  } catch (const std::exception& error) {
    Note({error.what()});
  }
}

void SceneLoader::LoadImage(size_t view) {
  if (view >= views_.size()) {
    return;
  }
  auto image =
      ReadShownImage(paths_.folder, views_[view], kImageSize, decoder_);
  if (image == nullptr) {
    Note({(paths_.folder / "images" / views_[view].name).string() +
          ": can not be read"});
    return;
  }
  // One at a time: they are large.
  inbox_->Put("image", [view, image](ShownScene* scene) {
    scene->images.clear();
    scene->images[view] = image;
  });
}

void SceneLoader::LoadThumbnails() {
  if (std::exchange(are_thumbnails_loaded_, true)) {
    return;
  }
  for (size_t view = 0; view < views_.size(); ++view) {
    worker_.Add([this, view] {
      Say(fmt::format("reading images, {} of {}", view + 1, views_.size()));
      if (auto image = ReadShownImage(paths_.folder, views_[view],
                                      kThumbnailSize, decoder_)) {
        inbox_->Put(fmt::format("thumbnail {}", view),
                    [view, image](ShownScene* scene) {
                      scene->thumbnails[view] = image;
                    });
      }
    });
  }
  worker_.Add([this] { Say(""); });
}

void SceneLoader::Match(const ShownMesh& mesh, uint32_t facet, ViewPair pair) {
  FacetMatch match;
  const std::filesystem::path folder = paths_.folder / "images";
  const auto read = [&](uint32_t view) {
    return decoder_.read_gray(folder / views_[view].name);
  };
  if (std::max(pair.first, pair.second) < views_.size()) {
    const View& first = views_[pair.first];
    const View& second = views_[pair.second];
    const std::optional<GrayImage> first_image = read(pair.first);
    const std::optional<GrayImage> second_image = read(pair.second);
    const auto fits = [](const View& view,
                         const std::optional<GrayImage>& image) {
      return image && image->width == view.width &&
             image->height == view.height;
    };
    if (fits(first, first_image) && fits(second, second_image)) {
      match = MatchFacet(mesh.mesh, facet, first, *first_image, second,
                         *second_image);
    }
  }
  inbox_->Put("match",
              [result = std::make_shared<const FacetMatch>(std::move(match))](
                  ShownScene* scene) { scene->match = result; });
}

ViewerHost SceneLoader::Host(
    std::function<std::string(const ColorImage&)> save) {
  ViewerHost host;
  host.load_image = [this](size_t view) {
    worker_.AddFirst([this, view] { LoadImage(view); });
  };
  host.load_thumbnails = [this] { worker_.Add([this] { LoadThumbnails(); }); };
  host.match_facet = [this](std::shared_ptr<const ShownMesh> mesh,
                            uint32_t facet, ViewPair pair) {
    worker_.AddFirst([this, mesh = std::move(mesh), facet, pair] {
      try {
        Match(*mesh, facet, pair);
      } catch (const std::exception& error) {
        Note({error.what()});
      }
    });
  };
  host.save_picture = std::move(save);
  return host;
}

std::string SaveNumbered(const ColorImage& picture,
                         const std::function<void(const std::filesystem::path&,
                                                  const ColorImage&)>& write) {
  std::filesystem::path path;
  for (int i = 1; path.empty() || std::filesystem::exists(path); ++i) {
    path = fmt::format("mesh_viewer.{:03}.png", i);
  }
  try {
    write(path, picture);
    return "saved " + std::filesystem::absolute(path).string();
  } catch (const std::exception& error) {
    return error.what();
  }
}

}  // namespace colmap_ext
