#include "engine/bake/object_file.h"

#include "engine/bake/liquid/filling.h"
#include "engine/bake/makeup_file.h"
#include "engine/bake/tubes/resonator.h"
#include "engine/base/note.h"
#include "engine/base/toml_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <regex>
#include <vector>

namespace ringdown::bake {
namespace {

// A note's name, or a frequency in Hz.
std::optional<double> parse_pitch(const std::string& word) {
  if (const auto note = note_number(word)) return note_frequency(*note);
  const Result<double> hz = parse_fraction(word);
  return hz && !word.ends_with('%') && modal::kStatedPitch_hz.holds(*hz) ? std::optional(*hz) : std::nullopt;
}

void read_pitch(TomlTable& file, ObjectRecipe& recipe) {
  std::vector<std::string> words;
  file.words("pitch", words, false);
  if (words.empty()) return;
  recipe.pitch_hz = parse_pitch(words.front());
  if (!recipe.pitch_hz)
    file.complain("pitch", "pitch must be a note such as \"A4\" or \"F#3\", or a frequency of 1 to 100000 Hz");
}

constexpr std::uint64_t kMaxSeed = 1'000'000'000;
constexpr Range kPieceMass_kg{0, 1e3}, kBlow_m{-1e6, 1e6}, kBand_hz{0, 1e6};
constexpr std::size_t kMaxPlaces = 16, kMaxLevels = 4;
constexpr double kMaxPieces = 500;  // of a level

void read_pieces(TomlTable& table, Shatter& shatter) {
  std::vector<double> pieces(shatter.pieces.begin(), shatter.pieces.end());
  table.numbers("pieces", pieces);
  shatter.pieces.clear();
  for (const double count : pieces) {
    const bool above = shatter.pieces.empty() || count > shatter.pieces.back();
    if (count >= 2 && count <= kMaxPieces && count == std::floor(count) && above)
      shatter.pieces.push_back(static_cast<int>(count));
  }
  if (shatter.pieces.empty() || shatter.pieces.size() < pieces.size() || pieces.size() > kMaxLevels)
    table.complain("pieces", "pieces must be one to four ascending whole numbers from 2 to 500");
}

std::optional<Shatter> read_shatter(TomlTable& file) {
  constexpr std::array kPatterns = {shatter::Pattern::kImpact, shatter::Pattern::kRadial, shatter::Pattern::kUniform};
  std::optional<TomlTable> table = file.table("shatter");
  if (!table) return std::nullopt;
  Shatter shatter;
  read_pieces(*table, shatter);
  if (table->has("pattern"))
    shatter.pattern =
        kPatterns[static_cast<std::size_t>(std::max(table->choice("pattern", {"impact", "radial", "uniform"}), 0))];
  std::vector<double> places, band = {shatter.band_low_hz, shatter.band_high_hz};
  table->numbers("at", places);
  if (places.size() % 3 != 0 || places.size() > 3 * kMaxPlaces ||
      !std::ranges::all_of(places, [](double x) { return kBlow_m.holds(x); }))
    table->complain("at", "at must be three numbers for each place of a blow, in metres, of at most 16 places");
  for (std::size_t i = 0; i + 2 < places.size(); i += 3)
    shatter.places_m.push_back({places[i], places[i + 1], places[i + 2]});
  const int all = std::reduce(shatter.pieces.begin(), shatter.pieces.end());
  if (all * std::max<std::size_t>(shatter.places_m.size(), 1) > modal::kMaxPieces)
    table->complain("pieces", formatted("the pieces of all levels and places must be {} at most", modal::kMaxPieces));
  table->whole("seed", shatter.seed, 0, kMaxSeed);
  table->number("min_mass_kg", shatter.min_mass_kg, kPieceMass_kg);
  table->numbers("band_hz", band);
  if (band.size() != 2 || !kBand_hz.holds(band[0]) || !kBand_hz.holds(band[1]) || !(band[1] > band[0])) {
    table->complain("band_hz", "band_hz must be two frequencies in Hz, the lower one first");
    return std::nullopt;
  }
  shatter.band_low_hz = band[0];
  shatter.band_high_hz = band[1];
  return shatter;
}

// Surfaces of parts become groups, named as they are seen from the geometry's folder, where they must lie.
void read_part_surfaces(TomlTable& file, const std::filesystem::path& folder, ObjectRecipe& recipe) {
  for (Part& part : recipe.options.makeup.parts) {
    if (part.surface.empty()) continue;
    const std::filesystem::path geometry_folder = recipe.geometry.parent_path().lexically_normal();
    part.group = (folder / part.surface).lexically_normal().lexically_relative(geometry_folder).generic_string();
    if (part.group.empty() || part.group.starts_with(".."))
      return file.complain("part", "the surface " + part.surface + " must lie in the folder of the geometry");
    recipe.meshing.parts.push_back(part.group);
  }
}

Result<ObjectRecipe> recipe_in(Result<TomlTable> file, const std::filesystem::path& path) {
  if (!file) return fail(file);
  ObjectRecipe recipe;
  recipe.name = path.stem().string();
  std::string geometry;
  file->require({"material", "geometry"});
  file->text("description", recipe.description);
  file->text("material", recipe.material);
  file->text("geometry", geometry);
  recipe.geometry = path.parent_path() / geometry;
  read_options(*file, recipe);
  if (recipe.options.coupled > recipe.options.nonlinear)
    file->complain("coupled",
                   "coupled must not exceed nonlinear, because the coupled modes are the lowest of the nonlinear ones");
  read_makeup(*file, recipe.options.makeup);
  read_part_surfaces(*file, path.parent_path(), recipe);
  read_pitch(*file, recipe);
  recipe.shatter = read_shatter(*file);
  read_liquids(*file, recipe.options.liquids);
  read_resonators(*file, recipe.options.resonators);
  recipe.options.cavity = read_cavity(*file);
  const bool needs_air = !recipe.options.resonators.empty() || recipe.options.cavity;
  if (needs_air && !file->has("radiation") && !recipe.options.air) recipe.options.air.emplace();
  if (auto good = file->finish(); !good) return fail(good);
  return recipe;
}

}  // namespace

std::vector<std::filesystem::path> part_materials(const ObjectRecipe& recipe, const std::filesystem::path& materials) {
  std::vector<std::filesystem::path> files;
  for (const Part& part : recipe.options.makeup.parts) files.push_back(materials / (part.material.name + ".toml"));
  const Liquids& liquids = recipe.options.liquids;
  const std::filesystem::path folder = liquid_folder(materials);
  if (liquids.fill) files.push_back(folder / (liquids.fill->liquid.name + ".toml"));
  if (liquids.bath) files.push_back(folder / (liquids.bath->liquid.name + ".toml"));
  return files;
}

std::vector<std::filesystem::path> part_surfaces(const ObjectRecipe& recipe) {
  std::vector<std::filesystem::path> files;
  for (const std::string& part : recipe.meshing.parts) files.push_back(recipe.geometry.parent_path() / part);
  return files;
}

Result<ObjectRecipe> read_object(const std::filesystem::path& path) { return recipe_in(TomlTable::read(path), path); }

Result<ObjectRecipe> parse_object(std::string_view text, const std::filesystem::path& path) {
  return recipe_in(TomlTable::parse(text, path), path);
}

namespace {

std::string number_text(double value) { return formatted("{:.6g}", value); }

// The note's name where the pitch is one of equal temperament, else Hz.
std::string pitch_text(double pitch_hz) {
  const int note = static_cast<int>(std::lround(note_of(pitch_hz)));
  const bool is_note = note >= 0 && note <= 127 && std::abs(pitch_hz / note_frequency(note) - 1) < 1e-6;
  return is_note ? "\"" + note_word(note) + "\"" : number_text(pitch_hz);
}

class Lines {
 public:
  explicit Lines(std::string_view text) {
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      lines_.emplace_back(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }

  // Sets a key in the table of that name; "" is the top level of the file.
  void set(const std::string& table, const std::string& key, const std::string& value) {
    const std::regex line("(\\s*" + key + "\\s*=\\s*)(?:\"[^\"]*\"|[^#\"])*?(\\s*(#.*)?)");
    auto [at, end] = range(table);
    for (; at < end; ++at) {
      std::smatch found;
      if (!std::regex_match(lines_[at], found, line)) continue;
      lines_[at] = found[1].str() + value + found[2].str();
      return;
    }
    while (end > 0 && lines_[end - 1].empty()) --end;
    lines_.insert(lines_.begin() + static_cast<std::ptrdiff_t>(end), key + " = " + value);
  }

  void drop(const std::string& table, const std::string& key) {
    const auto [begin, end] = range(table);
    const std::regex line("\\s*" + key + "\\s*=.*");
    for (std::size_t at = begin; at < end; ++at) {
      if (!std::regex_match(lines_[at], line)) continue;
      lines_.erase(lines_.begin() + static_cast<std::ptrdiff_t>(at));
      return;
    }
  }

  [[nodiscard]] std::string text() const {
    std::string all;
    for (const std::string& line : lines_) all += line + "\n";
    return all;
  }

 private:
  // Its lines, without the header; the table is added when it is not there.
  std::pair<std::size_t, std::size_t> range(const std::string& table) {
    static const std::regex header(R"(\s*\[\s*([^\]]*?)\s*\]\s*(#.*)?)");
    std::string current;
    std::size_t begin = 0;
    for (std::size_t at = 0; at <= lines_.size(); ++at) {
      std::smatch found;
      const bool ends = at == lines_.size() || std::regex_match(lines_[at], found, header);
      if (!ends) continue;
      if (current == table) return {begin, at};
      if (at == lines_.size()) break;
      current = found[1].str();
      begin = at + 1;
    }
    lines_.emplace_back("");
    lines_.push_back("[" + table + "]");
    return {lines_.size(), lines_.size()};
  }

  std::vector<std::string> lines_;
};

}  // namespace

Result<std::string> change_object(std::string_view text, const ObjectChanges& changes) {
  const Result<ObjectRecipe> before = parse_object(text, "the object");
  if (!before) return fail(before);
  ObjectRecipe wanted = *before;
  Lines lines(text);
  lines.drop("", "name");
  if (changes.pitch_hz) {
    lines.set("", "pitch", pitch_text(*changes.pitch_hz));
  } else {
    lines.drop("", "pitch");
  }
  if (changes.mesh_size_m > 0) lines.set("", "mesh_size_m", number_text(changes.mesh_size_m));
  if (!changes.geometry.empty()) {
    lines.set("", "geometry", "\"" + changes.geometry.generic_string() + "\"");
    wanted.geometry = changes.geometry;
  }
  for (const auto& [key, value] : changes.parameters) {
    lines.set("parameters", key, number_text(value));
    wanted.meshing.parameters[key] = std::stod(number_text(value));
  }
  if (changes.level_m) {
    for (const char* amount : {"depth_m", "volume_ml", "full"}) lines.drop("fill", amount);
    lines.set("fill", "level_m", number_text(*changes.level_m));
  }
  const Result<ObjectRecipe> after = parse_object(lines.text(), "the object");
  if (!after || after->geometry != wanted.geometry || after->meshing.parameters != wanted.meshing.parameters ||
      after->pitch_hz.has_value() != changes.pitch_hz.has_value() ||
      (changes.level_m && !after->options.liquids.fill)) {
    return fail(ErrorKind::bad_input,
                "the object file cannot be changed line by line; put each key on its own line, the parameters into a "
                "table [parameters], and the liquid into a table [fill]");
  }
  return lines.text();
}

}  // namespace ringdown::bake
