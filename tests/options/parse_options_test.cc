#include "colmap_ext/options/parse_options.h"

#include <sstream>

#include <gtest/gtest.h>

#include "colmap_ext/errors.h"
#include "tests/formats/test_files.h"
#include "tests/texts.h"

namespace colmap_ext {
namespace parse_options_test {

class ParseOptionsTest : public testing::Test {
 protected:
  ParseOptionsTest() {
    options_.Add("output_path", &text_, "Where to");
    options_.AddNumber("Ours.size", &number_, {0, 1000}, "[px] How large");
    options_.AddNumber("Ours.count", &count_, {-5, 10});
    options_.Add("Ours.flag", &flag_);
    options_.Add("paths", &paths_);
    options_.AddAlias("Theirs.size", "Ours.size", ", larger", &is_theirs_);
    options_.AddAlias("Theirs.count", "Ours.count");
    options_.AddAlias("output", "output_path");
    options_.SetGroup(OptionGroup::kAblations);
    options_.AddWord("Ours.kind", &kind_, {{"auto", 0}, {"off", 1}, {"0", 1}},
                     "Which");
  }

  ParsedOptions Parse(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "program");
    return ParseOptions(static_cast<int>(arguments.size()), arguments.data(),
                        options_);
  }

  ParsedOptions ParseProject(const std::string& text,
                             std::vector<const char*> arguments = {}) {
    WriteFile(project_, text);
    arguments.insert(arguments.end(), {"--project_path", project_.c_str()});
    return Parse(arguments);
  }

  void ExpectRefused(std::vector<const char*> arguments,
                     const std::string& message) {
    EXPECT_TRUE(
        Has(MessageOf<OptionError>([&] { Parse(arguments); }), message));
  }

