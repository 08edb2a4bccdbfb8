#pragma once

namespace colmap_ext {

// Has memory of that size and above returned to the system when it is freed.
// Without this, glibc puts blocks of up to 32 MB between others on the heap,
// where they leave holes. Does nothing with other libraries.
void ReturnBlocksFrom(int num_bytes);

}  // namespace colmap_ext
