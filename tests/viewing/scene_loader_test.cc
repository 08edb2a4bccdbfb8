#include "colmap_ext/viewing/scene_loader.h"

#include <atomic>
#include <chrono>
#include <future>
#include <new>
#include <optional>
#include <thread>
#include <utility>

#include <gtest/gtest.h>

#include "base/mix_bits.h"
#include "tests/texts.h"

namespace colmap_ext::scene_loader_test {

constexpr int kWidth = 64;  // px
constexpr int kHeight = 48;

// A square of four facets that three cameras see, whose images are noise. The
// first image that is read is there when Open() is called.
struct SceneLoaderTest : testing::Test {
  SceneLoaderTest() {
    auto mesh = std::make_shared<ShownMesh>();
    mesh->mesh = {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 0}},
                  {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
    for (int vertex = 0; vertex < 5; ++vertex) {
      mesh->views.AddRow(std::vector<uint32_t>{0, 1, 2});
    }
    mesh_ = mesh;
    for (int i = 0; i < 3; ++i) {
      views_.push_back(LookAtView({0.3 * i, 0, 3 + 0.1 * i}, {0, 0, 0},
                                  {0, 1, 0}, kWidth, kHeight, 60));
      views_.back().name = std::to_string(i);
    }
    inbox_.Put("scene", [this](ShownScene* scene) {
      scene->meshes = {mesh_};
      scene->views = views_;
    });
    loader_.emplace(ViewerPaths{"folder", {}}, Decoder(), &inbox_);
    session_.emplace(&inbox_, loader_->Host(), DrawSettings());
    session_->Update(now_);
  }
  ~SceneLoaderTest() override { Open(); }

  void Open() {
    if (!std::exchange(is_open_, true)) {
      gate_.set_value();
    }
  }

  PictureDecoder Decoder() {
    return {[this](const std::filesystem::path& /*path*/) {
              Wait();
              return ColorImage{1, 1, {{1, 2, 3}}};
            },
            [this](const std::filesystem::path& path) {
              Wait();
              return ImageOf(path.filename().string());
            }};
  }

  static GrayImage ImageOf(const std::string& name) {
    GrayImage image{kWidth, kHeight, {}};
    for (uint64_t i = 0; i < kWidth * kHeight; ++i) {
      image.pixels.push_back(
          static_cast<uint8_t>(MixBits(i * 3 + std::stoul(name)) >> 56));
    }
    return image;
  }

  void Wait() {
    const int read = num_read_++;
    opened_.wait();
    if (read < num_failing_) {
      throw std::bad_alloc();
    }
  }

  // Updates the session until the condition holds. \return whether it does
  template <typename Condition>
  bool Until(Condition condition) {
    for (int i = 0; i < 10'000 && !condition(); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      session_->Update(now_ += 1);
    }
    return condition();
  }

  // Thumbnails are read when all else is done.
  bool IsAllDone() const { return session_->Scene().thumbnails.size() == 3; }

  SceneInbox inbox_;
  std::shared_ptr<const ShownMesh> mesh_;
  std::vector<View> views_;
  std::promise<void> gate_;
  std::shared_future<void> opened_ = gate_.get_future().share();
  bool is_open_ = false;
  int num_failing_ = 0;  // of the images that are read, the first ones
  std::atomic<int> num_read_ = 0;
  std::optional<SceneLoader> loader_;
  std::optional<ViewerSession> session_;
  double now_ = 0;
};

// The others' pictures never stand beside its figures.
TEST_F(SceneLoaderTest, OfQuickPicksTheLastIsShown) {
  session_->Pick(0);
  ASSERT_TRUE(Until([&] { return num_read_ > 0; }));
  session_->Pick(1);
  session_->Pick(2);
  Open();
  loader_->Host().load_thumbnails(views_);
  const auto [first, second] = *session_->GetPicked()->pair;
  const FacetMatch expected =
      MatchFacet(mesh_->mesh, 2, views_[first], ImageOf(views_[first].name),
                 views_[second], ImageOf(views_[second].name));
  ASSERT_TRUE(Until([&] {
    if (session_->PickedMatch() != nullptr) {
      EXPECT_EQ(session_->PickedMatch()->first.pixels, expected.first.pixels);
      EXPECT_EQ(session_->PickedMatch()->warped.pixels, expected.warped.pixels);
    }
    return IsAllDone();
  }));
  EXPECT_NE(session_->PickedMatch(), nullptr);
}

TEST_F(SceneLoaderTest, TheImageOfTheLastCameraIsThere) {
  session_->Press(kKeyRight);
  session_->Press('G');
  ASSERT_TRUE(Until([&] { return num_read_ > 0; }));
  session_->Press(kKeyRight);
  session_->Press(kKeyRight);
  Open();
  loader_->Host().load_thumbnails(views_);
  ASSERT_TRUE(Until([&] { return IsAllDone(); }));
  ASSERT_TRUE(session_->Settings().image);
  EXPECT_TRUE(session_->Scene().images.contains(*session_->Settings().image));
}

// The program does not end, and says each thing once.
TEST_F(SceneLoaderTest, WhatGoesWrongIsANote) {
  num_failing_ = 5;
  Open();
  loader_->Host().load_image(0, views_[0]);
  loader_->Host().load_thumbnails(views_);
  loader_->Host().match_facet(mesh_, 0, views_[0], views_[1]);
  loader_->Host().load_thumbnails(views_);
  ASSERT_TRUE(Until([&] { return IsAllDone(); }));
  ASSERT_EQ(session_->Scene().notes.size(), 1);
  EXPECT_TRUE(Has(session_->Scene().notes[0], "out of memory"));
}

}  // namespace colmap_ext::scene_loader_test
