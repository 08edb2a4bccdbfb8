#include "colmap_ext/refinement/resume_file.h"

#include <cmath>
#include <cstddef>
#include <limits>

#include "tests/formats/test_files.h"

namespace colmap_ext {
namespace resume_file_test {

ResumeRecord MakeRecord() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  ResumeRecord record;
  record.identity = {{"levels", "3"}, {"images/\"a\"\n.png", "none"}};
  record.level = 2;
  record.mesh = "1 bytes, hash 0";
  record.visibility = "none";
  record.origins = "2 bytes, hash 1";
  record.fixed = "3 bytes, hash 2";
  record.report.num_shortened_steps = size_t{1} << 60;
  record.report.num_unconverged_solutions = 5;
  record.report.num_flipped_facets = 7;
  record.report.num_removed_self_intersections = 11;
  record.report.labelings = {{2, 9, 1, 0.1, 1e-300, -kInfinity}};
  record.report.steps.resize(2);
  record.report.steps[0].level = 2;
  record.report.steps[0].energy = 1.0 / 3;
  record.report.steps[0].mean_zncc = std::nextafter(0.9, 1);
  record.report.steps[1].is_final = true;
  record.report.steps[1].num_pairs = 18;
  record.report.steps[1].iteration = 4;
  record.report.steps[1].photometric_energy = kInfinity;
  record.report.steps[1].mean_step = 5e-324;
  record.report.steps[1].seconds = 1e300;
  record.report.steps[1].num_facets = 12;
  record.report.misalignment = {1.0 / 3, 0.1, {0, 1e-300}};
  record.cameras = {{1000.1, 1000.2, 320, 240, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0.1,
                     -1.0 / 3, 1e-300}};
  return record;
}

ResumeRecord Parse(const std::string& text) {
  return ParseResumeText(text, "mesh.ply.resume");
}

void ExpectDamaged(const std::string& text) {
  EXPECT_EQ(FileErrorOf([&] { Parse(text); }),
            "mesh.ply.resume: damaged, or of another version of the program; "
            "start anew, without --resume")
      << text;
}

std::string Replace(std::string text, const std::string& before,
                    const std::string& after) {
  const size_t position = text.find(before);
  EXPECT_NE(position, std::string::npos) << before;
  return text.replace(position, before.size(), after);
}

TEST(ResumeFileTest, ReadsNumbersBackAsTheyWere) {
  const ResumeRecord record = MakeRecord();
  const ResumeRecord read = Parse(ResumeText(record));
  EXPECT_EQ(read.identity, record.identity);
  EXPECT_EQ(read.level, record.level);
  EXPECT_EQ(read.mesh, record.mesh);
  EXPECT_EQ(read.visibility, record.visibility);
  EXPECT_EQ(read.origins, record.origins);
  EXPECT_EQ(read.fixed, record.fixed);
  EXPECT_EQ(read.report.num_shortened_steps, size_t{1} << 60);
  EXPECT_EQ(read.report.num_unconverged_solutions, 5);
  EXPECT_EQ(read.report.num_flipped_facets, 7);
  EXPECT_EQ(read.report.num_removed_self_intersections, 11);
  ASSERT_TRUE(read.report.misalignment);
  EXPECT_EQ(read.report.misalignment->by_cameras, 1.0 / 3);
  EXPECT_EQ(read.report.misalignment->of_surface, 0.1);
  EXPECT_EQ(read.report.misalignment->by_view,
            (std::vector<double>{0, 1e-300}));
  ASSERT_EQ(read.report.labelings.size(), 1);
  const LabelingReport& labeling = read.report.labelings[0];
  EXPECT_EQ(labeling.num_pairs, 9);
  EXPECT_EQ(labeling.num_unlabeled_facets, 1);
  EXPECT_EQ(labeling.initial_energy, 0.1);
  EXPECT_EQ(labeling.final_energy, 1e-300);
  EXPECT_EQ(labeling.lower_bound, -std::numeric_limits<double>::infinity());
  ASSERT_EQ(read.report.steps.size(), 2);
  EXPECT_EQ(read.report.steps[0].energy, 1.0 / 3);
  EXPECT_EQ(read.report.steps[0].mean_zncc, std::nextafter(0.9, 1));
  EXPECT_EQ(read.report.steps[1].photometric_energy,
            std::numeric_limits<double>::infinity());
  EXPECT_EQ(read.report.steps[1].mean_step, 5e-324);
  EXPECT_TRUE(read.report.steps[1].is_final);
  EXPECT_EQ(read.report.steps[1].num_pairs, 18);
  EXPECT_EQ(read.report.steps[1].num_facets, 12);
  EXPECT_EQ(read.cameras, record.cameras);
  EXPECT_EQ(ResumeText(read), ResumeText(record));
}

TEST(ResumeFileTest, ReadsNotANumber) {
  ResumeRecord record = MakeRecord();
  record.report.steps[0].energy = std::nan("");
  EXPECT_TRUE(std::isnan(Parse(ResumeText(record)).report.steps[0].energy));
}

TEST(ResumeFileTest, RefusesEveryTruncation) {
  const std::string text = ResumeText(MakeRecord());
  for (size_t size = 0; size + 1 < text.size(); ++size) {  // of the last line
    ExpectDamaged(text.substr(0, size));
  }
}

TEST(ResumeFileTest, RefusesOtherTexts) {
  const std::string text = ResumeText(MakeRecord());
  ExpectDamaged("colmap_ext_facetwise_refiner_state 2\n");
  ExpectDamaged("[]");
  ExpectDamaged("null");
  ExpectDamaged(text + "x");
  ExpectDamaged(Replace(text, "facetwise_refiner", "mesher"));
  ExpectDamaged(Replace(text, "\"version\": 6", "\"version\": 3"));
  ExpectDamaged(Replace(text, "\"level\": 2", "\"level\": 0"));
  ExpectDamaged(Replace(text, "\"level\": 2", "\"level\": -1"));
  ExpectDamaged(Replace(text, "\"level\": 2", "\"level\": 2.5"));
  ExpectDamaged(Replace(text, "\"level\": 2", "\"level\": 4294967298"));
  ExpectDamaged(Replace(text, "\"level\": 2", "\"level\": \"2\""));
  ExpectDamaged(Replace(text, "\"-inf\"", "\"-infinity\""));
  ExpectDamaged(Replace(text, "1e+300", "1e+400"));
  ExpectDamaged(Replace(text, "\"is_final\": true", "\"is_final\": 1"));
  ExpectDamaged(Replace(text, "\"none\"", "7"));
}

TEST(ResumeFileTest, SurvivesDeepNesting) {
  ExpectDamaged(std::string(1 << 20, '['));
  const std::string text = ResumeText(MakeRecord());
  constexpr size_t kDepth = 1 << 20;
  EXPECT_EQ(ResumeText(Parse(Replace(text, "{",
                                     "{\"more\": " + std::string(kDepth, '[') +
                                         std::string(kDepth, ']') + ","))),
            text);
}

}  // namespace resume_file_test
}  // namespace colmap_ext
