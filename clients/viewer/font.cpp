#include "clients/viewer/font.h"

#include <fontconfig/fontconfig.h>

#include <memory>

namespace ringdown::viewer {

std::optional<std::string> sans_font_file() {
  const auto free_pattern = [](FcPattern* pattern) { FcPatternDestroy(pattern); };
  using Pattern = std::unique_ptr<FcPattern, decltype(free_pattern)>;
  if (!FcInit()) return std::nullopt;
  const Pattern wanted(FcNameParse(reinterpret_cast<const FcChar8*>("sans:fontformat=TrueType")), free_pattern);
  if (!wanted) return std::nullopt;
  FcConfigSubstitute(nullptr, wanted.get(), FcMatchPattern);
  FcDefaultSubstitute(wanted.get());
  FcResult outcome = FcResultNoMatch;
  const Pattern found(FcFontMatch(nullptr, wanted.get(), &outcome), free_pattern);
  FcChar8* file = nullptr;
  if (!found || FcPatternGetString(found.get(), FC_FILE, 0, &file) != FcResultMatch) return std::nullopt;
  const std::string path = reinterpret_cast<const char*>(file);
  if (!path.ends_with(".ttf")) return std::nullopt;
  return path;
}

}  // namespace ringdown::viewer
