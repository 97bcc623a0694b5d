# Included by tests/bench/CMakeLists.txt. A program with a main of its own: it starts JACK servers and daemons.
find_package(CLI11 REQUIRED)
pkg_check_modules(JACK REQUIRED IMPORTED_TARGET jack)
add_executable(ringdown_deadline_bench deadline_bench.cpp deadline/jack_clock.cpp deadline/load.cpp deadline/reconnection.cpp
               deadline/times.cpp ../integration/daemon_fixture.cpp ../integration/jack_recorder.cpp
               ../integration/process.cpp ../support/pauses.cpp)
target_link_libraries(ringdown_deadline_bench PRIVATE ringdown_options ringdown_osc ringdown_protocol
                      ringdown_test_signals CLI11::CLI11 PkgConfig::JACK)
target_compile_definitions(ringdown_deadline_bench PRIVATE RINGDOWN_BIN_DIR="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
set_target_properties(ringdown_deadline_bench PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/bench)
add_dependencies(ringdown_deadline_bench ringdownd)
