#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "viewer/shown_scene.h"

namespace colmap_ext {

// Where other threads leave what the viewer is to show next. Safe from several
// threads.
class SceneInbox {
 public:
  using Edit = std::function<void(ShownScene* scene)>;

  // Leaves a change of the scene. It takes the place of an earlier one of the
  // same key that has not been taken yet, so that nothing piles up.
  void Put(const std::string& key, Edit edit) {
    const std::lock_guard lock(mutex_);
    edits_[key] = std::move(edit);
  }

  // Makes the changes, by the order of their keys.
  // \return whether there were any.
  bool Take(ShownScene* scene) {
    std::map<std::string, Edit> edits;
    {
      const std::lock_guard lock(mutex_);
      edits.swap(edits_);
    }
    for (const auto& [key, edit] : edits) {
      edit(scene);
    }
    return !edits.empty();
  }

 private:
  std::mutex mutex_;
  std::map<std::string, Edit> edits_;
};

}  // namespace colmap_ext
