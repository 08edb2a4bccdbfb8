#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace colmap_ext {

// Bytes that are held elsewhere, such as in a file.
class ByteStore {
 public:
  virtual ~ByteStore() = default;
  virtual void Append(const void* bytes, size_t num_bytes) = 0;
  // \pre the bytes are there
  virtual void Read(uint64_t offset, size_t num_bytes, void* bytes) const = 0;
  virtual void Overwrite(uint64_t offset, const void* bytes,
                         size_t num_bytes) = 0;
};

// Makes an empty one.
using MakeStore = std::function<std::unique_ptr<ByteStore>()>;

// A vector that is held in a store.
template <typename T>
class StoredVector {
 public:
  explicit StoredVector(const MakeStore& make_store) : store_(make_store()) {}

  size_t size() const { return size_; }

  void Append(const std::vector<T>& values) {
    store_->Append(values.data(), values.size() * sizeof(T));
    size_ += values.size();
  }

  // \pre begin <= end <= size()
  std::vector<T> Read(size_t begin, size_t end) const {
    std::vector<T> values(end - begin);
    store_->Read(begin * sizeof(T), values.size() * sizeof(T), values.data());
    return values;
  }

  // \pre i < size()
  void Set(size_t i, const T& value) {
    store_->Overwrite(i * sizeof(T), &value, sizeof(T));
  }

  // Calls function(values) for all values, some at a time.
  template <typename Function>
  void ForEachChunk(const Function& function) const {
    constexpr size_t kChunk = 1 << 16;
    for (size_t begin = 0; begin < size_; begin += kChunk) {
      function(Read(begin, std::min(begin + kChunk, size_)));
    }
  }

 private:
  std::unique_ptr<ByteStore> store_;
  size_t size_ = 0;
};

}  // namespace colmap_ext
