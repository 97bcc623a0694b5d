#include "clients/cli/picture/directivity_picture.h"

#include "clients/cli/picture/bank_page.h"
#include "clients/cli/picture/shape_view.h"
#include "engine/base/formatted.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

namespace ringdown::cli {
namespace {

constexpr double kWidth = 1120, kHeight = 700, kSize = 12, kRange_db = 30, kTurn = 2 * std::numbers::pi;

// A level as a radius: 0 at kRange_db below the loudest direction, 1 at the loudest.
struct Scale {
  double top_db = 0;
  [[nodiscard]] double radius(double level_db) const {
    return std::clamp(1 + (level_db - top_db) / kRange_db, 0.0, 1.0);
  }
};

struct Facet {
  std::array<Dot, 4> corners;
  double depth, radius;
};

// The sphere in facets, each corner as far from the middle as it is loud that way.
void draw_balloon(Canvas& canvas, Dot middle, double size, const Directivity& directivity, const Scale& scale) {
  constexpr int kRings = 60, kSectors = 120;
  struct Corner {
    Vec3 seen;
    double radius;
  };
  std::vector<Corner> corners;
  for (int ring = 0; ring <= kRings; ++ring) {
    for (int sector = 0; sector <= kSectors; ++sector) {
      const double polar = ring * kTurn / 2 / kRings, azimuth = sector * kTurn / kSectors;
      const Vec3 to{std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth), std::cos(polar)};
      const double radius = scale.radius(directivity.level_db(to));
      corners.push_back({seen_from_front(radius * to), radius});
    }
  }
  std::vector<Facet> facets;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int sector = 0; sector < kSectors; ++sector) {
      Facet facet{{}, 0, 0};
      const int first = ring * (kSectors + 1) + sector, below = first + kSectors + 1;
      std::size_t k = 0;
      for (const int index : {first, first + 1, below + 1, below}) {
        const Corner& corner = corners[static_cast<std::size_t>(index)];
        facet.corners[k++] = {middle.x + size * corner.seen.x, middle.y - size * corner.seen.y};
        facet.depth += corner.seen.z / 4;
        facet.radius += corner.radius / 4;
      }
      facets.push_back(facet);
    }
  }
  std::ranges::stable_sort(facets, {}, &Facet::depth);
  for (const Facet& facet : facets) {
    canvas.area(facet.corners, heat(facet.radius));
    canvas.line(facet.corners, heat(0.93 * facet.radius), 0.6);
  }
}

void draw_axes(Canvas& canvas, Dot middle, double size) {
  const std::array<std::pair<Vec3, const char*>, 3> axes = {{{{1, 0, 0}, "x"}, {{0, 1, 0}, "y"}, {{0, 0, 1}, "z"}}};
  for (const auto& [axis, name] : axes) {
    const Vec3 end = seen_from_front(axis);
    const Dot tip{middle.x + size * end.x, middle.y - size * end.y};
    canvas.line(std::array<Dot, 2>{{middle, tip}}, kFaint, 1.5);
    canvas.text({tip.x + 8 * end.x, tip.y - 8 * end.y + 4}, name, kSize, kInk, Align::centre, true);
  }
}

// `right` and `up` are the directions on the sheet.
void draw_polar(Canvas& canvas, Dot middle, double size, const Directivity& directivity, const Scale& scale, Vec3 right,
                Vec3 up, const std::array<const char*, 2>& names) {
  constexpr int kSteps = 360;
  const auto ring = [&](const std::function<double(Vec3)>& radius, Colour colour, double width) {
    std::vector<Dot> curve;
    for (int n = 0; n <= kSteps; ++n) {
      const double angle = n * kTurn / kSteps;
      const double r = size * radius(std::cos(angle) * right + std::sin(angle) * up);
      curve.push_back({middle.x + r * std::cos(angle), middle.y - r * std::sin(angle)});
    }
    canvas.line(curve, colour, width);
  };
  for (double below_db = 0; below_db < kRange_db; below_db += 10) {
    const double radius = 1 - below_db / kRange_db;
    ring([radius](Vec3) { return radius; }, kGrid, 1);
    canvas.text({middle.x + 3, middle.y - size * radius - 3}, formatted("{:.0f}", 0 - below_db), 10, kFaint);
  }
  canvas.line(std::array<Dot, 2>{{{middle.x - size, middle.y}, {middle.x + size, middle.y}}}, kGrid, 1);
  canvas.line(std::array<Dot, 2>{{{middle.x, middle.y - size}, {middle.x, middle.y + size}}}, kGrid, 1);
  ring([&](Vec3 to) { return scale.radius(directivity.level_db(to)); }, kBlue, 2);
  canvas.text({middle.x + size + 6, middle.y + 4}, names[0], kSize, kInk, Align::left, true);
  canvas.text({middle.x - 10, middle.y - size - 4}, names[1], kSize, kInk, Align::right, true);
}

double loudest_of(const Directivity& directivity) {
  constexpr int kDirections = 4000;
  double top = -1e300;
  for (int i = 0; i < kDirections; ++i) {  // a spiral of directions that divides the sphere evenly
    const double z = 1 - (2 * i + 1.0) / kDirections, turn = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double across = std::sqrt(1 - z * z);
    top = std::max(top, directivity.level_db({across * std::cos(turn), across * std::sin(turn), z}));
  }
  return top;
}

}  // namespace

std::string draw_directivity(Canvas::Kind kind, const modal::Bank& bank, const Directivity& directivity,
                             const std::string& title) {
  Canvas canvas(kind, kWidth, kHeight);
  const Scale scale{loudest_of(directivity)};
  canvas.text({40, 40}, clean_text(bank.name.empty() ? "bank" : bank.name) + "  ·  " + title, 20, kInk, Align::left,
              true);
  canvas.text({40, 62},
              formatted("sound pressure by direction; the outer circle is the loudest direction, {:.1f} dB above the "
                        "mean, the middle {:.0f} dB less",
                        scale.top_db, kRange_db),
              13, kFaint);
  const Dot middle{340, 395};
  draw_axes(canvas, middle, 290);
  draw_balloon(canvas, middle, 250, directivity, scale);
  constexpr double kPlot = 90;
  draw_polar(canvas, {880, 180}, kPlot, directivity, scale, {1, 0, 0}, {0, 1, 0}, {"x", "y"});
  draw_polar(canvas, {880, 390}, kPlot, directivity, scale, {1, 0, 0}, {0, 0, 1}, {"x", "z"});
  draw_polar(canvas, {880, 600}, kPlot, directivity, scale, {0, 1, 0}, {0, 0, 1}, {"y", "z"});
  return std::move(canvas).finish();
}

}  // namespace ringdown::cli
