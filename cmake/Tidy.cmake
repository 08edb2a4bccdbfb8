# colmap_ext_tidy: the sources of src/ and of the parts of the commands in few
# large batches, for clang-tidy, which spends its time on the headers of others.
# Never built.

set(sources "")
set(libs "")
foreach(folder IN ITEMS src colmap_ext)
  get_property(targets DIRECTORY ${folder} PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(type ${target} TYPE)
    if(type STREQUAL STATIC_LIBRARY)
      get_target_property(target_sources ${target} SOURCES)
      get_target_property(target_libs ${target} LINK_LIBRARIES)
      list(APPEND sources ${target_sources})
      list(APPEND libs ${target} ${target_libs})
    endif()
  endforeach()
endforeach()
list(FILTER sources INCLUDE REGEX "^${PROJECT_SOURCE_DIR}/(src|colmap_ext)/")
list(REMOVE_DUPLICATES libs)

add_library(colmap_ext_tidy OBJECT EXCLUDE_FROM_ALL ${sources})
target_link_libraries(colmap_ext_tidy PRIVATE ${libs})
set_target_properties(colmap_ext_tidy PROPERTIES
  UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 40)
