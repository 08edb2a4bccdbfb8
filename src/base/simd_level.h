#pragma once

namespace colmap_ext {

// Instructions that loops are compiled for. All of them round alike: nothing is
// contracted (cmake/CompilerFlags.cmake) and no sum is reordered.
enum class SimdLevel {
  kBaseline,  // what the compiler assumes of every processor
  kAvx2,      // vectors of 8 floats, x86-64
};

inline SimdLevel BestSimdLevel() {
#if defined(__x86_64__)
  static const bool has_avx2 = __builtin_cpu_supports("avx2");
  return has_avx2 ? SimdLevel::kAvx2 : SimdLevel::kBaseline;
#else
  return SimdLevel::kBaseline;
#endif
}

#if defined(__x86_64__)
template <typename Body>
__attribute__((target("avx2"))) void RunWithAvx2(const Body& body) {
  body();
}
#endif

// Calls body(), compiled for a level.
// \pre the processor has it; body is declared always_inline, and so is what it
//      calls
template <typename Body>
void RunAt(SimdLevel level, const Body& body) {
#if defined(__x86_64__)
  if (level == SimdLevel::kAvx2) {
    RunWithAvx2(body);
    return;
  }
#endif
  body();
}

}  // namespace colmap_ext
