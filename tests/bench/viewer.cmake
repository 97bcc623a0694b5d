# Included by tests/bench/CMakeLists.txt. What a frame of ringdown-viewer costs.
if(NOT TARGET ringdown-viewer)
  return()
endif()
find_package(CLI11 REQUIRED)
pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)
add_executable(ringdown_viewer_bench viewer_bench.cpp machine.cpp)
target_link_libraries(ringdown_viewer_bench PRIVATE ringdown_viewer_window ringdown_test_display PkgConfig::EPOXY
                      CLI11::CLI11)
target_compile_definitions(ringdown_viewer_bench PRIVATE RINGDOWN_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
set_target_properties(ringdown_viewer_bench PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/bench)
