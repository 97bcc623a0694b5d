# A flood of OSC, for a daemon that runs.
add_executable(ringdown_osc_bench osc_bench.cpp)
target_link_libraries(ringdown_osc_bench PRIVATE ringdown_options ringdown_osc ringdown_protocol)
set_target_properties(ringdown_osc_bench PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/bench)
