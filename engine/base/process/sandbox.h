// Takes away from this process all rights that a reader of untrusted files does not need. [main, before other threads]
//
//   const SandboxState state = close_sandbox({folder_of_the_file});
//
// After the call the process and its threads can open files for reading only, and only the given ones; files opened
// before stay open, also for writing. The process cannot start programs or processes, reach other processes, create or
// remove files, or use the network. The restrictions are permanent. A refused call fails with EPERM or EACCES; a call
// of another architecture ends the process.
//
// Two parts of Linux enforce this. Landlock restricts reading to the given files and folders with their contents; its
// first version (Linux 5.13) suffices. A seccomp filter enforces everything else, also where Landlock is missing.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace ringdown {

struct SandboxState {
  bool files = false;  // Landlock: only the given files can be read
  bool calls = false;  // seccomp: no programs, no network, no writing
};

// Closes the sandbox. Paths of files and folders that do not exist are ignored. A member of the result is false if the
// kernel lacks that part, or if the process already has other threads, which Landlock would not restrict.
SandboxState close_sandbox(const std::vector<std::filesystem::path>& readable);

// Returns the state that close_sandbox() would reach on this kernel, without closing anything.
SandboxState sandbox_of_kernel();

}  // namespace ringdown
