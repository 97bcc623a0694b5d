// The verbs of the `ringdown` program: those that talk to a daemon in daemon_verbs.cpp, short ones in main.cpp, every
// other one in NAME_verb.cpp. [main]
//
// add_NAME_verb adds a subcommand and its options to `app`. If the user gave that verb, its callback does the work and
// sets `outcome`, which must outlive the parsing. A verb that fails has written the reason to stderr with complain().
#pragma once

#include "engine/base/vec3.h"
#include "protocol/exit_codes.h"

#include <cstdio>
#include <string>

namespace ringdown::manual {
class App;
}

namespace ringdown::cli {

using protocol::complain;
using protocol::ExitCode;

// Reads an option's value X,Y,Z, which manual::any_vector() has checked.
inline Vec3 vector_of(const std::string& text) {
  Vec3 v;
  std::sscanf(text.c_str(), "%lf,%lf,%lf", &v.x, &v.y, &v.z);
  return v;
}

void add_strike_verb(manual::App& app, ExitCode& outcome);     // rings an object in a running daemon
void add_send_verb(manual::App& app, ExitCode& outcome);       // any other message of the protocol
void add_info_verb(manual::App& app, ExitCode& outcome);       // the modes of a bank as a table
void add_materials_verb(manual::App& app, ExitCode& outcome);  // the materials, and a bar of each
void add_scale_verb(manual::App& app, ExitCode& outcome);      // a bank in another size and material
void add_export_verb(manual::App& app, ExitCode& outcome);     // a bank as samples for a sampler
void add_scene_verb(manual::App& app, ExitCode& outcome);      // a scene as glTF
void add_foley_verb(manual::App& app, ExitCode& outcome);      // an animation to its sound
void add_render_verb(manual::App& app, ExitCode& outcome);     // a scene or a score to a sound file

}  // namespace ringdown::cli
