# colmap_ext_opencv: OpenCV's core and imgproc alone. Its module that reads and
# writes pictures would load all of GDAL at every start. Debian's packages of
# single modules come without OpenCV's CMake files.
find_path(OPENCV_INCLUDE_DIR opencv2/imgproc.hpp PATH_SUFFIXES opencv4
          REQUIRED)
add_library(colmap_ext_opencv INTERFACE)
target_include_directories(colmap_ext_opencv SYSTEM INTERFACE
                           ${OPENCV_INCLUDE_DIR})
foreach(module core imgproc)
  find_library(OPENCV_${module}_LIBRARY opencv_${module} REQUIRED)
  target_link_libraries(colmap_ext_opencv INTERFACE
                        ${OPENCV_${module}_LIBRARY})
endforeach()
