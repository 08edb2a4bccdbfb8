#include "mesh/vertex_attributes.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/random.h"

namespace colmap_ext {
namespace vertex_attributes_test {

VertexAttributes RandomAttributes(uint32_t num_vertices, Random* random) {
  VertexAttributes attributes;
  for (uint32_t i = 0; i < num_vertices; ++i) {
    Color color;
    for (uint8_t& channel : color) {
      channel = static_cast<uint8_t>(random->Below(256));
    }
    attributes.colors.push_back(color);
    for (uint32_t view = 0; view < 6; ++view) {
      if (random->Chance(0.4)) {
        attributes.views.values.push_back(view);
      }
    }
    attributes.views.EndRow();
  }
  return attributes;
}

TEST(InterpolateAttributes, TakesMeanColorsAndTheViewsOfEither) {
  Random random(1);
  constexpr uint32_t kNumVertices = 30;
  const VertexAttributes attributes = RandomAttributes(kNumVertices, &random);
  std::vector<std::array<uint32_t, 2>> sources;
  for (int i = 0; i < 100; ++i) {
    sources.push_back({random.Below(kNumVertices), random.Below(kNumVertices)});
  }
  const VertexAttributes result = InterpolateAttributes(attributes, sources);
  ASSERT_EQ(result.colors.size(), sources.size());
  ASSERT_EQ(result.views.offsets.size(), sources.size() + 1);
  EXPECT_EQ(result.views.offsets.back(), result.views.values.size());
  for (size_t i = 0; i < sources.size(); ++i) {
    const auto& [a, b] = sources[i];
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(result.colors[i][k],
                  (attributes.colors[a][k] + attributes.colors[b][k]) / 2.0,
                  0.5);
    }
    std::set<uint32_t> expected;
    for (const uint32_t source : {a, b}) {
      const auto views = attributes.views[source];
      expected.insert(views.begin(), views.end());
    }
    const auto views = result.views[i];
    EXPECT_EQ(std::vector<uint32_t>(views.begin(), views.end()),
              std::vector<uint32_t>(expected.begin(), expected.end()));
  }
}

TEST(InterpolateAttributes, LeavesOldVerticesAsTheyAre) {
  Random random(2);
  const VertexAttributes attributes = RandomAttributes(20, &random);
  std::vector<std::array<uint32_t, 2>> sources;
  for (uint32_t i = 0; i < 20; ++i) {
    sources.push_back({i, i});
  }
  const VertexAttributes result = InterpolateAttributes(attributes, sources);
  EXPECT_EQ(result.colors, attributes.colors);
  EXPECT_EQ(result.views.offsets, attributes.views.offsets);
  EXPECT_EQ(result.views.values, attributes.views.values);
}

TEST(InterpolateAttributes, TakesMeanConfidences) {
  VertexAttributes attributes;
  attributes.views = Rows<uint32_t>(3);
  EXPECT_TRUE(InterpolateAttributes(attributes, {{0, 1}}).confidences.empty());
  attributes.confidences = {0.25f, 0.75f, 1.0f};
  EXPECT_EQ(InterpolateAttributes(attributes, {{0, 1}, {2, 2}}).confidences,
            (std::vector<float>{0.5f, 1.0f}));
}

TEST(InterpolateAttributes, MayGoWithoutColors) {
  Random random(3);
  VertexAttributes attributes = RandomAttributes(4, &random);
  attributes.colors.clear();
  const VertexAttributes result =
      InterpolateAttributes(attributes, {{0, 1}, {3, 3}});
  EXPECT_TRUE(result.colors.empty());
  EXPECT_EQ(result.views.offsets.size(), 3);
}

}  // namespace vertex_attributes_test
}  // namespace colmap_ext
