// The exact point at which the window strikes, beside the parameter "Strike point": a place on the surface, and the
// direction of the blow there. Sessions keep it as text. It belongs to one object and to one value of the parameter, so
// that another object, or a move of the parameter, ends it in whatever order a host restores both.
//
// There may be a second point, which blows of high velocities strike.
#pragma once

#include "engine/base/realtime.h"
#include "engine/base/vec3.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace ringdown::plugin {

enum class Which : std::size_t { first, second };
inline constexpr std::size_t kPoints = 2;
inline constexpr std::array<const char*, kPoints> kPointStates = {"point", "second_point"};  // names in sessions
inline constexpr std::uint8_t kSecondFrom = 100;  // the lowest velocity that strikes the second point

struct StrikePoint {
  Vec3 point_m, direction;  // in the frame and size of the bank; unit vector of the impulse
  double percent = 0;       // the parameter's value
  std::string source;       // name of the object's source (sources.h)

  // Returns whether the parameter still has the value; hosts round it. [any]
  [[nodiscard]] bool is_at(double parameter) const REALTIME { return std::abs(parameter - percent) < 0.005; }
};

// Returns "x y z dx dy dz percent source". [any thread but audio]
std::string to_text(const StrikePoint& point);

// Returns the point that a text of to_text() means; nothing for any other text.
std::optional<StrikePoint> strike_point_of(std::string_view text);

}  // namespace ringdown::plugin
