#pragma once

#include <malloc.h>

namespace colmap_ext {

// Has glibc keep what is freed for the next allocation: blocks of less than
// 16 MB, and up to 32 MB at the end of the heap. The system clears what it gets
// back. Larger blocks go back to it: between others they would leave holes.
inline void KeepFreedMemory() {
#ifdef M_TRIM_THRESHOLD
  mallopt(M_MMAP_THRESHOLD, 1 << 24);
  mallopt(M_TRIM_THRESHOLD, 1 << 25);
#endif
}

// Returns freed memory to the system, holes of the heap included. Call it
// before a stage that needs much memory.
inline void ReturnFreedMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace colmap_ext
