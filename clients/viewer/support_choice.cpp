#include "clients/viewer/support_choice.h"

#include "engine/base/formatted.h"
#include "engine/modal/surface_index.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <utility>

namespace ringdown::viewer {
namespace {

constexpr double kFlatCosine = 0.9962;     // 5 degrees
constexpr double kFlat = 2e-3;             // of the body's diagonal, off the first triangle's plane
constexpr double kOnPlane = 1e-5;          // of the diagonal: points are kept as floats
constexpr double kRound = 3e-7;            // of the diagonal: less than a bake takes as lying on a plane
constexpr double kAlongAxis = 1e-4;        // a normal so near to an axis is taken as that axis
constexpr double kMargin = 1e-3;           // of the diagonal, around a box
constexpr const char* kStiffness = "1e8";  // N/m for each m2: a start, for people to change

Vec3 unit_of(Vec3 v) { return 1 / length(v) * v; }

Vec3 area_vector(const SupportChoice::Triangle& t) { return 0.5 * cross(t[1] - t[0], t[2] - t[0]); }

// Rounds to a multiple of a power of ten, at most `max` wide.
double rounded(double value, double max) {
  const double step = std::pow(10.0, std::floor(std::log10(max)));
  return step * std::round(value / step) + 0.0;  // no negative zero
}

std::string numbers_text(std::initializer_list<double> values, const char* format) {
  std::string text;
  for (const double value : values) {
    char number[40];
    std::snprintf(number, sizeof number, format, value);
    text += (text.empty() ? "" : ", ") + std::string(number);
  }
  return "[" + text + "]";
}

}  // namespace

void SupportChoice::look_at(const std::string& object, const Bank& bank) {
  if (object == object_ && bank == bank_) return;
  object_ = object;
  bank_ = bank;
  chosen_.clear();
}

SupportChoice::Triangle SupportChoice::triangle(std::size_t t) const {
  Triangle corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& point = bank_->bank.positions[bank_->bank.triangles[t][i]];
    corners[i] = {point[0], point[1], point[2]};
  }
  return corners;
}

double SupportChoice::diagonal_m() const { return modal::SurfaceIndex(bank_->bank).size_m(); }

std::vector<SupportChoice::Triangle> SupportChoice::triangles() const {
  std::vector<Triangle> all;
  for (const std::size_t t : chosen_) all.push_back(triangle(t));
  return all;
}

double SupportChoice::area_m2() const {
  double area = 0;
  for (const std::size_t t : chosen_) area += length(area_vector(triangle(t)));
  return area;
}

// The triangles that hang together with the seed through edges and lie in its plane.
std::vector<std::size_t> SupportChoice::flat_piece(std::size_t seed) const {
  const auto& triangles = bank_->bank.triangles;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<std::size_t>> at_edge;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) at_edge[std::minmax({triangles[t][i], triangles[t][(i + 1) % 3]})].push_back(t);
  }
  const Triangle first = triangle(seed);
  const Vec3 normal = unit_of(area_vector(first));
  const double max = kFlat * diagonal_m();
  const auto lies_there = [&](const Triangle& t) {
    const Vec3 area = area_vector(t);
    return dot(area, normal) >= kFlatCosine * length(area) &&
           std::ranges::all_of(t, [&](Vec3 p) { return std::abs(dot(p - first[0], normal)) <= max; });
  };
  std::set<std::size_t> piece = {seed};
  for (std::vector<std::size_t> next = {seed}; !next.empty();) {
    const std::size_t t = next.back();
    next.pop_back();
    for (std::size_t i = 0; i < 3; ++i) {
      for (const std::size_t other : at_edge[std::minmax({triangles[t][i], triangles[t][(i + 1) % 3]})]) {
        if (!piece.contains(other) && lies_there(triangle(other))) piece.insert(other), next.push_back(other);
      }
    }
  }
  return {piece.begin(), piece.end()};
}

