// The versions of the programs and of the file formats. A file states its version; a file without one has version 1.
// Every program reads the versions up to its own and refuses later ones with a sentence; the table in
// docs/reference/versions.md lists the changes of each version. protocol/defaults.h has the protocol's version,
// kProtocolVersion.
#pragma once

namespace ringdown {

extern const char* const kVersion;  // semantic version of the programs and the library, which CMakeLists.txt states

// The version since which bakes give the results of today. Banks carry it in the hash of their inputs, so raising it
// bakes every bank anew: raise it to the version to be released if the same inputs now give another bank, and only
// then.
inline constexpr const char* kBakesUnchangedSince = "0.1.0";

inline constexpr int kBankVersion = 1;      // `version` in extras.ringdown of a bank's modal model
inline constexpr int kTextFileVersion = 1;  // key `version` of settings, states, scenes, notes, objects, materials

}  // namespace ringdown
