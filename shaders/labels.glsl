// Which facets are labelled with the pair at hand: those with its stamp.

layout(std430, binding = 4) buffer LabelStamps { uint label_stamps[]; };

uniform uint stamp;

const uint kNoFacet = 0xffffffffu;

bool IsLabeled(uint facet) {
  return facet != kNoFacet && label_stamps[facet] == stamp;
}
