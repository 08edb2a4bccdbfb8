// Squares of kTileWidth x kTileHeight pixels of image i that hold what a pair
// needs: pixels that may show its facets, and those that their windows reach.

layout(std430, binding = 5) buffer Tiles {
  uint num_tiles;       // The first three are numbers of workgroups.
  uint one_and_one[2];
  uint unused;
  uint tiles[];         // in no order
};

uniform int num_tile_columns;

// The pixel of a thread; one workgroup works on a tile.
ivec2 TilePixel() {
  int tile = int(tiles[gl_WorkGroupID.x]);
  ivec2 corner = ivec2(tile % num_tile_columns, tile / num_tile_columns) *
                 ivec2(kTileWidth, kTileHeight);
  return corner + ivec2(gl_LocalInvocationID.xy);
}
