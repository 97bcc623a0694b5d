#include "server/session/head.h"

#include <kiss_fftr.h>
#include <mysofa.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <complex>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <mutex>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

// From a head to filters, in the order of this file:
//
// 1. The head's responses are looked up in kDirections directions, spread evenly over the sphere, except directions
// near
//    which nothing was measured (usually below the head). The delay that all responses share is cut off (measure).
// 2. The spherical harmonics of these directions form a system of equations: the sum of the channels' filters, each
// times
//    the direction's gain in that channel, should equal the direction's response. The pseudo-inverse of the system has
//    one row for each channel (Fit).
// 3. The pseudo-inverse is applied to the responses at each frequency. From kPhasesTo_hz on, the phase of a response is
//    replaced by the filters' own phase in that direction at the previous frequency, minus the advance of the common
//    delay (filters_of).
namespace ringdown::session {
namespace {

using Complex = std::complex<double>;
using synth::kMaxAmbisonicChannels;

constexpr std::size_t kDirections = 240;
constexpr double kPhasesTo_hz = 2000;
constexpr double kLength_s = 0.004;     // length of a filter
constexpr double kBefore_s = 0.0004;    // part of it before a response's beginning, which the fit fills
constexpr double kToMiddle_s = 0.0003;  // from the nearest ear to the middle of the head
constexpr double kBegins = 0.02;        // share of the largest sample at which a response begins
constexpr double kNear_rad = 0.25;
constexpr std::size_t kMinDirections = kDirections / 2;
constexpr const char* kDefaultHead = "/usr/share/libmysofa/default.sofa";

// Returns point k of a spiral on the sphere; all points represent equal areas.
Vec3 direction(std::size_t k) {
  const double z = 1 - (2.0 * static_cast<double>(k) + 1) / kDirections;
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0)) * static_cast<double>(k), r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

// The responses of one head, from a set of directions to each ear.
struct Responses {
  std::size_t length = 0;
  std::vector<Vec3> directions;
  std::vector<float> samples;  // directions x 2 x length
  [[nodiscard]] const float* at(std::size_t k, std::size_t ear) const { return &samples[(2 * k + ear) * length]; }
};

struct SofaDeleter {
  void operator()(MYSOFA_EASY* sofa) const { mysofa_close(sofa); }
};
using Sofa = std::unique_ptr<MYSOFA_EASY, SofaDeleter>;

// Returns true if the head was measured near a direction.
bool knows(const MYSOFA_EASY& sofa, Vec3 towards) {
  std::array<float, 3> at = {static_cast<float>(towards.x), static_cast<float>(towards.y),
                             static_cast<float>(towards.z)};
  const float radius = sofa.lookup->radius_min;
  for (float& x : at) x *= radius;
  const int nearest = mysofa_lookup(sofa.lookup, at.data());
  const float* const there = sofa.hrtf->SourcePosition.values + 3 * nearest;
  const Vec3 measured{there[0], there[1], there[2]};
  return dot(measured, towards) > std::cos(kNear_rad) * length(measured);
}

Result<Responses> measure(const std::filesystem::path& path, double sample_rate_hz, std::size_t length) {
  int taps = 0, error = 0;
  const Sofa sofa(mysofa_open(path.c_str(), static_cast<float>(sample_rate_hz), &taps, &error));
  if (!sofa) {
    return fail(ErrorKind::bad_input,
                "{} is not a SOFA file of a head's impulse responses that libmysofa reads (its error {})",
                path.string(), error);
  }
  constexpr double kMaxDelay_s = 0.01;
  const std::size_t room = static_cast<std::size_t>(taps) + static_cast<std::size_t>(kMaxDelay_s * sample_rate_hz);
  Responses whole{room, {}, {}};
  for (std::size_t k = 0; k < kDirections; ++k) {
    if (knows(*sofa, direction(k))) whole.directions.push_back(direction(k));
  }
  const std::size_t count = whole.directions.size();
  if (count < kMinDirections) {
    return fail(ErrorKind::bad_input, path.string() + " has responses from less than half of all directions");
  }
  whole.samples.resize(count * 2 * room);
  std::vector<float> ear(static_cast<std::size_t>(taps)), other = ear;
  std::size_t first = room;
  for (std::size_t k = 0; k < count; ++k) {
    const Vec3& at = whole.directions[k];
    std::array<float, 2> delay_s{};
    mysofa_getfilter_float(sofa.get(), static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z),
                           ear.data(), other.data(), &delay_s[0], &delay_s[1]);
    for (std::size_t e = 0; e < 2; ++e) {
      const std::vector<float>& response = e == 0 ? ear : other;
      const double delay = std::clamp(delay_s[e] * sample_rate_hz, 0.0, kMaxDelay_s * sample_rate_hz);
      float* const to = &whole.samples[(2 * k + e) * room];
      std::copy_n(response.data(), taps, to + std::lround(delay));
      const float largest =
          std::abs(*std::max_element(to, to + room, [](float a, float b) { return std::abs(a) < std::abs(b); }));
      if (!std::isfinite(largest)) return fail(ErrorKind::bad_input, path.string() + ": a response is not finite");
      const auto begins = std::find_if(to, to + room, [&](float x) { return std::abs(x) > kBegins * largest; });
      first = std::min(first, static_cast<std::size_t>(begins - to));
    }
  }
  const auto before = static_cast<std::size_t>(kBefore_s * sample_rate_hz);
  Responses cut{length, whole.directions, std::vector<float>(count * 2 * length)};
  for (std::size_t i = 0; i < count * 2; ++i) {
    std::copy_n(&whole.samples[i * room + first], std::min(length - before, room - first),
                &cut.samples[i * length + before]);
  }
  return cut;
}

