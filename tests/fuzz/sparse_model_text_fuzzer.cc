#include "tests/fuzz/fuzzed_sparse_model.h"
#include "tests/fuzz/small_sphere.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t num_bytes) {
  static const colmap_ext::SphereWorkspace sphere = colmap_ext::SmallSphere();
  static colmap_ext::FuzzedSparseModel model(
      ".txt", {sphere.CamerasText(), sphere.ImagesText(), sphere.Points3DText(),
               sphere.FramesText()});
  model.Fuzz(bytes, num_bytes);
  return 0;
}
