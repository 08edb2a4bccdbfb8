#include "colmap_ext/options/words.h"

#include "formats/errors.h"

namespace colmap_ext {

bool IsSecondWord(const char* option, const std::string& word,
                  const char* first, const char* second) {
  if (word != first && word != second) {
    throw OptionError(std::string(option) + " is '" + word +
                      "'; it has to be " + first + " or " + second);
  }
  return word == second;
}

void CheckNumThreads(int num_threads) {
  if (num_threads != -1 && num_threads <= 0) {
    throw OptionError("num_threads must be positive, or -1 for all threads");
  }
}

}  // namespace colmap_ext