// Solves sum over c of gains[k][c] x_c = given_k for all directions k by least squares.
class Fit {
 public:
  explicit Fit(const std::vector<Vec3>& directions) {
    std::array<std::array<double, 2 * kMaxAmbisonicChannels>, kMaxAmbisonicChannels> rows{};
    for (std::size_t k = 0; k < directions.size(); ++k) {
      gains_.push_back(synth::encode(directions[k]));
      for (std::size_t a = 0; a < kMaxAmbisonicChannels; ++a) {
        for (std::size_t b = 0; b < kMaxAmbisonicChannels; ++b) rows[a][b] += gains_[k][a] * gains_[k][b];
      }
    }
    // Gauss-Jordan inversion of the normal matrix. The harmonics are nearly orthogonal, so no pivoting is needed.
    for (std::size_t a = 0; a < kMaxAmbisonicChannels; ++a) rows[a][kMaxAmbisonicChannels + a] = 1;
    for (std::size_t a = 0; a < kMaxAmbisonicChannels; ++a) {
      const double pivot = rows[a][a];
      for (double& x : rows[a]) x /= pivot;
      for (std::size_t b = 0; b < kMaxAmbisonicChannels; ++b) {
        const double share = b == a ? 0 : rows[b][a];
        for (std::size_t i = 0; i < rows[b].size(); ++i) rows[b][i] -= share * rows[a][i];
      }
    }
    for (std::size_t k = 0; k < directions.size(); ++k) {
      synth::AmbisonicGains& row = inverse_.emplace_back();
      for (std::size_t a = 0; a < kMaxAmbisonicChannels; ++a) {
        row[a] = 0;
        for (std::size_t b = 0; b < kMaxAmbisonicChannels; ++b)
          row[a] += rows[a][kMaxAmbisonicChannels + b] * gains_[k][b];
      }
    }
  }

  using Spectrum = std::array<Complex, kMaxAmbisonicChannels>;  // one value per channel, at one frequency
  [[nodiscard]] Spectrum solve(const std::vector<Complex>& given) const {
    Spectrum x{};
    for (std::size_t k = 0; k < given.size(); ++k) {
      for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) x[c] += inverse_[k][c] * given[k];
    }
    return x;
  }
  [[nodiscard]] Complex heard(std::size_t k, const Spectrum& x) const {
    Complex sum = 0;
    for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) sum += gains_[k][c] * x[c];
    return sum;
  }

 private:
  std::vector<synth::AmbisonicGains> gains_, inverse_;  // one entry per direction
};

