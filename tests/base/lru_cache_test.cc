#include "base/lru_cache.h"

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace colmap_ext::lru_cache_test {

constexpr size_t kSize = 10;  // of a value, bytes

// A cache of the keys themselves, which counts how often each is loaded.
struct Cache : LruCache<const size_t> {
  using LruCache::LruCache;

  std::shared_ptr<const size_t> Load(size_t key) {
    return Get(key, kSize, [&] {
      ++num_loads[key];
      return std::make_shared<const size_t>(key);
    });
  }

  std::vector<int> num_loads = {0, 0, 0};
};

TEST(LruCache, LoadsOnceWhereThereIsRoomAndAgainAfterClear) {
  Cache cache(3 * kSize);
  for (const size_t key : {0, 1, 2, 1, 0, 2, 2}) {
    EXPECT_EQ(*cache.Load(key), key);
  }
  EXPECT_EQ(cache.num_loads, std::vector({1, 1, 1}));
  EXPECT_EQ(cache.NumBytes(), 3 * kSize);
  cache.Clear();
  EXPECT_EQ(cache.NumBytes(), 0u);
  cache.Load(0);
  EXPECT_EQ(cache.num_loads[0], 2);
}

TEST(LruCache, DropsWhatWasNotUsedForTheLongestTime) {
  Cache cache(2 * kSize);
  for (const size_t key : {0, 1, 0, 2, 0}) {
    cache.Load(key);
  }
  EXPECT_EQ(cache.num_loads, std::vector({1, 1, 1}));
  cache.Load(1);
  EXPECT_EQ(cache.num_loads, std::vector({1, 2, 1}));
  cache.Load(0);
  cache.Load(2);
  EXPECT_EQ(cache.num_loads, std::vector({1, 2, 2}));
}

TEST(LruCache, KeepsTheLastWhateverItTakes) {
  Cache cache(0);
  for (const size_t key : {0, 0, 1, 1, 0}) {
    cache.Load(key);
    EXPECT_EQ(cache.NumBytes(), kSize);
  }
  EXPECT_EQ(cache.num_loads, std::vector({2, 1, 0}));
}

TEST(LruCache, WhatIsInUseLivesOn) {
  Cache cache(0);
  const auto value = cache.Load(0);
  const std::weak_ptr<const size_t> dropped = cache.Load(1);
  cache.Clear();
  EXPECT_EQ(*value, 0u);
  EXPECT_TRUE(dropped.expired());
}

TEST(LruCache, MakesRoomBeforeItLoads) {
  Cache cache(kSize);
  const std::weak_ptr<const size_t> first = cache.Load(0);
  EXPECT_FALSE(first.expired());
  cache.Get(1, kSize, [&] {
    EXPECT_TRUE(first.expired());
    return std::make_shared<const size_t>(1);
  });
}

TEST(LruCache, ALowerBoundDropsAtOnce) {
  Cache cache(3 * kSize);
  for (const size_t key : {0, 1, 2}) {
    cache.Load(key);
  }
  cache.SetMaxBytes(2 * kSize);
  EXPECT_EQ(cache.NumBytes(), 2 * kSize);
  cache.Load(1);
  cache.Load(2);
  EXPECT_EQ(cache.num_loads, std::vector({1, 1, 1}));
}

TEST(LruCache, FailuresLeaveNothingBehind) {
  Cache cache(kSize);
  const auto fail = []() -> std::shared_ptr<const size_t> {
    throw std::runtime_error("no such file");
  };
  EXPECT_THROW(cache.Get(0, kSize, fail), std::runtime_error);
  EXPECT_EQ(cache.NumBytes(), 0u);
  EXPECT_EQ(*cache.Load(0), 0u);
  EXPECT_EQ(cache.num_loads[0], 1);
}

// A load that goes on until it is told to end.
class SlowLoad {
 public:
  // Waits in load() for Finish(). \param fails  whether it throws then.
  explicit SlowLoad(Cache* cache, size_t key, bool fails = false)
      : thread_([this, cache, key, fails] {
          try {
            value_ = cache->Get(key, kSize, [&] {
              has_begun_.set_value();
              end_.get_future().wait();
              if (fails) {
                throw std::runtime_error("no such file");
              }
              return std::make_shared<const size_t>(key);
            });
          } catch (const std::runtime_error&) {
            has_thrown_ = true;
          }
        }) {
    has_begun_.get_future().wait();
  }

  std::shared_ptr<const size_t> Finish() {
    end_.set_value();
    thread_.join();
    return value_;
  }

  bool HasThrown() const { return has_thrown_; }

 private:
  std::promise<void> has_begun_;
  std::promise<void> end_;
  std::shared_ptr<const size_t> value_;
  bool has_thrown_ = false;
  std::thread thread_;  // Last: it uses the others.
};

// Would time out if loads held the lock.
TEST(LruCache, OtherKeysAreLoadedMeanwhile) {
  Cache cache(2 * kSize);
  SlowLoad first(&cache, 0);
  EXPECT_EQ(*cache.Load(1), 1u);
  EXPECT_EQ(*cache.Load(1), 1u);
  EXPECT_EQ(cache.num_loads[1], 1);
  first.Finish();
}

// A second load would begin at once; that there is none shows in a while.
TEST(LruCache, ThreadsThatMissTheSameKeyLoadItOnce) {
  constexpr auto kWhile = std::chrono::milliseconds(50);
  for (const size_t max_bytes : {size_t{0}, kSize, 5 * kSize}) {
    Cache cache(max_bytes);
    std::promise<void> second_load;
    std::shared_ptr<const size_t> value;
    SlowLoad first(&cache, 0);
    std::thread second([&] {
      value = cache.Get(0, kSize, [&] {
        second_load.set_value();
        return std::make_shared<const size_t>(0);
      });
    });
    // The load that goes on is not dropped for another one either.
    cache.Get(1, kSize, [] { return std::make_shared<const size_t>(1); });
    EXPECT_EQ(second_load.get_future().wait_for(kWhile),
              std::future_status::timeout);
    const auto expected = first.Finish();
    second.join();
    EXPECT_EQ(value, expected);
    EXPECT_LE(cache.NumBytes(), std::max(max_bytes, kSize));
    EXPECT_EQ(cache.NumBytes() / kSize, max_bytes > kSize ? 2 : 1);
  }
}

TEST(LruCache, FailuresReachAllWhoWait) {
  Cache cache(kSize);
  SlowLoad first(&cache, 0, true);
  std::atomic<bool> has_asked = false;
  int num_loads = 0;
  bool has_thrown = false;
  std::thread second([&] {
    has_asked = true;
    try {
      cache.Get(0, kSize, [&] {
        ++num_loads;
        return std::make_shared<const size_t>(7);
      });
    } catch (const std::runtime_error&) {
      has_thrown = true;
    }
  });
  while (!has_asked) {
    std::this_thread::yield();
  }
  first.Finish();
  second.join();
  EXPECT_TRUE(first.HasThrown());
  // One that came too late for the failure loads by itself.
  EXPECT_NE(has_thrown, num_loads == 1);
  EXPECT_EQ(cache.NumBytes(), num_loads * kSize);
}

TEST(LruCache, WhatIsClearedWhileItIsLoadedIsNotKept) {
  Cache cache(kSize);
  SlowLoad first(&cache, 0);
  cache.Clear();
  EXPECT_EQ(*cache.Load(0), 0u);
  EXPECT_EQ(cache.num_loads[0], 1);
  EXPECT_EQ(*first.Finish(), 0u);
  EXPECT_EQ(cache.NumBytes(), kSize);
  cache.Load(0);
  EXPECT_EQ(cache.num_loads[0], 1);
}

TEST(LruCache, ManyThreadsGetTheRightValues) {
  for (const size_t num_kept : {1, 3, 8}) {
    Cache cache(num_kept * kSize);
    std::atomic<int> num_wrong = 0;
    std::vector<std::thread> threads;
    for (size_t t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        for (size_t i = 0; i < 2000; ++i) {
          const size_t key = (i * (t + 3)) % 8;
          num_wrong += *cache.Get(key, kSize, [key] {
            return std::make_shared<const size_t>(key);
          }) != key;
        }
      });
    }
    for (std::thread& thread : threads) {
      thread.join();
    }
    EXPECT_EQ(num_wrong, 0);
    EXPECT_LE(cache.NumBytes(), num_kept * kSize);
  }
}

}  // namespace colmap_ext::lru_cache_test
