#include "clients/cli/fit/mode_list.h"

#include "engine/modal/damping.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string>
#include <string_view>

namespace ringdown::cli {
namespace {

std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> cells(1);
  for (const char c : line) {
    if (c == ',') {
      cells.emplace_back();
    } else if (c != ' ' && c != '\t' && c != '\r' && c != '"') {
      cells.back() += c;
    }
  }
  return cells;
}

}  // namespace

Result<std::vector<fit::Mode>> read_mode_list(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return fail(ErrorKind::bad_input, "cannot read " + path.string());
  std::vector<std::string> names;
  std::vector<fit::Mode> modes;
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number) {
    const std::vector<std::string> cells = cells_of(line);
    if (cells.front().starts_with('#') || std::ranges::all_of(cells, &std::string::empty)) continue;
    if (names.empty()) {
      names = cells;
      if (std::ranges::find(names, "frequency_hz") == names.end())
        return fail(ErrorKind::bad_input, "{}:{}: no column is called frequency_hz", path.string(), number);
      continue;
    }
    fit::Mode mode{.amplitude = 1};
    for (std::size_t k = 0; k < std::min(cells.size(), names.size()); ++k) {
      const std::string& name = names[k];
      const bool is_read = name == "frequency_hz" || name == "t60_s" || name == "decay_per_s";
      if (!is_read || (cells[k].empty() && name != "frequency_hz")) continue;
      double value = 0;
      const auto [end, wrong] = std::from_chars(cells[k].data(), cells[k].data() + cells[k].size(), value);
      if (wrong != std::errc() || end != cells[k].data() + cells[k].size() || !(value > 0) || !std::isfinite(value)) {
        return fail(ErrorKind::bad_input, "{}:{}: {} is \"{}\", which is not a number above 0", path.string(), number,
                    name, cells[k]);
      }
      (name == "frequency_hz" ? mode.frequency_hz : mode.decay_per_s) = name == "t60_s" ? modal::t60_s(value) : value;
    }
    modes.push_back(mode);
  }
  if (modes.empty()) return fail(ErrorKind::bad_input, path.string() + " has no mode");
  std::ranges::sort(modes, {}, &fit::Mode::frequency_hz);
  return modes;
}

}  // namespace ringdown::cli
