// Lists the files that can be loaded: scenes and banks below the folders in which files may be opened. [worker]
//
// Scenes are the .toml files in folders called `scenes`; banks are all .glb files. No file is opened: a file that
// cannot be read is refused when it is loaded. Links are not followed, and hidden folders are left out.
#pragma once

#include "engine/base/result.h"
#include "protocol/reply.h"
#include "server/session/file_roots.h"

#include <cstddef>
#include <vector>

namespace ringdown::server {

inline constexpr std::size_t kMaxBrowsed = 1024;    // files in one answer
inline constexpr std::size_t kMaxLookedAt = 16384;  // files and folders visited below one root
inline constexpr int kMaxBrowseDepth = 4;           // folders below a root

// Returns scenes first, then banks, each sorted by path; numbered from 0. A path below the current folder is relative
// to it; other paths are absolute. Fails if the system cannot read folders, for lack of file descriptors or because of
// a disk fault; a folder that is gone or may not be read counts as empty.
Result<std::vector<protocol::BrowseFile>> browse(const session::FileRoots& roots);

}  // namespace ringdown::server
