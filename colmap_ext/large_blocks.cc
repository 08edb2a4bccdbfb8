#include "colmap_ext/large_blocks.h"

#include <malloc.h>

namespace colmap_ext {

void ReturnBlocksFrom([[maybe_unused]] int num_bytes) {
#ifdef M_MMAP_THRESHOLD
  mallopt(M_MMAP_THRESHOLD, num_bytes);
#endif
}

}  // namespace colmap_ext
