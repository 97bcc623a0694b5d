#include "engine/materials/material_words.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>
#include <vector>

namespace ringdown::bake {
namespace {

// Words that are no names of the library, and the material nearest to what they mean.
constexpr std::array<std::pair<std::string_view, std::string_view>, 44> kWords = {{
    {"aluminum", "aluminium"},
    {"alu", "aluminium"},
    {"ash", "maple"},
    {"beech", "maple"},
    {"birch", "birch-plywood"},
    {"carbon", "carbon-fibre"},
    {"cement", "concrete"},
    {"ceramic", "porcelain"},
    {"ceramics", "porcelain"},
    {"cherry", "maple"},
    {"china", "porcelain"},
    {"chrome", "steel"},
    {"clay", "porcelain"},
    {"crystal", "glass"},
    {"earthenware", "porcelain"},
    {"ebony", "rosewood"},
    {"fir", "spruce"},
    {"glas", "glass"},
    {"holz", "wood"},
    {"inox", "stainless-steel"},
    {"larch", "spruce"},
    {"mahogany", "rosewood"},
    {"metal", "steel"},
    {"metall", "steel"},
    {"oak", "maple"},
    {"perspex", "acrylic"},
    {"pine", "spruce"},
    {"plexiglass", "acrylic"},
    {"plywood", "birch-plywood"},
    {"pvc", "plastic"},
    {"quartz", "fused-silica"},
    {"rock", "granite"},
    {"silverware", "nickel-silver"},
    {"stahl", "steel"},
    {"stainless", "stainless-steel"},
    {"stone", "granite"},
    {"stoneware", "porcelain"},
    {"teak", "rosewood"},
    {"terracotta", "porcelain"},
    {"tile", "porcelain"},
    {"tiles", "porcelain"},
    {"timber", "wood"},
    {"walnut", "rosewood"},
    {"wooden", "wood"},
}};

// The words of a name in lower case. A word also ends where a capital follows a small letter.
std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words(1);
  bool small = false;
  for (const char c : name) {
    const auto letter = static_cast<unsigned char>(c);
    const bool capital = std::isupper(letter) != 0;
    if (!std::isalpha(letter) || (capital && small)) words.emplace_back();
    if (std::isalpha(letter)) words.back() += static_cast<char>(std::tolower(letter));
    small = std::islower(letter) != 0;
  }
  std::erase(words, "");
  return words;
}

}  // namespace

std::optional<std::string> understood_material(std::string_view name, std::span<const std::string> known) {
  const std::vector<std::string> words = words_of(name);
  const auto is_known = [&](const std::string& word) { return std::ranges::find(known, word) != known.end(); };
  for (std::size_t k = words.size(); k > 0; --k) {
    if (k >= 2 && is_known(words[k - 2] + "-" + words[k - 1])) return words[k - 2] + "-" + words[k - 1];
    if (is_known(words[k - 1])) return words[k - 1];
    const auto found = std::ranges::find(kWords, words[k - 1], &std::pair<std::string_view, std::string_view>::first);
    if (found != kWords.end() && is_known(std::string(found->second))) return std::string(found->second);
  }
  return {};
}

}  // namespace ringdown::bake
