#include "remesh/speculation.h"

#include <array>
#include <numeric>
#include <optional>

#include <gtest/gtest.h>

#include "tests/random.h"

namespace colmap_ext {
namespace speculation_test {

// A ring of numbers. Each in turn grows by a sum of its neighbors unless that
// is a multiple of three, so that it matters what was done before.
class Ring {
 public:
  explicit Ring(uint32_t size) : values_(size) {
    std::iota(values_.begin(), values_.end(), 1);
  }

  struct Plan {
    uint32_t place;
    uint32_t value;
  };

  std::optional<Plan> Propose(uint32_t place) const {
    const auto [before, at, after] = Around(place);
    const uint32_t sum = values_[before] + 2 * values_[after] + values_[at];
    return sum % 3 != 0 ? std::optional<Plan>({place, sum + values_[at]})
                        : std::nullopt;
  }
  void Apply(const Plan& plan) { values_[plan.place] = plan.value; }

  std::array<uint32_t, 3> Around(uint32_t place) const {
    const auto size = static_cast<uint32_t>(values_.size());
    return {(place + size - 1) % size, place, (place + 1) % size};
  }

  const std::vector<uint32_t>& values() const { return values_; }

 private:
  std::vector<uint32_t> values_;
};

void ExpectSameAsOneByOne(const std::vector<uint32_t>& order, uint32_t size) {
  Ring expected(size);
  size_t num_expected = 0;
  for (const uint32_t place : order) {
    if (const auto plan = expected.Propose(place)) {
      expected.Apply(*plan);
      ++num_expected;
    }
  }
  Ring ring(size);
  ChangedVertices changed(size);
  const size_t num_applied = ApplyInOrder(
      order.size(), [&](size_t i) { return ring.Propose(order[i]); },
      [&](size_t i) { return ring.Around(order[i]); },
      [&](const Ring::Plan& plan) {
        ring.Apply(plan);
        changed.Mark(plan.place);
      },
      &changed);
  EXPECT_EQ(num_applied, num_expected);
  EXPECT_GT(num_applied, 0u);
  EXPECT_LT(num_applied, order.size());
  EXPECT_EQ(ring.values(), expected.values());
}

TEST(ApplyInOrder, DoesWhatOneByOneDoes) {
  constexpr uint32_t kSize = 3000;  // some batches
  std::vector<uint32_t> order(3 * kSize);
  for (uint32_t i = 0; i < order.size(); ++i) {
    order[i] = i % kSize;
  }
  ExpectSameAsOneByOne(order, kSize);  // neighbors one after the other
  Random random(1);
  random.Shuffle(&order);
  ExpectSameAsOneByOne(order, kSize);
}

TEST(ApplyInOrder, DoesNothingForNoItems) {
  ChangedVertices changed(0);
  EXPECT_EQ(ApplyInOrder(
                0, [](size_t i) { return std::optional<size_t>(i); },
                [](size_t) { return std::array<uint32_t, 1>{0}; },
                [](size_t) {}, &changed),
            0u);
}

}  // namespace speculation_test
}  // namespace colmap_ext
