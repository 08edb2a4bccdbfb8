#include "tests/colmap_ext/page_of_run.h"

#include <sstream>

#include <gtest/gtest.h>

#include "colmap_ext/report/html_page.h"
#include "tests/report/well_formed.h"

namespace colmap_ext {

void ExpectPageOfRun(const std::string& page, const Outcome& outcome) {
  EXPECT_EQ(XmlDefect(page), "");
  // With a colon, which pictures in base 64 do not have.
  for (const char* text : {"http:", "https:", "url(", "<link", "<script"}) {
    EXPECT_EQ(page.find(text), std::string::npos) << text;
  }
  EXPECT_LT(page.size(), 10'000'000);
  size_t num_rows = 0;
  std::istringstream lines(outcome.out);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  ")) {
      continue;
    }
    ++num_rows;
    std::istringstream words(line);
    for (std::string word; words >> word;) {
      EXPECT_NE(page.find(EscapeHtml(word)), std::string::npos) << line;
    }
  }
  EXPECT_GT(num_rows, 20);
}

size_t NumPictures(const std::string& page) {
  size_t count = 0;
  for (size_t at = page.find("<img "); at != std::string::npos;
       at = page.find("<img ", at + 1)) {
    ++count;
  }
  return count;
}

}  // namespace colmap_ext
