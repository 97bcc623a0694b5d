#include "clients/plugin/window/browser.h"

#include "clients/plugin/sources.h"

#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace ringdown::plugin {
namespace {

// Returns whether all words of the search stand in the text, in upper or lower case.
bool matches(std::string_view search, const std::string& text) {
  const auto same = [](unsigned char a, unsigned char b) { return std::tolower(a) == std::tolower(b); };
  while (!search.empty()) {
    const std::string_view word = search.substr(0, search.find(' '));
    if (std::search(text.begin(), text.end(), word.begin(), word.end(), same) == text.end()) return false;
    search.remove_prefix(std::min(search.size(), word.size() + 1));
  }
  return true;
}

bool exists(std::size_t own_file) {
  std::error_code error;
  const auto file = own_folder() / std::to_string(own_file);
  return std::filesystem::exists(file.string() + ".glb", error) ||
         std::filesystem::exists(file.string() + ".toml", error);
}

struct Entry {
  std::size_t choice;
  std::string name;
};

// The choices of the parameter "Object" by families, in the order in which they are shown.
std::vector<std::pair<std::string, std::vector<Entry>>> families(const std::string& file) {
  std::vector<Entry> own;
  if (!file.empty()) own.push_back({0, std::filesystem::path(file).filename()});
  for (std::size_t i = 1; i <= kOwnFiles; ++i) {
    if (exists(i)) own.push_back({i, choice_name(i)});
  }
  std::map<std::string, std::vector<Entry>> presets;
  for (std::size_t i = 0; i < kPresets.size(); ++i) {
    presets[std::string(family_of(kPresets[i]))].push_back({kFirstPreset + i, std::string(kPresets[i])});
  }
  std::vector<std::pair<std::string, std::vector<Entry>>> all{{"Your files", std::move(own)}};
  for (auto& [family, entries] : presets) {
    std::ranges::sort(entries, {}, &Entry::name);
    all.emplace_back(family, std::move(entries));
  }
  return all;
}

}  // namespace

void Browser::draw(Edits& edits, HostLink& host) {
  ImGui::SetNextItemWidth(-1);
  ImGui::InputTextWithHint("##search", "Search", search_.data(), search_.size());
  if (ImGui::Button("Open file ...", {-1, 0})) host.browse_files();
  ImGui::BeginChild("objects");
  const auto chosen = static_cast<std::size_t>(edits.values()[Parameter::object]);
  for (const auto& [family, entries] : families(edits.values().file)) {
    bool titled = false;
    for (const auto& [choice, name] : entries) {
      if (!matches(search_.data(), family + " " + name)) continue;
      if (!titled) ImGui::TextDisabled("%s", family.c_str());
      titled = true;
      ImGui::PushID(static_cast<int>(choice));
      if (ImGui::Selectable(name.c_str(), choice == chosen) && choice != chosen) {
        edits.set(Parameter::object, static_cast<double>(choice));
      }
      ImGui::PopID();
    }
  }
  ImGui::EndChild();
}

}  // namespace ringdown::plugin
