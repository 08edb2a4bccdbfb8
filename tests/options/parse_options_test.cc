#include "colmap_ext/options/command_options.h"

#include <array>
#include <cmath>
#include <functional>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "colmap_ext/options/evaluation_options.h"
#include "colmap_ext/options/meshing_options.h"
#include "colmap_ext/options/refinement_options.h"
#include "colmap_ext/options/viewer_options.h"
#include "tests/formats/test_files.h"

namespace colmap_ext::parse_options_test {

ParsedOptions ParseArguments(const CommandOptions& command,
                             const std::vector<std::string>& arguments) {
  std::vector<const char*> argv = {"program"};
  for (const std::string& argument : arguments) {
    argv.push_back(argument.c_str());
  }
  return ParseOptions(static_cast<int>(argv.size()), argv.data(), command);
}

struct ParseOptionsTest : testing::Test {
  ParseOptionsTest() {
    options_.Add("output_path", &text_, "Where to");
    options_.Add("Ours.size", &number_, {0, 1000}, "[px] How large");
    options_.Add("Ours.count", &count_, {-5, 10});
    options_.Add("Ours.flag", &flag_);
    options_.Add("paths", &paths_);
    options_.AddAlias("Theirs.size", "Ours.size", ", larger", &is_theirs_);
    options_.AddAlias("Theirs.count", "Ours.count");
    options_.AddAlias("output", "output_path");
    options_.SetGroup(OptionGroup::kAblations);
    options_.AddWord("Ours.kind", &kind_, {{"auto", 0}, {"off", 1}}, "Which");
  }

  ParsedOptions Parse(const std::vector<std::string>& arguments) const {
    return ParseArguments(options_, arguments);
  }

  ParsedOptions ParseProject(const std::string& text,
                             std::vector<std::string> arguments = {}) const {
    WriteFile(project_, text);
    arguments.insert(arguments.end(), {"--project_path", project_});
    return Parse(arguments);
  }

