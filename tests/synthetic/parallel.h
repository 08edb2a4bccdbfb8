#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace colmap_ext::synthetic {

// Calls body(i) once for each i in [0, num_items), in any order, from up to
// num_threads threads (all of the machine's where it is not positive). What the
// bodies write must not depend on that order.
// \pre body does not throw
template <typename Body>
void ParallelFor(size_t num_items, int num_threads, const Body& body) {
  const size_t hardware = std::max(1u, std::thread::hardware_concurrency());
  const size_t wanted = num_threads > 0 ? num_threads : hardware;
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (size_t i = next++; i < num_items; i = next++) {
      body(i);
    }
  };
  std::vector<std::thread> helpers;
  for (size_t t = 1; t < std::min(wanted, num_items); ++t) {
    helpers.emplace_back(work);
  }
  work();
  for (std::thread& helper : helpers) {
    helper.join();
  }
}

}  // namespace colmap_ext::synthetic
