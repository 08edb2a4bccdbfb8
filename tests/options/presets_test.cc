#include <gtest/gtest.h>

#include "colmap_ext/options/meshing_options.h"
#include "colmap_ext/options/parse_options.h"
#include "colmap_ext/options/refinement_options.h"

namespace colmap_ext::presets_test {

// The options of a command line.
template <typename Options, typename Add>
Options Parse(const Add& add, std::vector<const char*> arguments) {
  Options options;
  CommandOptions command;
  add(&command, &options);
  arguments.insert(arguments.begin(), "program");
  ParseOptions(static_cast<int>(arguments.size()), arguments.data(), command);
  return options;
}

RefinerOptions ParseRefiner(const std::vector<const char*>& arguments) {
  return Parse<RefinerOptions>(AddRefinerOptions, arguments);
}

TEST(Presets, HighIsTheDefault) {
  const RefinerOptions by_default = ParseRefiner({});
  const RefinerOptions high = ParseRefiner({"--quality", "HIGH"});
  EXPECT_EQ(high.image_scale, by_default.image_scale);
  EXPECT_EQ(high.refinement.max_face_area, by_default.refinement.max_face_area);
}

TEST(Presets, CostMoreFromLowToExtreme) {
  const RefinerOptions low = ParseRefiner({"--quality", "low"});
  const RefinerOptions medium = ParseRefiner({"--quality", "medium"});
  const RefinerOptions high = ParseRefiner({});
  const RefinerOptions extreme = ParseRefiner({"--quality", "extreme"});
  EXPECT_LT(low.image_scale, medium.image_scale);
  EXPECT_LT(medium.image_scale, high.image_scale);
  EXPECT_GT(extreme.refinement.labeling.final_pairs_per_facet,
            high.refinement.labeling.final_pairs_per_facet);
  double before = 1000;
  for (const char* quality : {"low", "medium", "high", "extreme"}) {
    const double distance =
        Parse<MesherOptions>(AddMesherOptions, {"--quality", quality})
            .meshing.max_proj_dist;
    EXPECT_LT(distance, before);
    before = distance;
  }
}

TEST(Presets, GiveWayToWhatIsGivenBesides) {
  const RefinerOptions options = ParseRefiner(
      {"--FacetwiseRefinement.image_scale", "0.8", "--quality", "low"});
  EXPECT_EQ(options.image_scale, 0.8);
}

}  // namespace colmap_ext::presets_test
