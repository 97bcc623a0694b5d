#include "clients/cli/picture/view_data.h"

#include "engine/base/base64.h"

#include "clients/cli/picture/answer.h"
#include "clients/cli/picture/shape_view.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace ringdown::cli {
namespace {

template <class Integer>
void append(std::string& bytes, double value) {
  const auto integer = static_cast<Integer>(std::lround(value));
  for (std::size_t n = 0; n < sizeof integer; ++n) {
    bytes.push_back(static_cast<char>((static_cast<std::uint32_t>(integer) >> (8 * n)) & 0xFF));
  }
}

std::string points_of(const modal::Bank& bank) {
  modal::Vec3f low = bank.positions[0], high = low;
  for (const auto& p : bank.positions) {
    for (int c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], p[c]);
      high[c] = std::max(high[c], p[c]);
    }
  }
  const double extent = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2], 1e-9F});
  std::string bytes;
  for (const auto& p : bank.positions) {
    for (int c = 0; c < 3; ++c) append<std::int16_t>(bytes, 32000 * (p[c] - 0.5 * (low[c] + high[c])) / extent);
  }
  return bytes;
}

void append_shape(std::string& bytes, const modal::Bank& bank, std::size_t mode) {
  double max = 1e-300;
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    for (const double c : bank.shape(mode, p)) max = std::max(max, std::abs(c));
  }
  for (std::size_t p = 0; p < bank.point_count(); ++p) {
    for (const double c : bank.shape(mode, p)) append<std::int8_t>(bytes, 127 * c / max);
  }
}

}  // namespace

std::string view_data(const modal::Bank& bank) {
  if (std::max(bank.triangles.size(), bank.point_count()) > kMaxDrawn) return "{}";
  const std::size_t shown =
      std::min(bank.mode_count(), std::max<std::size_t>(1, kMaxViewBytes / (3 * bank.point_count())));
  std::string triangles, shapes;
  for (const auto& t : bank.triangles) {
    for (const std::uint32_t corner : t) append<std::int32_t>(triangles, corner);
  }
  for (std::size_t m = 0; m < shown; ++m) append_shape(shapes, bank, m);
  return "{\"modes\":" + std::to_string(shown) + ",\"points\":\"" + to_base64(points_of(bank)) + "\",\"triangles\":\"" +
         to_base64(triangles) + "\",\"shapes\":\"" + to_base64(shapes) + "\"}";
}

}  // namespace ringdown::cli
