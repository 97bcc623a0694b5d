#include "engine/base/preset_folder.h"

#include <cstdlib>

namespace ringdown {

Result<std::filesystem::path> preset_folder() {
  std::error_code error;
  if (const char* chosen = std::getenv("RINGDOWN_PRESETS")) {
    if (std::filesystem::is_directory(chosen, error)) return chosen;
    return fail(ErrorKind::bad_input, "RINGDOWN_PRESETS is " + std::string(chosen) + ", which is not a folder");
  }
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path installed = program.parent_path().parent_path() / "share/ringdown/presets";
  for (const std::filesystem::path& folder : {installed, std::filesystem::path(RINGDOWN_SOURCE_PRESETS)}) {
    if (std::filesystem::is_directory(folder, error)) return folder;
  }
  return fail(ErrorKind::refused, "the presets are neither in " + installed.string() +
                                      " nor in " RINGDOWN_SOURCE_PRESETS "; set RINGDOWN_PRESETS to their folder");
}

}  // namespace ringdown
