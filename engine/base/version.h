// The versions of the programs and of the file formats. A file states its version; a file without one has version 1.
// Every program reads the versions up to its own and refuses later ones with a sentence; the table in
// docs/reference/versions.md lists the changes of each version. protocol/defaults.h has the protocol's version,
// kProtocolVersion.
#pragma once

namespace ringdown {

inline constexpr const char* kVersion = RINGDOWN_VERSION;  // semantic version of the programs and the library

inline constexpr int kBankVersion = 1;      // `version` in extras.ringdown of a bank's modal model
inline constexpr int kTextFileVersion = 1;  // key `version` of settings, states, scenes, notes, objects, materials

}  // namespace ringdown