std::shared_ptr<const synth::HeadFilters> filters_of(const Responses& responses, double sample_rate_hz) {
  const std::size_t length = responses.length;
  std::size_t frame = 1;
  while (frame < 2 * length) frame *= 2;
  const std::size_t bins = frame / 2 + 1;
  // The decrease in phase from one frequency to the next of sound at the middle of the head.
  const double step = 2 * std::numbers::pi * (kBefore_s + kToMiddle_s) * sample_rate_hz / static_cast<double>(frame);
  const Fit fit(responses.directions);
  auto filters = std::make_shared<synth::HeadFilters>();
  filters->taps = length;
  kiss_fftr_cfg forward = kiss_fftr_alloc(static_cast<int>(frame), 0, nullptr, nullptr);
  kiss_fftr_cfg back = kiss_fftr_alloc(static_cast<int>(frame), 1, nullptr, nullptr);
  std::vector<float> wave(frame);
  std::vector<kiss_fft_cpx> spectrum(bins);
  for (std::size_t ear = 0; ear < 2; ++ear) {
    std::vector<std::vector<Complex>> given(bins, std::vector<Complex>(responses.directions.size()));
    for (std::size_t k = 0; k < responses.directions.size(); ++k) {
      std::ranges::fill(wave, 0.0f);
      std::copy_n(responses.at(k, ear), length, wave.begin());
      kiss_fftr(forward, wave.data(), spectrum.data());
      for (std::size_t f = 0; f < bins; ++f) given[f][k] = {spectrum[f].r, spectrum[f].i};
    }
    std::vector<Fit::Spectrum> found(bins);
    for (std::size_t f = 0; f < bins; ++f) {
      const double frequency_hz = static_cast<double>(f) * sample_rate_hz / static_cast<double>(frame);
      if (f > 0 && frequency_hz > kPhasesTo_hz) {
        for (std::size_t k = 0; k < responses.directions.size(); ++k) {
          given[f][k] = std::polar(std::abs(given[f][k]), std::arg(fit.heard(k, found[f - 1])) - step);
        }
      }
      found[f] = fit.solve(given[f]);
    }
    std::vector<float>& reversed = filters->reversed[ear];
    reversed.resize(kMaxAmbisonicChannels * length);
    for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) {
      for (std::size_t f = 0; f < bins; ++f) {
        spectrum[f] = {static_cast<float>(found[f][c].real()), static_cast<float>(found[f][c].imag())};
      }
      kiss_fftri(back, spectrum.data(), wave.data());
      const std::size_t fade = length / 8;
      for (std::size_t n = 0; n < length; ++n) {
        const double left = static_cast<double>(length - n) / static_cast<double>(fade);
        const double share = left < 1 ? 0.5 - 0.5 * std::cos(std::numbers::pi * left) : 1.0;
        reversed[c * length + length - 1 - n] = static_cast<float>(share * wave[n] / static_cast<double>(frame));
      }
    }
  }
  std::free(forward);
  std::free(back);
  return filters;
}

// Scales the filters so that both ears together get mean energy 1 from a unit impulse, averaged over directions.
void normalise(synth::HeadFilters& filters) {
  double energy = 0;
  for (std::size_t k = 0; k < kDirections; ++k) {
    const synth::AmbisonicGains gains = synth::encode(direction(k));
    for (const std::vector<float>& ear : filters.reversed) {
      for (std::size_t n = 0; n < filters.taps; ++n) {
        double sum = 0;
        for (std::size_t c = 0; c < kMaxAmbisonicChannels; ++c) sum += gains[c] * ear[c * filters.taps + n];
        energy += sum * sum / kDirections;
      }
    }
  }
  const auto gain = static_cast<float>(1 / std::sqrt(energy));
  for (std::vector<float>& ear : filters.reversed) {
    for (float& tap : ear) tap *= gain;
  }
}

Result<std::shared_ptr<const synth::HeadFilters>> make_filters(const std::filesystem::path& path, double rate_hz) {
  const auto responses = measure(path, rate_hz, static_cast<std::size_t>(std::ceil(kLength_s * rate_hz)));
  if (!responses) return fail(responses);
  auto filters = std::make_shared<synth::HeadFilters>(*filters_of(*responses, rate_hz));
  normalise(*filters);
  return filters;
}

// The filters that were computed, for each sample rate.
class Head {
 public:
  explicit Head(std::filesystem::path path) : path_(std::move(path)) {}

  Result<std::shared_ptr<const synth::HeadFilters>> at(double rate_hz) {
    const std::scoped_lock lock(mutex_);
    if (const auto known = filters_.find(rate_hz); known != filters_.end()) return known->second;
    auto made = make_filters(path_, rate_hz);
    if (made) filters_[rate_hz] = *made;
    return made;
  }

 private:
  const std::filesystem::path path_;
  std::mutex mutex_;
  std::map<double, std::shared_ptr<const synth::HeadFilters>> filters_;
};

}  // namespace

Result<synth::HeadLoader> read_head(const std::filesystem::path& sofa) {
  const std::filesystem::path path = sofa.empty() ? std::filesystem::path(kDefaultHead) : sofa;
  if (std::ifstream file(path); !file) {
    return fail(ErrorKind::bad_input, "cannot open {}: {}", path.string(), std::strerror(errno));
  }
  auto head = std::make_shared<Head>(path);
  constexpr double kUsual_hz = 48000;
  if (const auto tried = head->at(kUsual_hz); !tried) return fail(tried);
  return [head](double rate_hz) { return head->at(rate_hz).value_or(nullptr); };
}

}  // namespace ringdown::session
