#include "engine/mesh/gmsh_session.h"

#include <gmsh.h>

#include <algorithm>
#include <vector>

namespace ringdown::mesh {
namespace {

std::mutex& only_one() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

GmshSession::GmshSession() : lock_(only_one()) {
  gmsh::initialize(0, nullptr, false);
  gmsh::option::setNumber("General.Terminal", 0);
  gmsh::option::setNumber("General.NumThreads", 1);
  gmsh::option::setNumber("General.AbortOnError", 0);  // an exception through its parser spoils the next file
  gmsh::logger::start();
}

GmshSession::~GmshSession() {
  gmsh::logger::stop();  // or the next session finds this one's errors
  gmsh::finalize();
}

std::optional<std::string> GmshSession::first_error() const {
  std::vector<std::string> log;
  gmsh::logger::get(log);
  for (const std::string& line : log) {
    if (line.starts_with("Error")) return line.substr(std::min(line.find(": ") + 2, line.size()));
  }
  return std::nullopt;
}

}  // namespace ringdown::mesh
