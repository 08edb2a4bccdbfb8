#include <array>
#include <cmath>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "colmap_ext/errors.h"
#include "colmap_ext/options/evaluation_options.h"
#include "colmap_ext/options/meshing_options.h"
#include "colmap_ext/options/parse_options.h"
#include "colmap_ext/options/refinement_options.h"
#include "colmap_ext/options/viewer_options.h"
#include "tests/formats/test_files.h"
#include "tests/texts.h"

namespace colmap_ext {
namespace number_ranges_test {

// All options of all commands.
class NumberRangesTest : public testing::Test {
 protected:
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

  static void Parse(const CommandOptions& command,
                    const std::vector<std::string>& arguments) {
    std::vector<const char*> argv = {"program"};
    for (const std::string& argument : arguments) {
      argv.push_back(argument.c_str());
    }
    ParseOptions(static_cast<int>(argv.size()), argv.data(), command);
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
      EXPECT_TRUE(
          HasAll(MessageOf<OptionError>([&] { Parse(command, arguments); }),
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
      Parse(command, {"--" + option.name, fmt::format("{}", end)});
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
    const std::string line = fmt::format("  --{} (={}; {})\n", option.name,
                                         value, option.range->Text());
    EXPECT_TRUE(Has(help.str(), line));
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

}  // namespace number_ranges_test
}  // namespace colmap_ext
