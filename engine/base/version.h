// The versions of what is built and of what it reads and writes. A file says its version; one that says none has
// version 1. Every program reads the versions up to its own and refuses later ones with a sentence; the table in
// docs/reference/commands.md tells what each version changed. The protocol's is protocol/defaults.h: kProtocolVersion.
#pragma once

namespace ringdown {

inline constexpr const char* kVersion = RINGDOWN_VERSION;  // of the programs and the library: semantic versioning

inline constexpr int kBankVersion = 1;      // of banks: `version` in extras.ringdown of a modal model
inline constexpr int kTextFileVersion = 1;  // of settings, states, scenes, notes, objects, materials: key `version`

}  // namespace ringdown
