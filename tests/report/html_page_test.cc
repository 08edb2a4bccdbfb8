#include "colmap_ext/report/html_page.h"

#include <limits>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/report/well_formed.h"

namespace colmap_ext::html_page_test {

constexpr const char* kWicked = "a <b> & \"c\" 'd' \xc3\xa4\xff.ply";
constexpr const char* kEscaped =
    "a &lt;b&gt; &amp; &quot;c&quot; &#39;d&#39; \xc3\xa4\xef\xbf\xbd.ply";

TEST(EscapeHtmlTest, LeavesOnlyCharactersOfXml) {
  EXPECT_EQ(EscapeHtml(kWicked), kEscaped);
  const std::string bad = "\xef\xbf\xbd";
  EXPECT_EQ(EscapeHtml("\xf0\x9f\x90\x87\t\n"), "\xf0\x9f\x90\x87\t\n");
  EXPECT_EQ(EscapeHtml("\x1b[0m"), bad + "[0m");
  EXPECT_EQ(EscapeHtml(std::string(1, '\0')), bad);
  EXPECT_EQ(EscapeHtml("\xc3"), bad) << "cut off";
  EXPECT_EQ(EscapeHtml("\xc3z"), bad + "z");
  EXPECT_EQ(EscapeHtml("\xc0\xbc"), bad + bad) << "too long for its character";
  EXPECT_EQ(EscapeHtml("\xed\xa0\x80"), bad + bad + bad) << "a surrogate";
  EXPECT_EQ(EscapeHtml("\xef\xbf\xbf"), bad + bad + bad) << "not a character";
}

TEST(Base64Test, GivesTheExamplesOfItsStandard) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foo"), "Zm9v");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(Base64("\xff\xfe\xfd"), "//79");
}

struct RunPageTest : testing::Test {
  RunPageTest() : log_(&printed_) {
    PrintHeading("Mesh", &log_);
    PrintText("", "      one       two", &log_);
    PrintText(kWicked, "   123.45      6.78", &log_);
    Print("faces", 98765, &log_);
    PrintHeading("Nothing", &log_);
    PrintWarning(kWicked, &log_);
    run_ = {"facetwise_refiner", kWicked, "1.2.3"};
    command_.Add("given", &given_);
    command_.Add("other", &other_, {0, 9});
    given_ = kWicked;
    log_.command = &command_;
    const ColorImage image{2, 1, {{1, 2, 3}, {4, 5, 6}}};
    pictures_ = {{kWicked, "second.png"},
                 {{"Photograph", "", false, {image, {}}},
                  {"Confidence", "how well", true, {image, image}}}};
    steps_.resize(3);
    steps_[0].level = steps_[1].level = 1;
    steps_[1].energy = -12.5;
    steps_[1].mean_zncc = 0.8125;
  }

  void ExpectGood(const std::string& page) const {
    EXPECT_EQ(XmlDefect(page), "");
    EXPECT_TRUE(page.starts_with("<!DOCTYPE html>\n"));
    EXPECT_TRUE(page.ends_with("</html>\n"));
    EXPECT_TRUE(HasNone(page, {"http:", "https:", "url(", "<link", "<script"}));
    EXPECT_FALSE(Has(page, "a <b>"));
    for (const ReportSection& section : log_.sections) {
      for (const ReportRow& row : section.rows) {
        EXPECT_TRUE(Has(page, ">" + EscapeHtml(row.label) + "</th>"));
        std::istringstream words(row.text);
        for (std::string word; words >> word;) {
          EXPECT_TRUE(Has(page, EscapeHtml(word))) << word;
        }
      }
    }
  }

  std::ostringstream printed_;
  ReportLog log_;
  std::string given_;
  double other_ = 7.25;
  CommandOptions command_;
  PageRun run_;
  PagePictures pictures_;
  std::vector<RefinementStep> steps_;
};

