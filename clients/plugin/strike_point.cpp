#include "clients/plugin/strike_point.h"

#include "engine/base/formatted.h"

#include <array>
#include <charconv>
#include <system_error>
#include <utility>

namespace ringdown::plugin {

std::string to_text(const StrikePoint& point) {
  const auto& [at, way] = std::pair{point.point_m, point.direction};
  return formatted("{} {} {} {} {} {} {} {}", at.x, at.y, at.z, way.x, way.y, way.z, point.percent, point.source);
}

std::optional<StrikePoint> strike_point_of(std::string_view text) {
  std::array<double, 7> numbers{};
  for (double& number : numbers) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    if (error != std::errc{} || !std::isfinite(number) || !text.starts_with(' ')) return std::nullopt;
    text.remove_prefix(1);
  }
  const auto& [x, y, z, way_x, way_y, way_z, percent] = numbers;
  const Vec3 way{way_x, way_y, way_z};
  if (text.empty() || !(length(way) > 0) || !std::isfinite(length(way))) return std::nullopt;
  return StrikePoint{{x, y, z}, (1 / length(way)) * way, percent, std::string(text)};
}

}  // namespace ringdown::plugin
