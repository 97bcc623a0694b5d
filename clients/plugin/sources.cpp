#include "clients/plugin/sources.h"

#include "engine/base/file_format.h"
#include "engine/base/folders.h"

#include <algorithm>
#include <cstdlib>
#include <system_error>
#include <vector>

namespace ringdown::plugin {
namespace {

constexpr int kMaxFoldersUp = 8;

std::filesystem::path environment_path(const char* name) {
  const char* const value = std::getenv(name);
  return value ? value : "";
}

std::filesystem::path own_file(std::size_t number) {
  const std::filesystem::path map = own_folder() / formatted("{}.toml", number);
  std::error_code ignored;
  return std::filesystem::exists(map, ignored) ? map : own_folder() / formatted("{}.glb", number);
}

struct Family {
  std::string_view name;
  std::vector<std::string_view> presets;
};
const std::vector<Family> kFamilies = {
    {"Bars",
     {"vibraphone", "vibraphone-key", "marimba-key", "xylophone-key", "glockenspiel-bar", "wooden-bar", "glass-slat",
      "kalimba", "music-box-comb", "tuning-fork"}},
    {"Bells", {"bronze-bell", "hand-bell", "cow-bell", "singing-bowl", "chime-tube"}},
    {"Cymbals and gongs",
     {"gong", "opera-gong", "tam-tam", "crash-cymbal", "crotale", "triangle", "thunder-sheet", "steel-plate"}},
    {"Glass and porcelain",
     {"glass-harp", "wine-glass", "tumbler", "bottle", "window-pane", "mug", "porcelain-bowl", "dinner-plate",
      "ceramic-tile", "flower-pot"}},
    {"Wood and stone", {"wood-block", "block", "table-top", "brick", "granite-slab"}},
};

}  // namespace

std::string_view family_of(std::string_view preset) {
  for (const Family& family : kFamilies) {
    if (std::find(family.presets.begin(), family.presets.end(), preset) != family.presets.end()) return family.name;
  }
  return "Things";
}

std::string file_of_state(const char* value) {
  return std::filesystem::path(value).filename() == "state.ttl" ? "" : value;
}

std::string choice_name(std::size_t choice) {
  if (choice == 0 || choice >= kChoices) return "file";
  if (choice < kFirstPreset) return formatted("own {}", choice);
  return std::string(kPresets[choice - kFirstPreset]);
}

std::filesystem::path own_folder() {
  const std::filesystem::path data = environment_path("XDG_DATA_HOME");
  return (data.empty() ? environment_path("HOME") / ".local/share" : data) / "ringdown/plugin";
}

std::filesystem::path presets_near(const std::filesystem::path& binary) {
  std::error_code error;
  if (!environment_path("RINGDOWN_PRESETS").empty()) return environment_path("RINGDOWN_PRESETS");
  std::filesystem::path folder = std::filesystem::weakly_canonical(binary, error).parent_path();
  for (int up = 0; up < kMaxFoldersUp && !folder.empty(); ++up, folder = folder.parent_path()) {
    for (const char* below : {"presets", "share/ringdown/presets"}) {
      if (std::filesystem::is_directory(folder / below / "banks", error)) return folder / below;
    }
  }
  return preset_folder().value_or(std::filesystem::path{});
}

Source find_source(std::size_t choice, const std::string& file, const std::filesystem::path& binary) {
  if (choice >= 1 && choice < kFirstPreset) return {choice_name(choice), own_file(choice)};
  if ((choice == 0 || choice >= kChoices) && !file.empty()) return {file, file};
  const std::string_view preset = kPresets[choice >= kFirstPreset && choice < kChoices ? choice - kFirstPreset : 0];
  const std::filesystem::path presets = presets_near(binary);
  const bool map = std::find(kNoteMapPresets.begin(), kNoteMapPresets.end(), preset) != kNoteMapPresets.end();
  return {std::string(preset), presets / (map ? "notes" : "banks") / (std::string(preset) + (map ? ".toml" : ".glb"))};
}

bool is_note_map(const Source& source) { return is_of_kind(source.path, FileKind::table); }

}  // namespace ringdown::plugin
