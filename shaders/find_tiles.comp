#version 450 core

// Stamps a pair's facets, and lists the tiles that they need.

layout(local_size_x = kGroupSize) in;

#include "thread_index.glsl"
#include "facet_box.glsl"
#include "labels.glsl"
#include "tiles.glsl"

layout(std430, binding = 6) buffer TileStamps { uint tile_stamps[]; };

void main() {
  uint thread = ThreadIndex();
  if (thread >= num_facets) {
    return;
  }
  uint facet = chosen_facets[first_facet + thread];
  label_stamps[facet] = stamp;
  ivec4 box = FacetBox(facet);
  if (box.z < box.x || box.w < box.y) {
    return;
  }
  ivec2 tile_size = ivec2(kTileWidth, kTileHeight);
  ivec2 first = max(box.xy - kWindowRadius, 0) / tile_size;
  ivec2 last = min(box.zw + kWindowRadius, size_i - 1) / tile_size;
  for (int row = first.y; row <= last.y; ++row) {
    for (int column = first.x; column <= last.x; ++column) {
      uint tile = uint(row * num_tile_columns + column);
      if (atomicExchange(tile_stamps[tile], stamp) != stamp) {
        tiles[atomicAdd(num_tiles, 1u)] = tile;
      }
    }
  }
}
