// The program is in program.cpp, where it shares the daemon's headers, which take seconds to compile.
#include "server/program.h"

int main(int argc, char** argv) { return ringdown::server::run_program(argc, argv); }
