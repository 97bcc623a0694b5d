#include "clients/viewer/panels/font.h"

#include <fontconfig/fontconfig.h>
#include <imgui.h>

#include <array>
#include <memory>
#include <optional>
#include <string>

namespace ringdown::viewer {
namespace {

constexpr double kTextHeight = 15, kOwnHeight = 13;  // pixels at a scale of 1: of sans, of ImGui's own font

// The TrueType file of the font that fontconfig gives for "sans"; nothing where there is none, and ImGui's own is used.
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

}  // namespace

void load_font(double scale) {
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  fonts.Clear();
  static const std::array<ImWchar, 7> kRanges = {0x20, 0xff, 0x2010, 0x2027, 0x2190, 0x2193, 0};
  const auto file = sans_font_file();
  const auto size = static_cast<float>(kTextHeight * scale);
  if (file && fonts.AddFontFromFileTTF(file->c_str(), size, nullptr, kRanges.data())) return;
  ImFontConfig config;
  config.SizePixels = static_cast<float>(kOwnHeight * scale);
  fonts.AddFontDefault(&config);
}

}  // namespace ringdown::viewer