  std::string text_ = "here";
  double number_ = 20;
  int count_ = -1;
  bool flag_ = false;
  std::vector<std::string> paths_;
  int kind_ = 0;
  bool is_theirs_ = false;
  CommandOptions options_;
  TemporaryFolder folder_;
  std::string project_ = (folder_.Path() / "project file.ini").string();
};

TEST_F(ParseOptionsTest, SetsWhatIsGivenAndLeavesTheRest) {
  EXPECT_TRUE(Parse({}).ignored.empty());
  EXPECT_EQ(text_, "here");
  EXPECT_EQ(number_, 20);
  Parse({"--output_path", "a b/c", "--Ours.size=5.", "--Ours.count", "-3",
         "--Ours.flag", "true"});
  EXPECT_EQ(text_, "a b/c");
  EXPECT_EQ(number_, 5);
  EXPECT_EQ(count_, -3);
  EXPECT_TRUE(flag_);
  EXPECT_FALSE(is_theirs_);
  Parse({"--output_path="});
  EXPECT_EQ(text_, "");
}

TEST_F(ParseOptionsTest, ListsTakeSeveralValuesSeveralTimes) {
  Parse({"--paths", "a,b", "c d", "--Ours.size", "5", "--paths=e"});
  EXPECT_EQ(paths_, (std::vector<std::string>{"a,b", "c d", "e"}));
  EXPECT_EQ(number_, 5);
  ExpectRefused({"--paths"}, "--paths needs a value");
  ExpectRefused({"--Ours.size", "5", "6"}, "'6' stands without an option");
}

TEST_F(ParseOptionsTest, TakesNamesCutShortWhereTheyAreClear) {
  Parse({"--outp", "x", "--Ours.si", "1e-3"});
  EXPECT_EQ(text_, "x");
  EXPECT_EQ(number_, 1e-3);
  ExpectRefused({"--Ours.", "1"}, "ambiguous");
}

TEST_F(ParseOptionsTest, RefusesWhatItCanNotUnderstand) {
  ExpectRefused({"--none", "1"}, "there is no option --none");
  ExpectRefused({"--Ours.none", "1"}, "there is no option --Ours.none");
  ExpectRefused(
      {"--Ours.count", "1.5"},
      "--Ours.count is '1.5'; it has to be a whole number, -5 ... 10");
  ExpectRefused({"--Ours.size", "12px"},
                "--Ours.size is '12px'; it has to be a number, 0 ... 1000");
  ExpectRefused({"--Ours.flag", "2"},
                "--Ours.flag is '2'; it has to be 0 or 1");
  ExpectRefused({"--Ours.kind", "x"}, "it has to be auto or off");
  ExpectRefused({"--output_path"}, "--output_path needs a value");
  ExpectRefused({"--output_path", "--Ours.flag", "1"}, "needs a value");
  ExpectRefused({"somewhere"}, "'somewhere' stands without an option");
  ExpectRefused({"--Ours.size", "1", "--Ours.size", "1"}, "twice");
}

TEST_F(ParseOptionsTest, TakesAliasesAndNamesWhatMeansNothing) {
  const ParsedOptions parsed =
      Parse({"--Theirs.size", "10", "--Theirs.new_one", "3", "--log_level", "2",
             "--random_seed=0"});
  EXPECT_EQ(number_, 10);
  EXPECT_TRUE(is_theirs_);
  EXPECT_EQ(parsed.ignored,
            (std::vector<std::string>{"--Theirs.new_one", "--log_level",
                                      "--random_seed"}));
  ExpectRefused({"--Theirs.size", "10", "--Ours.size", "5"}, "same option");
  Parse({"--output", "there", "--Ours.kind", "OFF"});
  EXPECT_EQ(text_, "there");
  EXPECT_EQ(kind_, 1);
  Parse({"--Ours.kind", "auto"});
  Parse({"--Ours.kind", "0"});
  EXPECT_EQ(kind_, 1);
}

TEST_F(ParseOptionsTest, ReadsProjectFilesAfterTheCommandLine) {
  const ParsedOptions parsed = ParseProject(
      "database_path=/x.db\nlog_level = 0\r\noutput_path = a b # a comment\n"
      "[Other]\nsize=1\nmask=\n[Theirs]\nsize=7\nunknown=1\n[Ours]\ncount=4\n",
      {"--Ours.count", "9"});
  EXPECT_EQ(text_, "a b");
  EXPECT_EQ(number_, 7);
  EXPECT_TRUE(is_theirs_);
  EXPECT_EQ(count_, 9);
  EXPECT_EQ(parsed.ignored,
            (std::vector<std::string>{"Other.*", "Theirs.*", "database_path",
                                      "log_level"}));
}

TEST_F(ParseOptionsTest, PrefersItsOwnNamesAndTheCommandLine) {
  ParseProject("[Theirs]\nsize=7\ncount=7\n[Ours]\nsize=6\n",
               {"--Theirs.count", "8"});
  EXPECT_EQ(number_, 6);
  EXPECT_FALSE(is_theirs_);
  EXPECT_EQ(count_, 8);
  ParseProject("[Theirs]\nsize=7\n", {"--Ours.size", "5"});
  EXPECT_EQ(number_, 5);
  EXPECT_FALSE(is_theirs_);
}

TEST_F(ParseOptionsTest, RefusesBadProjectFiles) {
  ExpectRefused({"--project_path", "/none.ini"}, "/none.ini cannot be read");
  ExpectRefused({"--project_path", "/tmp"}, "/tmp cannot be read");
  for (const auto& [text, message] :
       {std::pair("nonsense\n", "line 1"), std::pair("[A]\n=3\n", "line 2"),
        std::pair("[A]\nb=3\nb=4\n", "A.b is given twice"),
        std::pair("[Ours]\nsizes=3\n", "there is no option Ours.sizes"),
        std::pair("outptu_path=3\n", "there is no option outptu_path")}) {
    WriteFile(project_, text);
    ExpectRefused({"--project_path", project_.c_str()}, message);
  }
}

TEST_F(ParseOptionsTest, PrintsEachGroupWithDefaults) {
  EXPECT_TRUE(Parse({"--Ours.count", "3", "-h"}).wants_help);
  EXPECT_TRUE(Parse({"--version"}).wants_version);
  std::ostringstream stream;
  PrintHelp(options_, "program 1.2", stream);
  const std::string help = stream.str();
  EXPECT_TRUE(help.starts_with("program 1.2\n"));
  EXPECT_TRUE(HasAll(
      help,
      {"  --output_path (=here)\n      Where to\n",
       "  --Ours.size (=20; 0 ... 1000)\n      [px] How large\n",
       "  --Ours.count (=-1; -5 ... 10)\n",
       "\n\nAblations of the paper:\n\n"
       "  --Ours.kind (=auto)\n      {auto, off}: Which\n\nOther names:\n",
       "  --Theirs.size\n      is --Ours.size, larger\n"}));
}

}  // namespace parse_options_test
}  // namespace colmap_ext
