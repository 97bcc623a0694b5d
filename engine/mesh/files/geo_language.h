// gmsh's language for geometries, as far as one must know it to say what a .geo file does besides describing a body.
// [any thread]
//
// A .geo file is a program: it can run others, write files and end gmsh. Here it is data: check_geo() refuses such
// statements before gmsh sees them. sandbox.h stands behind it, for what a scan by names cannot find.
#pragma once

#include "engine/base/result.h"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ringdown::mesh {

// A word outside of quotes and comments.
struct GeoWord {
  std::string word;
  std::string quoted;    // the text in quotes that comes next, with nothing but blanks and a bracket between
  char next = 0;         // the next character that is neither blank nor comment; 0 at the end
  bool to_file = false;  // of Printf and the like: the brackets after it are followed by '>'
  int line = 1;
};

// O(length).
std::vector<GeoWord> words_of_geo(std::string_view text);

// Returns true where the text gives `name` a value, by "name = ..." anywhere.
bool assigns(std::string_view text, std::string_view name);

// The files that a .geo file reads, relative to its folder; nullopt when it depends on anything but files that it
// names.
std::optional<std::vector<std::filesystem::path>> files_named_by_geo(std::string_view text);

inline constexpr std::size_t kMaxGeoBytes = std::size_t{64} << 20;
inline constexpr std::size_t kMaxGeoFiles = 1000;  // that one geometry is followed to

// True where gmsh goes by the file's ending, which it knows in small or in capital letters; it takes other files for
// its own language, unless their first line says otherwise.
bool gmsh_knows_ending(const std::filesystem::path& path);

// Fails with a sentence that names the file and the line when a file that gmsh's parser would read, or one that it
// includes, runs programs, writes files, ends or stops gmsh, or reads a file outside of its folder. Files that gmsh
// reads as something else than its language are passed over, by their endings.
Result<void> check_geo(const std::filesystem::path& geometry);

}  // namespace ringdown::mesh
