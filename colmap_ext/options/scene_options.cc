#include "colmap_ext/options/scene_options.h"

#include "formats/read_transform.h"

namespace colmap_ext {

void SceneOptions::Finish() {
  region.Finish();
  if (!transform_path.empty()) {
    transform = ReadTransform(transform_path);
  }
}

void AddSceneOptions(CommandOptions* manager, const std::string& what,
                     SceneOptions* scene) {
  manager->AddDefaultOption(
      "mask_path", &scene->mask_path,
      "Masks of the images, a folder of PNG files, image.jpg.png for "
      "image.jpg: pixels of 0 are left out");
  manager->AddDefaultOption(
      "transform_path", &scene->transform_path,
      "A transform of the mesh that is written, as model_aligner writes it; "
      "positions are double then");
  manager->AddDefaultOption(
      "region", &scene->region.text,
      what +
          ": a file (docs/scripts.md), two corners x0,y0,z0,x1,y1,z1 of a box, "
          "or auto: what most images look at, written to OUTPUT.region.txt");
}

}  // namespace colmap_ext
