// The verbs of the `ringdown` program, one file each: NAME_verb.cpp.
//
// add_NAME_verb adds a subcommand and its options to `app`. When the user gave that verb, its callback does the work
// and sets `outcome`, which must outlive the parsing; a verb that fails has said why on stderr with complain().
#pragma once

#include "protocol/exit_codes.h"

#include <string>
#include <string_view>

namespace CLI {
class App;
}

namespace ringdown::cli {

using protocol::ExitCode;

void add_strike_verb(CLI::App& app, ExitCode& outcome);     // rings an object in a running daemon
void add_send_verb(CLI::App& app, ExitCode& outcome);       // any other message of the protocol
void add_info_verb(CLI::App& app, ExitCode& outcome);       // the modes of a bank as a table
void add_materials_verb(CLI::App& app, ExitCode& outcome);  // the materials, and a bar of each
void add_scale_verb(CLI::App& app, ExitCode& outcome);      // a bank in another size and material
void add_protocol_verb(CLI::App& app, ExitCode& outcome);   // every address
void add_render_verb(CLI::App& app, ExitCode& outcome);     // a scene or a score to a sound file

// A verb that is a program of its own, ringdown-NAME, because it links what this one shall not.
void add_program_verb(CLI::App& app, ExitCode& outcome, const std::string& name, const std::string& sentence);

// "ringdown: SENTENCE" on stderr; returns `code`, so that a verb can write `outcome = complain(...)`.
ExitCode complain(std::string_view sentence, ExitCode code);

}  // namespace ringdown::cli
