// Of Dispatch() for a number of threads.
uint ThreadIndex() {
  uint row = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  return gl_GlobalInvocationID.y * row + gl_GlobalInvocationID.x;
}
