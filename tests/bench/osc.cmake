# A flood of OSC, for a daemon that runs; and what it costs to find out what a message means.
find_package(CLI11 REQUIRED)
add_executable(ringdown_osc_bench osc_bench.cpp)
target_link_libraries(ringdown_osc_bench PRIVATE ringdown_options ringdown_osc ringdown_protocol)
add_executable(ringdown_routing_bench routing_bench.cpp promise.cpp)
target_link_libraries(ringdown_routing_bench PRIVATE ringdown_options ringdown_osc ringdown_session ringdown_test_signals
                      PkgConfig::LIBLO CLI11::CLI11)
set_target_properties(ringdown_osc_bench ringdown_routing_bench
                      PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/bench)
