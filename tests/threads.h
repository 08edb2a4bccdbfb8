#pragma once

#include <cstddef>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace colmap_ext {

// That a function returns the same with any number of threads.
template <typename Function>
void ExpectSameForAnyThreads(const Function& function) {
  const auto expected = function();
  for (const size_t num_threads : {1, 2, 7}) {
    const tbb::global_control control(
        tbb::global_control::max_allowed_parallelism, num_threads);
    EXPECT_TRUE(function() == expected) << num_threads;
  }
}

}  // namespace colmap_ext
