// Takes away from this process what a reader of somebody else's file does not need. [main, before other threads]
//
//   const SandboxState state = close_sandbox({folder_of_the_file});
//
// After the call the process and its threads can open files for reading only, and only the given ones; what was open
// before stays open, also for writing. It can start no program and no other process, reach no other process, make or
// remove no file, and use no network. Nothing undoes this. A refused call fails with EPERM or EACCES; a call of another
// architecture ends the process.
//
// Two parts of Linux do it. Landlock confines reading, by files and folders with all that lies in them; the
// rights of its first version (Linux 5.13) suffice. A seccomp filter does everything else, and does it without
// Landlock, too.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ringdown {

struct SandboxState {
  bool files = false;  // Landlock: only the given files can be read
  bool calls = false;  // seccomp: no programs, no network, no writing
};

// Each path is a file or a folder that exists; others are passed over. Fails (false in the state) where the kernel
// lacks a part, and where the process has other threads already, which Landlock would leave out.
SandboxState close_sandbox(const std::vector<std::filesystem::path>& readable);

// The state that close_sandbox() would reach here, found without closing anything.
SandboxState sandbox_of_kernel();

}  // namespace ringdown
