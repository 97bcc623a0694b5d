// What there is to load: scenes and banks below the folders that files may be opened in. [worker]
//
// Scenes are the .toml files of folders called `scenes`, banks all .glb files. Neither is opened: what cannot be read
// is refused when it is loaded. Links are not followed, and hidden folders are left out.
#pragma once

#include "protocol/reply.h"
#include "server/session/file_roots.h"

#include <cstddef>
#include <vector>

namespace ringdown::server {

inline constexpr std::size_t kMaxBrowsed = 1024;    // files in one answer
inline constexpr std::size_t kMaxLookedAt = 16384;  // files and folders below one root that are looked at
inline constexpr int kMaxBrowseDepth = 4;           // folders below a root

// Scenes first, each kind by path; numbered from 0. A path below the current folder is relative to that, others are
// absolute.
std::vector<protocol::BrowseFile> browse(const session::FileRoots& roots);

}  // namespace ringdown::server
