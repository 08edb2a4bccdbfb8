#include "mesh/vertex_attributes.h"

#include <set>

#include <gtest/gtest.h>

#include "tests/random.h"

namespace colmap_ext {
namespace {

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
        attributes.view_indices.push_back(view);
      }
    }
    attributes.view_offsets.push_back(attributes.view_indices.size());
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
  ASSERT_EQ(result.view_offsets.size(), sources.size() + 1);
  EXPECT_EQ(result.view_offsets.back(), result.view_indices.size());
  for (size_t i = 0; i < sources.size(); ++i) {
    const auto& [a, b] = sources[i];
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(result.colors[i][k],
                  (attributes.colors[a][k] + attributes.colors[b][k]) / 2.0,
                  0.5);
    }
    std::set<uint32_t> expected;
    for (const uint32_t source : {a, b}) {
      const auto views = attributes.Views(source);
      expected.insert(views.begin(), views.end());
    }
    const auto views = result.Views(i);
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
  EXPECT_EQ(result.view_offsets, attributes.view_offsets);
  EXPECT_EQ(result.view_indices, attributes.view_indices);
}

TEST(InterpolateAttributes, MayGoWithoutColors) {
  Random random(3);
  VertexAttributes attributes = RandomAttributes(4, &random);
  attributes.colors.clear();
  const VertexAttributes result =
      InterpolateAttributes(attributes, {{0, 1}, {3, 3}});
  EXPECT_TRUE(result.colors.empty());
  EXPECT_EQ(result.view_offsets.size(), 3);
}

}  // namespace
}  // namespace colmap_ext
