# Included by tests/bench/CMakeLists.txt. A program with a main of its own: its peers are other programs.
find_package(CLI11 REQUIRED)
add_executable(ringdown_mixer_bench mixer_bench.cpp machine.cpp promise.cpp mixer/accuracy.cpp mixer/budget.cpp mixer/costs.cpp mixer/directions.cpp mixer/fields.cpp
               mixer/faust.cpp mixer/growth.cpp mixer/kernels.cpp mixer/klank.cpp mixer/library.cpp mixer/nonlinear.cpp mixer/promises.cpp mixer/row.cpp
               mixer/sharing.cpp mixer/stage.cpp
               mixer/supercollider_files.cpp mixer/throughput.cpp mixer/timing.cpp mixer/two_way.cpp)
target_link_libraries(ringdown_mixer_bench PRIVATE ringdown_options ringdown_shared ringdown_session ringdown_synth ringdown_test_support CLI11::CLI11
                      ${CMAKE_DL_LIBS})
target_compile_definitions(ringdown_mixer_bench PRIVATE RINGDOWN_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
set_source_files_properties(mixer/kernels.cpp PROPERTIES COMPILE_OPTIONS "-O3;-march=native" SKIP_PRECOMPILE_HEADERS ON)
set_target_properties(ringdown_mixer_bench PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/bench)
