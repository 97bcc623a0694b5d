#include "engine/base/folders.h"

#include <cstdlib>
#include <system_error>

namespace ringdown {

Result<std::filesystem::path> preset_folder() {
  std::error_code error;
  if (const char* chosen = std::getenv("RINGDOWN_PRESETS")) {
    if (std::filesystem::is_directory(chosen, error)) return chosen;
    return fail(ErrorKind::refused, "RINGDOWN_PRESETS is " + std::string(chosen) + ", which is not a folder");
  }
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path installed = program.parent_path().parent_path() / "share/ringdown/presets";
  for (const std::filesystem::path& folder : {installed, std::filesystem::path(RINGDOWN_SOURCE_PRESETS)}) {
    if (std::filesystem::is_directory(folder, error)) return folder;
  }
  return fail(ErrorKind::refused, "the presets are neither in " + installed.string() +
                                      " nor in " RINGDOWN_SOURCE_PRESETS "; set RINGDOWN_PRESETS to their folder");
}

Result<std::filesystem::path> material_folder(const std::filesystem::path& given) {
  if (!given.empty()) return given;
  return preset_folder().map([](const std::filesystem::path& presets) { return presets / "materials"; });
}

PrivateFolder::PrivateFolder(const std::string& name) {
  std::error_code error;
  std::string path = (std::filesystem::temp_directory_path(error) / (name + "-XXXXXX")).string();
  if (!error && ::mkdtemp(path.data()) != nullptr) path_ = path;
}

PrivateFolder::~PrivateFolder() {
  std::error_code ignored;
  if (!kept_ && !path_.empty()) std::filesystem::remove_all(path_, ignored);
}

}  // namespace ringdown
