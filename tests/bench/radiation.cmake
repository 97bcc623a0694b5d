# Included by tests/bench/CMakeLists.txt.
ringdown_bench(ringdown_radiation_bench SOURCES radiation_bench.cpp LINK ringdown_radiate)
