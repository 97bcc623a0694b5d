# Included by tests/bench/CMakeLists.txt.
ringdown_bench(ringdown_bake_bench SOURCES bake_bench.cpp LINK ringdown_presets ringdown_body_maker)
target_compile_definitions(ringdown_bake_bench PRIVATE RINGDOWN_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
