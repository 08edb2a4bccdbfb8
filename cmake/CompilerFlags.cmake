# colmap_ext_flags: how our own targets are compiled. Linked privately, so that
# nothing of it reaches COLMAP. No -march: Eigen's alignment is part of COLMAP's
# ABI.

add_library(colmap_ext_flags INTERFACE)
target_compile_features(colmap_ext_flags INTERFACE cxx_std_20)
target_compile_options(colmap_ext_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow
  $<$<BOOL:${COLMAP_EXT_WERROR}>:-Werror>
  # GCC 12 sees overlaps in std::string's operator+ (GCC bug 105329).
  $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
  # Same rounding with and without fused multiply-add: same mesh everywhere.
  -ffp-contract=off
  # Nothing asks for errno or the flags of exceptions; vectors have neither.
  -fno-math-errno -fno-trapping-math)

if(COLMAP_EXT_SANITIZE)
  target_compile_options(colmap_ext_flags INTERFACE
    -fsanitize=${COLMAP_EXT_SANITIZE} -fno-sanitize-recover=all
    -fno-omit-frame-pointer)
  target_link_options(colmap_ext_flags INTERFACE
    -fsanitize=${COLMAP_EXT_SANITIZE})
endif()

# Compiles a target's sources a batch at a time, which reads Eigen's and other
# headers once a batch. Names of anonymous namespaces are then shared by the
# sources of a target.
function(colmap_ext_compile_in_batches target)
  set_target_properties(${target} PROPERTIES
    UNITY_BUILD ${COLMAP_EXT_UNITY_BUILD}
    UNITY_BUILD_BATCH_SIZE 8)
  # What a source keeps to itself looks like a header's to GCC.
  target_compile_options(${target} PRIVATE
    $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()
