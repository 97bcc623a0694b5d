#include "engine/base/folders.h"

#include "engine/base/quote.h"

#include <array>
#include <cstdlib>
#include <set>
#include <system_error>

namespace ringdown {
namespace {

struct PresetShelf {
  const char *folder, *ending;
};

constexpr std::array<PresetShelf, 3> kShelves = {
    {{"banks", ".glb"}, {"notes", ".toml"}, {"scenes", ".toml"}}};  // by PresetKind

}  // namespace

Result<std::filesystem::path> preset_folder() {
  std::error_code error;
  if (const char* chosen = std::getenv("RINGDOWN_PRESETS")) {
    if (std::filesystem::is_directory(chosen, error)) return chosen;
    return fail(ErrorKind::refused, "RINGDOWN_PRESETS is {}, which is not a folder", chosen);
  }
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path installed = program.parent_path().parent_path() / "share/ringdown/presets";
  for (const std::filesystem::path& folder : {installed, std::filesystem::path(RINGDOWN_SOURCE_PRESETS)}) {
    if (std::filesystem::is_directory(folder, error)) return folder;
  }
  return fail(ErrorKind::refused, "the presets are not in {}; set RINGDOWN_PRESETS to their folder",
              installed.string());
}

Result<std::filesystem::path> material_folder(const std::filesystem::path& given) {
  if (!given.empty()) return given;
  return preset_folder().map([](const std::filesystem::path& presets) { return presets / "materials"; });
}

Result<std::filesystem::path> own_bank_folder() {
  const char* const data = std::getenv("XDG_DATA_HOME");
  const char* const home = std::getenv("HOME");
  std::filesystem::path folder;
  if (data && *data) {
    folder = data;
  } else if (home && *home) {
    folder = std::filesystem::path(home) / ".local" / "share";
  } else {
    return fail(ErrorKind::input_output, "there is no home folder for banks: HOME is not set");
  }
  folder = folder / "ringdown" / "banks";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) return fail(ErrorKind::input_output, "cannot make the folder {}: {}", folder.string(), error.message());
  return folder;
}

Result<std::filesystem::path> preset_or_file(const std::filesystem::path& given, PresetKind kind) {
  std::error_code error;
  if (given.has_parent_path() || given.has_extension() || std::filesystem::exists(given, error)) return given;
  const PresetShelf& shelf = kShelves.at(static_cast<std::size_t>(kind));
  const auto presets = preset_folder();
  if (!presets) return presets;
  const std::filesystem::path folder = *presets / shelf.folder;
  if (std::filesystem::path found = folder / (given.string() + shelf.ending); std::filesystem::exists(found, error)) {
    return found;
  }
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() == shelf.ending) names.insert(entry.path().stem().string());
  }
  std::string sentence = formatted("there is neither a file {} nor a preset of that name in {}, which has ",
                                   quote(given.string()), folder.string());
  for (const std::string& name : names) sentence += (name == *names.begin() ? "" : ", ") + name;
  return fail(ErrorKind::bad_input, sentence);
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