TEST_F(RunPageTest, HasAllThatIsPrinted) {
  const std::string page = RefinementPage(run_, log_, steps_, pictures_);
  ExpectGood(page);
  ExpectGood(MeshingPage(run_, log_, pictures_));
  const size_t defaults = page.find("<summary>defaults");
  EXPECT_LT(page.find("--given"), defaults);
  EXPECT_GT(page.find("--other"), defaults);
  EXPECT_TRUE(HasAll(page, {"--given", "7.25", "1.2.3", "-12.5", "0.8125",
                            "1/2 size", "<b>98765</b>faces", "there is none"}));
  EXPECT_TRUE(Has(page, std::string("<li>") + kEscaped + "</li>"));
  EXPECT_EQ(page, RefinementPage(run_, log_, steps_, pictures_));
}

TEST_F(RunPageTest, HasEachPictureWhereItIsOrNone) {
  const std::string page = MeshingPage(run_, log_, pictures_);
  EXPECT_EQ(Count(page, "src=\"data:image/png;base64,iVBORw0KGgo"), 3);
  EXPECT_TRUE(Has(page, std::string("alt=\"Photograph, ") + kEscaped + "\""));
  const ReportLog empty(&printed_);
  const std::string bare = RefinementPage({}, empty, {}, {});
  EXPECT_EQ(XmlDefect(bare), "");
  EXPECT_TRUE(HasNone(bare, {"<svg", "<img", "class=\"warnings\"", "<li>"}));
}

TEST_F(RunPageTest, PutsLongTablesIntoFrames) {
  EXPECT_FALSE(Has(MeshingPage(run_, log_, {}), "card long"));
  PrintHeading("Cameras", &log_);
  for (int i = 0; i < 100; ++i) {
    PrintText("image", "   1", &log_);
  }
  EXPECT_TRUE(Has(MeshingPage(run_, log_, {}), "card long"));
}

constexpr Color kWhite = {255, 255, 255};

// A square in the plane z = 0 that four cameras at z = 3 see, and one that
// looks away.
struct Square {
  Square() {
    for (const double x : {0.0, 0.1, -1.0, 1.0}) {
      views.push_back(
          LookAtView({x, 0, 3}, {0, 0, 0}, {0, 1, 0}, 600, 300, 500));
    }
    views.push_back(LookAtView({9, 0, 3}, {9, 0, 9}, {0, 1, 0}, 600, 300, 500));
    for (size_t i = 0; i < views.size(); ++i) {
      views[i].name = std::to_string(i);
    }
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      vertex_views.AddRow(std::vector<uint32_t>{0, 1, 2, 3});
    }
  }

  TriangleMesh mesh = {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
                       {{0, 1, 2}, {0, 2, 3}}};
  std::vector<View> views;
  Rows<uint32_t> vertex_views;
};

// No picture of the third camera can be read.
PictureDecoder Decoder() {
  PictureDecoder decoder;
  decoder.read_color =
      [](const std::filesystem::path& path) -> std::optional<ColorImage> {
    EXPECT_EQ(path.parent_path(), "images");
    if (path.filename() == "2") {
      return std::nullopt;
    }
    return ColorImage{6, 3, std::vector<Color>(18, {10, 20, 30})};
  };
  return decoder;
}

// The pictures of the square as a mesh of one point.
PagePictures DrawMesh(const Square& square, std::vector<Color> colors = {}) {
  ManifoldMesh mesh;
  mesh.mesh = square.mesh;
  mesh.attributes.colors = std::move(colors);
  mesh.attributes.views = square.vertex_views;
  const PointCloud cloud = {{{0, 0, 0}}, {{1, 2, 3}}, {}};
  return DrawMeshing(square.views, cloud, mesh, "images", Decoder());
}

TEST(DrawMeshingTest, TakesThreeCamerasThatSeeTheMeshAndAreFarApart) {
  Square square;
  const PagePictures page = DrawMesh(square);
  EXPECT_EQ(page.cameras, (std::vector<std::string>{"0", "2", "3"}));
  const std::vector<ColorImage>& photos = page.rows[0].pictures;
  ASSERT_EQ(photos.size(), 3);
  EXPECT_EQ(photos[0].width, 480);
  EXPECT_EQ(photos[0].height, 240);
  EXPECT_EQ(photos[0].At(239, 479), (Color{10, 20, 30}));
  EXPECT_EQ(photos[1].width, 0);
  square.vertex_views = Rows<uint32_t>(square.mesh.vertices.size());
  EXPECT_TRUE(DrawMesh(square).cameras.empty());
}

