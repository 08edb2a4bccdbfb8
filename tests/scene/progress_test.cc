#include "scene/progress.h"

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace colmap_ext {
namespace {

TEST(Report, TellsTheStageAndTheShare) {
  std::vector<std::pair<std::string, double>> told;
  const Progress progress = [&](std::string_view stage, double share) {
    told.emplace_back(stage, share);
  };
  Report(progress, "Meshing", 0);
  Report(progress, "Meshing", 0.5);
  EXPECT_EQ(told, (std::vector<std::pair<std::string, double>>{
                      {"Meshing", 0}, {"Meshing", 0.5}}));
}

TEST(Report, MayHaveNobodyToTell) { Report({}, "Meshing", 0); }

}  // namespace
}  // namespace colmap_ext
