// The recipe of a bank, and every option of it once: the key in an object file, its name on the command line of
// ringdown-bake, what both accept, and where its value goes. [any thread]
//
// A new option takes a row in recipe_options.cpp, a member for its value, and a row in docs/use/materials.md. Its
// default is the member's. On the command line, options stand in the order of the table, also in the hash of a bank's
// inputs: a row in the middle makes other hashes of banks that have options on both sides of it.
#pragma once

#include "engine/bake/bake.h"
#include "engine/bake/shatter_body.h"
#include "engine/base/range.h"
#include "engine/base/result.h"
#include "engine/base/toml_table.h"
#include "engine/mesh/body.h"

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace ringdown::bake {

struct ObjectRecipe {
  std::string name;
  std::string description;
  std::string material;
  std::filesystem::path geometry;
  mesh::GmshOptions meshing;
  BakeOptions options;
  double scale = 1;                       // size of the object over that of its geometry, whose mesh it keeps
  std::map<std::string, double> figures;  // of the material, by their keys in its file, instead of what stands there
  bool other_material = false;  // `material` is not the object's own: a grain that it has no constants for is left out
  std::optional<Shatter> shatter;  // how it breaks; nothing: it does not
  double gain_db = 0;
  std::optional<double> pitch_hz;  // stated, of the object at its scale and in its material
  double error = 0;  // relative, that the estimate for every frequency in the band must reach; 0: whatever it is
  double max_unknowns = 400'000;  // that `error` may lead to
  bool preview = false;           // coarse and quick; `error` does not count
  double budget_s = 0;            // of processor time, which `ringdown bake FOLDER` compares with; 0: none
};

struct OptionValue {
  std::string text;  // of words; of settings the name
  double number = 0;
  double second = 0;     // of a pair
  bool in_file = false;  // not on the command line
};

struct RecipeOption {
  std::string_view key;        // in object files; empty: only on the command line
  std::string option;          // with its dashes; empty: only in object files
  std::string type, sentence;  // of its value, and for --help
  enum class Form {
    on,        // true or false, as 1 or 0
    word,      // a text
    words,     // texts, on the command line one each time the option is given
    count,     // a whole number
    number,    // any number in the range
    fraction,  // a number, or a percentage such as "0.1%"
    length,    // a number of metres, on the command line also mm, cm, m or in
    pair,      // two numbers
    settings,  // numbers by name: a table, or NAME=NUMBER
  } form;
  // Fails when the value cannot be understood.
  Result<void> (*set)(ObjectRecipe& recipe, const OptionValue& value);
  Range in_file = {}, in_command = in_file;  // a range up to kAnyHigh: any number above zero
  enum Trait : unsigned {
    kOtherBody = 1,     // makes another body of the object file's, whose stated pitch no longer holds
    kNotForScenes = 2,  // refused where a scene is baked
    kSameBank = 4,      // not part of a bank's hash of inputs
    kNotWithLast = 8,   // excludes the option before it
  };
  unsigned traits = 0;
  std::string_view demand = {};  // the refusal in an object file where `set` fails

  [[nodiscard]] bool has(Trait trait) const { return (traits & trait) != 0; }
};

inline constexpr double kAnyHigh = HUGE_VAL;
inline constexpr const char* kUnitSentence =
    "one unit of the file: mm, cm, m, in, or metres such as 0.001 (default: what the file says, else metres)";

std::span<const RecipeOption> recipe_options();

// Reads the options that the object file has. Errors are noted in `file`.
void read_options(TomlTable& file, ObjectRecipe& recipe);

}  // namespace ringdown::bake
