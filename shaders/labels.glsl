// Which facets are labelled with the pair at hand: those with its stamp.

layout(std430, binding = 4) buffer LabelStamps { uint label_stamps[]; };

uniform uint stamp;

bool IsLabeled(uint facet) {
  return facet != kNone && label_stamps[facet] == stamp;
}
