#include "clients/cli/picture/view_data.h"

#include "engine/base/base64.h"
#include "engine/base/formatted.h"
#include "engine/modal/air_absorption.h"
#include "engine/modal/hearing/loudness.h"
#include "engine/modal/material_scale.h"

#include "clients/cli/picture/answer.h"
#include "clients/cli/picture/shape_view.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <numeric>

namespace ringdown::cli {
namespace {

template <class Integer>
void append(std::string& bytes, double value) {
  const auto integer = static_cast<Integer>(std::lround(value));
  for (std::size_t n = 0; n < sizeof integer; ++n) {
    bytes.push_back(static_cast<char>((static_cast<std::uint32_t>(integer) >> (8 * n)) & 0xFF));
  }
}

std::string quoted_base64(const std::string& bytes) { return "\"" + to_base64(bytes) + "\""; }

// A list of numbers with nine digits, which tell all floats apart.
template <class Number>
std::string list_of(std::size_t count, const Number& number) {
  std::string text = "[";
  for (std::size_t n = 0; n < count; ++n) text += (n > 0 ? "," : "") + formatted("{:.9g}", double{number(n)});
  return text + "]";
}

struct Frame {
  double unit_m;
  Vec3 middle_m;
};

Frame frame_of(const modal::Bank& bank) {
  Vec3 low = wide(bank.positions[0]), high = low;
  for (const auto& position : bank.positions) {
    const Vec3 p = wide(position);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const Vec3 size = high - low;
  return {std::max({size.x, size.y, size.z, 1e-9}) / 32000, 0.5 * (low + high)};
}

std::string points_of(const modal::Bank& bank, const Frame& frame) {
  std::string bytes;
  for (const auto& position : bank.positions) {
    const Vec3 p = (1 / frame.unit_m) * (wide(position) - frame.middle_m);
    for (const double c : {p.x, p.y, p.z}) append<std::int16_t>(bytes, c);
  }
  return bytes;
}

// The largest component of each mode becomes 32767, so that shapes are rounded by -100 dB of it.
std::vector<double> shape_units_of(const modal::Bank& bank, const std::vector<std::uint16_t>& places) {
  std::vector<double> units;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    double max = 1e-30;
    for (const std::uint16_t p : places) {
      for (const double c : bank.shape(m, p)) max = std::max(max, std::abs(c));
    }
    units.push_back(max / 32767);
  }
  return units;
}

std::string shapes_of(const modal::Bank& bank, const std::vector<std::uint16_t>& places,
                      const std::vector<double>& units) {
  std::string bytes;
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    for (const std::uint16_t p : places) {
      for (const double c : bank.shape(m, p)) append<std::int16_t>(bytes, c / units[m]);
    }
  }
  return bytes;
}

std::string radiation_of(const modal::Bank& bank) {
  if (!bank.radiation) return "";
  const std::vector<std::byte> packed = modal::pack(bank.radiation->maps).bytes;
  std::string bytes(packed.size(), '\0');
  std::memcpy(bytes.data(), packed.data(), packed.size());
  return ",\"radiation\":" + quoted_base64(bytes);
}

}  // namespace

// Each next place is the point that is farthest from all places before it.
std::vector<std::uint16_t> places_of(const modal::Bank& bank) {
  const std::size_t points = bank.point_count();
  const std::size_t count = std::min(points, std::max(kMinPlaces, kMaxShapeBytes / (6 * bank.mode_count())));
  std::vector<std::uint16_t> places(points);
  std::iota(places.begin(), places.end(), std::uint16_t{0});
  if (count == points) return places;
  places.clear();
  std::vector<double> distance(points, std::numeric_limits<double>::infinity());
  for (std::size_t next = 0; places.size() < count;) {
    places.push_back(static_cast<std::uint16_t>(next));
    const Vec3 at = wide(bank.positions[next]);
    for (std::size_t p = 0; p < points; ++p) {
      distance[p] = std::min(distance[p], length(wide(bank.positions[p]) - at));
    }
    next = static_cast<std::size_t>(std::ranges::max_element(distance) - distance.begin());
  }
  std::ranges::sort(places);
  return places;
}

std::string view_data(const modal::Bank& bank) {
  if (std::max(bank.triangles.size(), bank.point_count()) > kMaxDrawn) return "{}";
  const Frame frame = frame_of(bank);
  const std::vector<std::uint16_t> places = places_of(bank);
  const std::vector<double> units = shape_units_of(bank, places);
  const modal::Loudness loudness(bank);
  const modal::AirAbsorption air{modal::AirConditions{}};
  std::string triangles, numbers;
  for (const auto& t : bank.triangles) {
    for (const std::uint32_t corner : t) append<std::uint16_t>(triangles, corner);
  }
  for (const std::uint16_t p : places) append<std::uint16_t>(numbers, p);
  const std::array<double, 3> middle = {frame.middle_m.x, frame.middle_m.y, frame.middle_m.z};
  const std::size_t modes = bank.mode_count();
  const auto output = [&](std::size_t m) {
    const double f = bank.frequency_hz[m];
    return bank.gain * loudness.pressure_pa(bank, m, {}, f) / modal::kFullScale_pa * std::exp(-air.nepers_per_m(f));
  };
  return "{\"modes\":" + std::to_string(modes) + ",\"points\":" + quoted_base64(points_of(bank, frame)) +
         ",\"triangles\":" + quoted_base64(triangles) + ",\"places\":" + quoted_base64(numbers) +
         ",\"shapes\":" + quoted_base64(shapes_of(bank, places, units)) +
         formatted(",\"unit_m\":{:.9g}", frame.unit_m) +
         ",\"middle_m\":" + list_of(3, [&](std::size_t n) { return middle[n]; }) +
         ",\"shape_unit\":" + list_of(modes, [&](std::size_t m) { return units[m]; }) +
         ",\"frequency_hz\":" + list_of(modes, [&](std::size_t m) { return bank.frequency_hz[m]; }) +
         ",\"decay_per_s\":" + list_of(modes, [&](std::size_t m) { return bank.decay_per_s[m]; }) +
         ",\"output\":" + list_of(modes, output) + radiation_of(bank) +
         ",\"nonlinear\":" + (bank.nonlinear ? "true" : "false") + "}";
}

}  // namespace ringdown::cli
