# Included by tests/bench/CMakeLists.txt.
find_package(CLI11 REQUIRED)
add_executable(ringdown_radiation_bench radiation_bench.cpp ${PROJECT_SOURCE_DIR}/tests/radiate/surface_power.cpp)
target_link_libraries(ringdown_radiation_bench PRIVATE ringdown_options ringdown_radiate CLI11::CLI11)
set_target_properties(ringdown_radiation_bench
                      PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/bench)