void SupportChoice::toggle_flat(const std::string& object, const Bank& bank, Vec3 point_m) {
  if (!bank || bank->bank.triangles.empty()) return;
  look_at(object, bank);
  const auto nearest = modal::SurfaceIndex(bank->bank).nearest(point_m).points;
  const auto seed = std::ranges::find_if(
      bank->bank.triangles, [&](const auto& t) { return std::is_permutation(t.begin(), t.end(), nearest.begin()); });
  if (seed == bank->bank.triangles.end()) return;
  const auto number = static_cast<std::size_t>(seed - bank->bank.triangles.begin());
  const std::vector<std::size_t> piece = flat_piece(number);
  std::vector<std::size_t> now;
  if (std::ranges::binary_search(chosen_, number)) {
    std::ranges::set_difference(chosen_, piece, std::back_inserter(now));
  } else {
    std::ranges::set_union(chosen_, piece, std::back_inserter(now));
  }
  chosen_ = std::move(now);
}

void SupportChoice::add(const std::string& object, const Bank& bank,
                        const std::function<bool(const Triangle&)>& holds) {
  if (!bank || bank->bank.triangles.empty()) return;
  look_at(object, bank);
  std::set<std::size_t> all(chosen_.begin(), chosen_.end());
  for (std::size_t t = 0; t < bank->bank.triangles.size(); ++t) {
    if (holds(triangle(t))) all.insert(t);
  }
  chosen_.assign(all.begin(), all.end());
}

// A plane through what is chosen, where it is flat and nothing else lies there; else nothing.
std::string SupportChoice::plane() const {
  Vec3 normal, middle;
  double area = 0;
  for (const Triangle& t : triangles()) {
    const Vec3 own = area_vector(t);
    normal = normal + own;
    middle = middle + length(own) / 3 * (t[0] + t[1] + t[2]);
    area += length(own);
  }
  if (!(length(normal) > 0.5 * area)) return "";
  normal = unit_of(normal);
  middle = 1 / area * middle;
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const double along = dot(normal, axis);
    if (std::abs(along) > 1 - 0.5 * kAlongAxis * kAlongAxis) normal = std::copysign(1.0, along) * axis;
  }
  const double diagonal = diagonal_m(), near = kOnPlane * diagonal;
  const auto on_plane = [&](const Triangle& t) {
    return std::ranges::all_of(t, [&](Vec3 p) { return std::abs(dot(p - middle, normal)) <= near; });
  };
  for (std::size_t t = 0; t < bank_->bank.triangles.size(); ++t) {
    if (on_plane(triangle(t)) != std::ranges::binary_search(chosen_, t)) return "";
  }
  const double max = kRound * diagonal;
  return "plane = " + numbers_text({rounded(middle.x, max), rounded(middle.y, max), rounded(middle.z, max),
                                    rounded(normal.x, 1e-8), rounded(normal.y, 1e-8), rounded(normal.z, 1e-8)},
                                   "%.8g");
}

std::string SupportChoice::box() const {
  Vec3 low{1e30, 1e30, 1e30}, high = -1.0 * low;
  for (const Triangle& t : triangles()) {
    for (const Vec3& p : t) {
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  }
  const double margin = kMargin * diagonal_m();
  return "box = " + numbers_text({low.x - margin, low.y - margin, low.z - margin, high.x + margin, high.y + margin,
                                  high.z + margin},
                                 "%.5g");
}

std::string SupportChoice::text() const {
  if (chosen_.empty()) return "";
  const std::string area = formatted("{:.3g} cm2", 1e4 * area_m2());
  const std::string place = plane();
  std::string text = formatted("[[support]]  # {} of {}\nkind = \"{}\"\n{}\n", area, object_, kKinds[kind_],
                               place.empty() ? box() : place);
  if (kind_ == 2) text += formatted("stiffness = {}  # N/m for each m2\n", kStiffness);
  return text;
}

}  // namespace ringdown::viewer
