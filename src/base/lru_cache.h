#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>

namespace colmap_ext {

// A cache of values by index, bounded by bytes: the least recently used values
// are dropped. A value that the caller holds stays valid when it is dropped.
// Thread-safe.
template <typename T>
class LruCache {
 public:
  // \param max_bytes  of the values that are kept. The one loaded last is kept
  //        whatever it takes.
  explicit LruCache(size_t max_bytes) : max_bytes_(max_bytes) {}

  // The value of a key. load() is called if the cache has none, without a lock;
  // threads that ask for the same key meanwhile wait for it. What load() throws
  // reaches all of them, and the key is without value again.
  // \param num_bytes  what the value takes; room is made before it is loaded.
  // \param load  returns a std::shared_ptr<T>.
  // \pre load() does not get the same key, nor runs tasks that do.
  template <typename Load>
  std::shared_ptr<T> Get(size_t key, size_t num_bytes, const Load& load) {
    std::promise<std::shared_ptr<T>> promise;
    uint64_t id = 0;
    {
      std::unique_lock lock(mutex_);
      const auto found = places_.find(key);
      if (found != places_.end()) {
        entries_.splice(entries_.begin(), entries_, found->second);
        const auto value = found->second->value;
        lock.unlock();
        return value.get();
      }
      MakeRoom(num_bytes, 0);
      id = ++last_id_;
      entries_.push_front(
          {key, id, num_bytes, promise.get_future().share(), false});
      places_[key] = entries_.begin();
      num_bytes_ += num_bytes;
    }
    try {
      std::shared_ptr<T> value = load();
      Finish(key, id, [&](Place place) {
        place->is_loaded = true;
        MakeRoom(0, id);
      });
      promise.set_value(value);
      return value;
    } catch (...) {
      Finish(key, id, [&](Place place) { Erase(place); });
      promise.set_exception(std::current_exception());
      throw;
    }
  }

  // Values that are being loaded reach those who wait for them, and are not
  // kept.
  void Clear() {
    const std::scoped_lock lock(mutex_);
    entries_.clear();
    places_.clear();
    num_bytes_ = 0;
  }

  void SetMaxBytes(size_t max_bytes) {
    const std::scoped_lock lock(mutex_);
    max_bytes_ = max_bytes;
    MakeRoom(0, 0);
  }

  // Of the values that are kept or being loaded.
  size_t NumBytes() const {
    const std::scoped_lock lock(mutex_);
    return num_bytes_;
  }

 private:
  struct Entry {
    size_t key;
    uint64_t id;  // the same key can be loaded again
    size_t num_bytes;
    std::shared_future<std::shared_ptr<T>> value;
    bool is_loaded;
  };
  using Place = typename std::list<Entry>::iterator;

  // Calls finish() with the entry of a load, if it is still in the cache, which
  // may have been cleared.
  template <typename Function>
  void Finish(size_t key, uint64_t id, const Function& finish) {
    const std::scoped_lock lock(mutex_);
    const auto found = places_.find(key);
    if (found != places_.end() && found->second->id == id) {
      finish(found->second);
    }
  }

  // Both of these: \pre the mutex is locked.

  // Drops what was not used for the longest time, but for what is being loaded,
  // and one entry.
  void MakeRoom(size_t num_bytes, uint64_t kept_id) {
    Place place = entries_.end();
    while (place != entries_.begin() && num_bytes_ + num_bytes > max_bytes_) {
      --place;
      if (place->is_loaded && place->id != kept_id) {
        place = Erase(place);
      }
    }
  }

  Place Erase(Place place) {
    num_bytes_ -= place->num_bytes;
    places_.erase(place->key);
    return entries_.erase(place);
  }

  mutable std::mutex mutex_;
  std::list<Entry> entries_;  // the last used first
  std::unordered_map<size_t, Place> places_;
  size_t max_bytes_;
  size_t num_bytes_ = 0;  // of the entries
  uint64_t last_id_ = 0;
};

}  // namespace colmap_ext
