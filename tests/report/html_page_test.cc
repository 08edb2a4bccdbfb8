#include "colmap_ext/report/html_page.h"

#include <sstream>

#include <gtest/gtest.h>

#include "tests/report/well_formed.h"
#include "tests/texts.h"

namespace colmap_ext {
namespace html_page_test {

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

class RunPageTest : public testing::Test {
 protected:
  RunPageTest() : log_(&printed_) {
    PrintHeading("Mesh", &log_);
    PrintText("", "      one       two", &log_);
    PrintText(kWicked, "   123.45      6.78", &log_);
    Print("faces", 98765, &log_);
    PrintHeading("Nothing", &log_);
    PrintWarning(kWicked, &log_);
    run_ = {"facetwise_refiner", kWicked, "1.2.3"};
    log_.options = {{"given", kWicked, false}, {"other", "7.25", true}};
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
  PageRun run_;
  PagePictures pictures_;
  std::vector<RefinementStep> steps_;
};

TEST_F(RunPageTest, HasAllThatIsPrinted) {
  const std::string page = RefinementPage(run_, log_, steps_, pictures_);
  ExpectGood(page);
  ExpectGood(MeshingPage(run_, log_, pictures_));
  EXPECT_TRUE(HasAll(page, {"--given", "7.25", "1.2.3", "-12.5", "0.8125",
                            "1/2 size", "<b>98765</b>faces", "there is none"}));
  EXPECT_TRUE(Has(page, std::string("<li>") + kEscaped + "</li>"));
  EXPECT_EQ(page, RefinementPage(run_, log_, steps_, pictures_));
}

TEST_F(RunPageTest, HasEachPictureWhereItIs) {
  const std::string page = MeshingPage(run_, log_, pictures_);
  EXPECT_EQ(Count(page, "src=\"data:image/png;base64,iVBORw0KGgo"), 3);
  EXPECT_TRUE(Has(page, std::string("alt=\"Photograph, ") + kEscaped + "\""));
}

TEST_F(RunPageTest, DoesWithoutWhatThereIsNot) {
  const ReportLog empty(&printed_);
  const std::string page = RefinementPage({}, empty, {}, {});
  EXPECT_EQ(XmlDefect(page), "");
  EXPECT_TRUE(HasNone(page, {"<svg", "<img", "class=\"warnings\"", "<li>"}));
}

TEST_F(RunPageTest, PutsLongTablesIntoFrames) {
  EXPECT_FALSE(Has(MeshingPage(run_, log_, {}), "card long"));
  PrintHeading("Cameras", &log_);
  for (int i = 0; i < 100; ++i) {
    PrintText("image", "   1", &log_);
  }
  EXPECT_TRUE(Has(MeshingPage(run_, log_, {}), "card long"));
}

TEST(PageOptionsTest, TellsWhatWasGiven) {
  std::string path;
  int number = 3;
  CommandOptions options;
  options.Add("path", &path);
  options.AddNumber("number", &number, {0, 9});
  number = 4;
  const std::vector<PageOption> page_options = PageOptions(options);
  ASSERT_EQ(page_options.size(), 2);
  EXPECT_TRUE(page_options[0].is_default);
  EXPECT_FALSE(page_options[1].is_default);
  EXPECT_EQ(page_options[1].value, "4");
}

}  // namespace html_page_test
}  // namespace colmap_ext
