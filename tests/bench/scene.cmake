# Included by tests/bench/CMakeLists.txt.
ringdown_bench(ringdown_scene_bench SOURCES scene_bench.cpp LINK ringdown_scene)
