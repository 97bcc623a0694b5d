// The table as text for people: docs/reference/protocol.md and the help of the `ringdown` program. [any thread]
#pragma once

#include "protocol/schema.h"

#include <string>

namespace ringdown::protocol {

// "/object/{object}/gain gain [ramp]"
std::string signature(const AddressSpec& spec);

// "How long the change takes. A number from 0 to 60 s; 0 if left out."
std::string describe(const ArgumentSpec& spec);

// All addresses, one signature and sentence each, for a terminal.
std::string overview();

// docs/reference/protocol.md, complete.
std::string markdown();

// The row's example as a shell command: "oscsend osc.udp://127.0.0.1:7770 /object/bell/gain ff 0.5 0.1". Empty for one
// that takes a blob, which oscsend cannot send.
std::string oscsend_command(const AddressSpec& spec);

}  // namespace ringdown::protocol
