#pragma once

#include <cstring>
#include <memory>
#include <vector>

#include "base/byte_store.h"

namespace colmap_ext {

// A store that is held after all.
class MemoryStore : public ByteStore {
 public:
  void Append(const void* bytes, size_t num_bytes) override {
    const char* from = static_cast<const char*>(bytes);
    bytes_.insert(bytes_.end(), from, from + num_bytes);
  }

  void Read(uint64_t offset, size_t num_bytes, void* bytes) const override {
    if (num_bytes > 0) {
      std::memcpy(bytes, bytes_.data() + offset, num_bytes);
    }
  }

  void Overwrite(uint64_t offset, const void* bytes,
                 size_t num_bytes) override {
    std::memcpy(bytes_.data() + offset, bytes, num_bytes);
  }

 private:
  std::vector<char> bytes_;
};

inline std::unique_ptr<ByteStore> MakeMemoryStore() {
  return std::make_unique<MemoryStore>();
}

}  // namespace colmap_ext