void ExpectAllDrawn(const PagePictures& page, size_t num_rows) {
  ASSERT_EQ(page.cameras.size(), 3);
  ASSERT_EQ(page.rows.size(), num_rows);
  for (size_t i = 1; i < num_rows; ++i) {
    ASSERT_EQ(page.rows[i].pictures.size(), 3) << page.rows[i].title;
    for (const ColorImage& picture : page.rows[i].pictures) {
      EXPECT_EQ(picture.width, 480);
      EXPECT_NE(picture.At(120, 240), kWhite) << page.rows[i].title;
      EXPECT_EQ(picture.At(0, 0), kWhite) << page.rows[i].title;
    }
  }
}

TEST(DrawRefinementTest, DrawsBeforeAfterLabelsAndConfidence) {
  const Square square;
  RefinedMesh refined;
  refined.mesh = square.mesh;
  refined.attributes.views = square.vertex_views;
  refined.views = square.views;
  refined.attributes.confidences.assign(4, 1);
  refined.labels.pairs = {{0, 1}};
  refined.labels.labels = Rows<uint32_t>({0, 1, 1}, {0});
  TriangleMesh before = square.mesh;
  std::swap(before.facets[0][0], before.facets[0][1]);
  std::swap(before.facets[1][0], before.facets[1][1]);
  const PagePictures page =
      DrawRefinement(before, refined, "images", Decoder());
  ExpectAllDrawn(page, 5);
  const Color back = page.rows[1].pictures[0].At(120, 240);
  EXPECT_GT(back[0], 2 * back[1]) << "seen from behind";
  const ColorImage& labels = page.rows[3].pictures[0];
  EXPECT_NE(labels.At(150, 270), labels.At(90, 210)) << "a label and none";
  const Color confidence = page.rows[4].pictures[0].At(120, 240);
  EXPECT_GT(confidence[0], 2 * confidence[2]) << "yellow";
}

TEST(DrawMeshingTest, DrawsPointsMeshConfidenceAndColors) {
  PagePictures page = DrawMesh(Square(), std::vector<Color>(4, {200, 100, 50}));
  ExpectAllDrawn(page, 5);
  EXPECT_EQ(page.rows[1].pictures[0].At(120, 240), (Color{1, 2, 3}));
  EXPECT_EQ(page.rows[4].pictures[0].At(120, 240), (Color{200, 100, 50}));
  page = DrawMesh(Square());
  EXPECT_EQ(page.rows[4].pictures[0].pixels, page.rows[2].pictures[0].pixels);
}

// Two iterations at half size, one and a final one at full size.
std::vector<RefinementStep> Steps() {
  std::vector<RefinementStep> steps(4);
  steps[0].level = steps[1].level = 1;
  steps[1].iteration = 1;
  steps[1].energy = -1.0 / 3;
  steps[1].mean_zncc = 0.5;
  steps[1].mean_step = 0.25;
  steps[1].seconds = 1.5;
  steps[1].num_vertices = 10;
  steps[1].num_facets = 16;
  steps[3].is_final = true;
  steps[3].iteration = 1;
  steps[3].num_pairs = 18;
  return steps;
}

TEST(RefinementReportTest, WritesARowAnIteration) {
  EXPECT_EQ(StepsCsv(Steps()),
            "level,final,iteration,energy,photometric_energy,mean_zncc,"
            "mean_step_px,seconds,vertices,faces,pairs\n"
            "1,0,0,0,0,0,0,0.000,0,0,0\n"
            "1,0,1,-0.333333333,0,0.5,0.25,1.500,10,16,0\n"
            "0,0,0,0,0,0,0,0.000,0,0,0\n"
            "0,1,1,0,0,0,0,0.000,0,0,18\n");
}

