# Included by tests/bench/CMakeLists.txt. A program with a main of its own: it measures in processes.
find_package(CLI11 REQUIRED)
find_path(SPECTRA_INCLUDE_DIR Spectra/SymGEigsShiftSolver.h REQUIRED)
find_path(CHOLMOD_INCLUDE_DIR cholmod.h PATH_SUFFIXES suitesparse REQUIRED)
find_library(CHOLMOD_LIBRARY cholmod REQUIRED)
find_path(OPENBLAS_INCLUDE_DIR openblas_config.h PATH_SUFFIXES openblas openblas-pthread REQUIRED)
add_executable(ringdown_modal_bench modal_bench.cpp machine.cpp promise.cpp
               ../bake/amplitude_error.cpp ../bake/bank_surface.cpp ../bake/curved_skin.cpp modal/amplitude.cpp modal/bodies.cpp modal/calculix.cpp
               modal/measurement.cpp modal/methods.cpp modal/plan.cpp modal/promises.cpp modal/spectra_cholmod.cpp)
target_link_libraries(ringdown_modal_bench PRIVATE ringdown_options ringdown_presets ringdown_body_maker ringdown_solve ${CHOLMOD_LIBRARY}
                      CLI11::CLI11)
target_include_directories(ringdown_modal_bench SYSTEM PRIVATE ${SPECTRA_INCLUDE_DIR} ${CHOLMOD_INCLUDE_DIR} ${OPENBLAS_INCLUDE_DIR})
target_compile_definitions(ringdown_modal_bench PRIVATE RINGDOWN_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
set_target_properties(ringdown_modal_bench PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/bench)
if(TARGET ringdown-modes-slepc)
  add_dependencies(ringdown_modal_bench ringdown-modes-slepc)
endif()