  void ExpectRefused(const std::vector<std::string>& arguments,
                     const std::string& message) const {
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
  EXPECT_EQ(kind_, 0);
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
    ExpectRefused({"--project_path", project_}, message);
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

// All options of all commands.
struct NumberRangesTest : testing::Test {
  using Option = CommandOptions::Option;

  NumberRangesTest() {
    AddMesherOptions(&commands_[0], &mesher_);
    AddRefinerOptions(&commands_[1], &refiner_);
    AddEvaluatorOptions(&commands_[2], &evaluator_);
    AddViewerOptions(&commands_[3], &viewer_);
    AddPlannerOptions(&commands_[4], &planner_);
    AddMergerOptions(&commands_[5], &merger_);
  }

  static bool IsWhole(const Option& option) {
    return option.kind.starts_with("a whole number");
  }

  static double NumberOf(const Option& option) {
    const char* const word = option.range->word;
    return word != nullptr && option.text() == word ? *option.range->also
                                                    : std::stod(option.text());
  }

  void ForEachNumber(
      const std::function<void(const CommandOptions&, const Option&)>& visit) {
    for (const CommandOptions& command : commands_) {
      size_t num_numbers = 0;
      for (const Option& option : command.Options()) {
        if (option.range) {
          SCOPED_TRACE(option.name);
          ++num_numbers;
          visit(command, option);
        }
      }
      EXPECT_GT(num_numbers, 0u);
    }
  }

  // By the command line, and by a project file.
  // \param name  the option's, or an alias
  void ExpectRefused(const CommandOptions& command, const Option& option,
                     const std::string& name, const std::string& text) {
    const std::string project = (folder_.Path() / "project.ini").string();
    WriteFile(project, name + "=" + text + "\n");
    const std::vector<std::string> ways[] = {{"--" + name + "=" + text},
                                             {"--project_path", project}};
    const double before = NumberOf(option);
    for (const std::vector<std::string>& arguments : ways) {
      EXPECT_TRUE(HasAll(
          MessageOf<OptionError>([&] { ParseArguments(command, arguments); }),
          {"--" + name + " ", "'" + text + "'", option.range->Text()}));
      EXPECT_EQ(NumberOf(option), before);
    }
  }

  MesherOptions mesher_;
  RefinerOptions refiner_;
  EvaluatorOptions evaluator_;
  ViewerOptions viewer_;
  PlannerOptions planner_;
  MergerOptions merger_;
  std::array<CommandOptions, 6> commands_;
  TemporaryFolder folder_;
};

TEST_F(NumberRangesTest, HoldTheDefaults) {
  ForEachNumber([](const CommandOptions&, const Option& option) {
    EXPECT_TRUE(option.range->Contains(NumberOf(option)));
    EXPECT_LT(option.range->lower, option.range->upper);
  });
}

TEST_F(NumberRangesTest, WhatIsNotFiniteIsRefused) {
  ForEachNumber([this](const CommandOptions& command, const Option& option) {
    for (const char* text : {"inf", "-inf", "Infinity", "nan", "-NaN", "1e999",
                             "-1e999", "2147483648e9999"}) {
      ExpectRefused(command, option, option.name, text);
    }
  });
}

TEST_F(NumberRangesTest, WhatIsOutsideIsRefused) {
  ForEachNumber([this](const CommandOptions& command, const Option& option) {
    const auto& [lower, upper, also, word] = *option.range;
    const double below =
        IsWhole(option) ? lower - 1 : std::nextafter(lower, -1e9);
    const double lower_still = lower - 2;
    ExpectRefused(command, option, option.name,
                  fmt::format("{}", below == also ? lower_still : below));
    if (std::isfinite(upper)) {
      const double above =
          IsWhole(option) ? upper + 1 : std::nextafter(upper, 1e30);
      ExpectRefused(command, option, option.name, fmt::format("{}", above));
    }
  });
}

TEST_F(NumberRangesTest, TheirEndsAreTaken) {
  ForEachNumber([](const CommandOptions& command, const Option& option) {
    const auto& [lower, upper, also, word] = *option.range;
    std::vector<double> ends = {lower};
    if (std::isfinite(upper)) {
      ends.push_back(upper);
    }
    if (also) {
      ends.push_back(*also);
    }
    for (const double end : ends) {
      ParseArguments(command, {"--" + option.name, fmt::format("{}", end)});
      EXPECT_EQ(NumberOf(option), end);
    }
  });
}

TEST_F(NumberRangesTest, HoldForOtherNames) {
  for (const CommandOptions::Alias& alias : commands_[0].Aliases()) {
    for (const Option& option : commands_[0].Options()) {
      if (option.name == alias.option && option.range) {
        ExpectRefused(commands_[0], option, alias.name, "inf");
      }
    }
  }
}

TEST_F(NumberRangesTest, StandInTheHelp) {
  ForEachNumber([](const CommandOptions& command, const Option& option) {
    std::ostringstream help;
    PrintHelp(command, "", help);
    const std::string value =
        option.name.ends_with("potts_weight") ? "2.197" : option.default_value;
    EXPECT_TRUE(Has(help.str(), fmt::format("  --{} (={}; {})\n", option.name,
                                            value, option.range->Text())));
  });
}

TEST(NumberRange, SaysWhatItHas) {
  EXPECT_EQ((NumberRange{0, 1}).Text(), "0 ... 1");
  EXPECT_EQ((NumberRange{1e-6, 1e6}).Text(), "1e-06 ... 1000000");
  EXPECT_EQ((NumberRange{1, kNoLimit, -1}).Text(), "1 or more, or -1");
  EXPECT_EQ((NumberRange{0, 1, -1, "auto"}).Text(), "0 ... 1, or auto");
  EXPECT_TRUE((NumberRange{1, kNoLimit, -1}).Contains(1e300));
  EXPECT_FALSE((NumberRange{1, kNoLimit, -1}).Contains(kNoLimit));
}

// The options of a command line.
template <typename Options, typename Add>
Options Parse(const Add& add, const std::vector<std::string>& arguments) {
  Options options;
  CommandOptions command;
  add(&command, &options);
  ParseArguments(command, arguments);
  return options;
}

RefinerOptions ParseRefiner(const std::vector<std::string>& arguments) {
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
  EXPECT_LT(low.refinement.levels, high.refinement.levels);
  EXPECT_LT(low.refinement.iterations, high.refinement.iterations);
  EXPECT_GT(extreme.refinement.labeling.final_pairs_per_facet,
            high.refinement.labeling.final_pairs_per_facet);
  double before = 1000;
  for (const char* quality : {"low", "medium", "high", "extreme"}) {
    const double distance =
        Parse<MesherOptions>(AddMesherOptions, {"--quality", quality})
            .meshing.thinning.max_proj_dist;
    EXPECT_LT(distance, before);
    before = distance;
  }
}

TEST(Presets, GiveWayToWhatIsGivenBesides) {
  const RefinerOptions options = ParseRefiner(
      {"--FacetwiseRefinement.image_scale", "0.8", "--quality", "low"});
  EXPECT_EQ(options.image_scale, 0.8);
}

}  // namespace colmap_ext::parse_options_test
