#version 450 core

flat in uint index;

layout(location = 0) out uint facet;

void main() { facet = index; }
