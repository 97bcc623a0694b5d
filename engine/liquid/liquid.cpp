#include "engine/liquid/liquid.h"

#include "engine/base/quote.h"
#include "engine/base/range.h"
#include "engine/base/toml_table.h"

#include <algorithm>
#include <system_error>
#include <vector>

namespace ringdown::liquid {
namespace {

constexpr Range kDensity_kg_m3{10, 3e4}, kSoundSpeed_m_s{20, 1e4}, kViscosity_pa_s{0, 1e5};

void read_figure(TomlTable& file, const char* key, double& value, const Range& range) {
  std::optional<TomlTable> figure = file.table(key);
  if (!figure) return;
  std::string source;
  figure->require({"value", "source"});
  figure->number("value", value, range);
  figure->text("source", source);
}

}  // namespace

Result<Liquid> read_liquid(const std::filesystem::path& path) {
  Result<TomlTable> file = TomlTable::read(path);
  if (!file) return fail(file);
  Liquid liquid;
  std::string description;
  file->require({"name", "density_kg_m3", "sound_speed_m_s", "viscosity_pa_s"});
  file->text("name", liquid.name);
  file->text("description", description);
  read_figure(*file, "density_kg_m3", liquid.density_kg_m3, kDensity_kg_m3);
  read_figure(*file, "sound_speed_m_s", liquid.sound_speed_m_s, kSoundSpeed_m_s);
  read_figure(*file, "viscosity_pa_s", liquid.viscosity_pa_s, kViscosity_pa_s);
  if (liquid.name != path.stem()) file->complain("name", "the name must be that of the file");
  if (auto good = file->finish(); !good) return fail(good);
  return liquid;
}

Result<Liquid> find_liquid(const std::filesystem::path& folder, const std::string& name) {
  std::vector<std::string> known;
  std::error_code error;
  for (const auto& file : std::filesystem::directory_iterator(folder, error)) {
    if (file.path().extension() == ".toml") known.push_back(file.path().stem().string());
  }
  std::ranges::sort(known);
  if (std::ranges::binary_search(known, name)) return read_liquid(folder / (name + ".toml"));
  std::string list;
  for (const std::string& one : known) list += (list.empty() ? "" : ", ") + one;
  return fail(ErrorKind::bad_input, "there is no liquid " + quote(name) + " in " + folder.string() +
                                        (list.empty() ? "" : "; choose one of: " + list));
}

}  // namespace ringdown::liquid
