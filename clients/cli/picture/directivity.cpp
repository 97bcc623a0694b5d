#include "clients/cli/picture/directivity.h"

#include "clients/cli/picture/canvas.h"
#include "engine/base/quote.h"
#include "engine/modal/damping.h"
#include "engine/modal/radiation_map.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>

namespace ringdown::cli {
namespace {

std::optional<double> number_in(std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool whole = error == std::errc() && end == text.data() + text.size() && std::isfinite(number);
  return whole ? std::optional(number) : std::nullopt;
}

}  // namespace

Result<Sounding> sounding_of(const modal::Bank& bank, std::string_view text) {
  if (!bank.radiation)
    return fail(ErrorKind::refused, "the bank has no radiation maps; bake it again with `ringdown bake --radiation`");
  const std::size_t dash = text.find('-');
  if (dash == text.npos) {
    const auto number = number_in(text);
    const auto count = static_cast<double>(bank.mode_count());
    if (!number || *number < 0 || *number >= count || *number != std::floor(*number))
      return fail(ErrorKind::usage,
                  "--directivity takes the number of a mode, 0 to {}, or a band such as 500-2000, not {}",
                  bank.mode_count() - 1, quote(text));
    const auto mode = static_cast<std::size_t>(*number);
    return Sounding{{mode}, formatted("mode {}, {:.1f} Hz", mode, bank.frequency_hz[mode])};
  }
  const auto low = number_in(text.substr(0, dash)), high = number_in(text.substr(dash + 1));
  if (!low || !high || !(*low < *high))
    return fail(ErrorKind::usage, "--directivity takes a band as LOW-HIGH in Hz, not " + quote(text));
  Sounding sounding{{}, formatted("{:.5g} to {:.5g} Hz", *low, *high)};
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    if (bank.frequency_hz[m] >= *low && bank.frequency_hz[m] <= *high) sounding.modes.push_back(m);
  }
  if (sounding.modes.empty()) return fail(ErrorKind::bad_input, "no mode lies from " + sounding.title);
  return sounding;
}

Directivity::Directivity(const modal::Bank& bank, const Answer& blow, const Sounding& sounding) {
  for (const std::size_t m : sounding.modes) {
    const modal::FarField& field = bank.radiation->maps.modes[m];
    // The amplitude is 2 pi f times the modal velocity, to which the pressure is proportional.
    const double weight = sounding.modes.size() == 1 ? 1 : blow.amplitude[m] * blow.amplitude[m];
    const double rms = modal::rms(field);
    if (!(weight * rms > 0)) continue;
    parts_.push_back({&field, weight});
    degree_ = std::max(degree_, modal::degree_of(field));
    mean_ += weight * rms * rms;
  }
}

double Directivity::level_db(Vec3 direction) const {
  constexpr double kSilent_db = -200;
  std::array<float, modal::harmonic_count(modal::kMaxHarmonicDegree)> harmonics{};
  modal::real_harmonics(direction, degree_, harmonics);
  double square = 0;
  for (const Part& part : parts_)
    square += part.weight * static_cast<double>(std::norm(modal::far_field(*part.field, harmonics)));
  return square > 0 && mean_ > 0 ? std::max(10 * std::log10(square / mean_), kSilent_db) : kSilent_db;
}

std::string directivity_csv(const Directivity& directivity) {
  constexpr int kStep_deg = 5;
  constexpr double kDegree = std::numbers::pi / 180;
  std::string text = "azimuth_deg,elevation_deg,x,y,z,level_db\n";
  for (int elevation = -90; elevation <= 90; elevation += kStep_deg) {
    for (int azimuth = 0; azimuth < 360; azimuth += kStep_deg) {
      const double across = std::cos(elevation * kDegree);
      const Vec3 to{across * std::cos(azimuth * kDegree), across * std::sin(azimuth * kDegree),
                    std::sin(elevation * kDegree)};
      text += formatted("{},{},{:.9f},{:.9f},{:.9f},{:.4f}\n", azimuth, elevation, to.x, to.y, to.z,
                        directivity.level_db(to));
    }
  }
  return text;
}

}  // namespace ringdown::cli