TEST(RefinementReportTest, SplitsIterationsIntoStagesAndDescribesThem) {
  const auto stages = SplitIntoStages(Steps());
  ASSERT_EQ(stages.size(), 3);
  EXPECT_EQ(stages[0].size(), 2);
  EXPECT_EQ(StageName(stages[0][0]), "1/2 size");
  EXPECT_EQ(StageName(stages[2][0]), "full size, final, 18 pairs");
  EXPECT_EQ(Describe(Steps()[1]),
            "1/2 size, iteration 1: energy -0.333333, ZNCC 0.5000, step 0.250 "
            "px");
  const std::vector<StageText> texts = DescribeStages(Steps());
  ASSERT_EQ(texts.size(), 3);
  EXPECT_EQ(texts[0].name, "1/2 size");
  EXPECT_EQ(texts[0].iterations, "1");
  EXPECT_EQ(texts[0].faces, "16");
  EXPECT_EQ(texts[0].energy[0], "0");
  EXPECT_EQ(texts[0].energy[1], "-0.333333");
  EXPECT_EQ(texts[0].mean_zncc[0], "0.0000");
  EXPECT_EQ(texts[0].mean_zncc[1], "0.5000");
}

TEST(RefinementReportTest, PlotsAPanelAStage) {
  const std::string figure = StepsFigure(Steps());
  EXPECT_TRUE(figure.starts_with("<svg role="));
  EXPECT_TRUE(figure.ends_with("</svg>\n"));
  EXPECT_EQ(Count(figure, "<polyline"), 3);
  EXPECT_TRUE(StepsFigure({}).ends_with("</svg>\n"));
  EXPECT_TRUE(HasAll(figure, {"Mean ZNCC", ">0.5000<"}));
  EXPECT_FALSE(Has(figure, "http"));
}

TEST(PrintLinesTest, AlignsNumbersAndKeepsWhatIsPrinted) {
  std::ostringstream stream;
  ReportLog log(&stream);
  Print("faces", 12, &log);
  PrintIfAny("none", 0, &log);
  PrintHeading("Heading", &log);
  PrintText("label", "text", &log);
  PrintWarning("what", &log);
  EXPECT_EQ(stream.str(),
            "  faces                                             12\n"
            "\nHeading\n"
            "  label                                 text\n"
            "WARNING: what\n");
  ASSERT_EQ(log.sections.size(), 2);
  EXPECT_EQ(log.sections[0].heading, "");
  EXPECT_EQ(log.sections[1].heading, "Heading");
  ASSERT_EQ(log.sections[1].rows.size(), 1);
  EXPECT_EQ(log.sections[1].rows[0].label, "label");
  EXPECT_EQ(log.sections[1].rows[0].text, "text");
  EXPECT_EQ(log.warnings, std::vector<std::string>{"what"});
}

TEST(EvaluationJsonTest, HasNineDigitsNullForWhatIsNotFiniteAndOrderedKeys) {
  EvaluatorOptions options;
  options.mesh_path = "a \"mesh\"\n\xff.ply";
  MeshEvaluation evaluation;
  evaluation.num_views = 7;
  evaluation.distances.emplace();
  evaluation.distances->max_distance = 20;
  evaluation.distances->spacing = 1.0 / 3;
  evaluation.distances->accuracy.mean =
      std::numeric_limits<double>::quiet_NaN();
  evaluation.distances->accuracy.num_samples = size_t{1} << 60;
  const auto json = nlohmann::json::parse(EvaluationJson(options, evaluation));
  EXPECT_EQ(json["mesh_path"], "a \"mesh\"\n\xef\xbf\xbd.ply");
  EXPECT_EQ(json["num_images"], 7);
  EXPECT_EQ(json["max_distance"], 20);
  EXPECT_EQ(json["spacing"], 0.333333333);
  EXPECT_TRUE(json["accuracy"]["mean"].is_null());
  EXPECT_EQ(json["accuracy"]["num_samples"], size_t{1} << 60);
  EXPECT_TRUE(json["depths"].is_null());
  const std::string text = EvaluationJson(options, evaluation);
  size_t position = 0;
  for (const char* key :
       {"mesh_path", "truth_path", "workspace_path", "stride", "beyond",
        "num_images", "max_distance", "spacing", "accuracy", "completeness",
        "average_score", "depths", "topology", "is_manifold", "genus"}) {
    const size_t found = text.find("\"" + std::string(key) + "\": ", position);
    ASSERT_NE(found, std::string::npos) << key;
    position = found;
  }
  EXPECT_TRUE(text.ends_with("}\n"));
}

}  // namespace colmap_ext::html_page_test
