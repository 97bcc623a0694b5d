#include "clients/cli/fit/compare_page.h"

#include "engine/base/formatted.h"
#include "engine/fit/band_powers.h"
#include "engine/fit/burst.h"
#include "engine/fit/comparison.h"
#include "engine/modal/damping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace ringdown::cli {
namespace {

constexpr double kWidth = 760, kHeight = 220, kLeft = 46, kBottom = 26;
constexpr double kLow_hz = 60, kHigh_hz = 16000;
constexpr double kMaxDecay_s = 1.5;
constexpr const char* kRecorded = "#D55E00";
constexpr const char* kBaked = "#0072B2";

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

// A picture's frame, from numbers in 0..1 to places, and lines in it.
struct Picture {
  std::string body;
  static double x(double part) { return kLeft + part * (kWidth - kLeft - 8); }
  static double y(double part) { return 8 + (1 - part) * (kHeight - kBottom - 8); }

  void line(const std::vector<std::array<double, 2>>& points, const std::string& style) {
    body += "<polyline fill=\"none\" " + style + " points=\"";
    for (const auto& [px, py] : points) body += formatted("{:.1f},{:.1f} ", x(px), y(std::clamp(py, 0.0, 1.0)));
    body += "\"/>";
  }
  void mark_x(double part, const std::string& label) {
    body += formatted("<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/>", x(part),
                      x(part), y(0), y(1));
    body += formatted("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>", x(part), kHeight - 8, label);
  }
  void mark_y(double part, const std::string& label) {
    body += formatted("<line x1=\"{:.1f}\" x2=\"{:.1f}\" y1=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/>", x(0), x(1),
                      y(part), y(part));
    body += formatted("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>", kLeft - 4, y(part) + 4, label);
  }
  void label(double part, const std::string& text, const char* colour) {
    body += formatted("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"end\" fill=\"{}\">{}</text>", x(1) - 4,
                      y(part) + 12, colour, text);
  }
  [[nodiscard]] std::string svg() const {
    return formatted(
        "<svg viewBox=\"0 0 {:.0f} {:.0f}\" width=\"{:.0f}\" xmlns=\"http://www.w3.org/2000/svg\">{}</svg>\n", kWidth,
        kHeight, kWidth, body);
  }
};

std::span<const double> from_onset(const ComparedSound& s, double max_s) {
  const double rate = s.sound.sample_rate_hz;
  const auto count = s.sound.samples.size();
  const auto first = std::min(count, static_cast<std::size_t>(s.found.onset_s * rate));
  const auto last = std::min(count, static_cast<std::size_t>(std::min(s.found.end_s, s.found.onset_s + max_s) * rate));
  return std::span(s.sound.samples).subspan(first, std::max(last, first) - first);
}

std::string spectra(const ComparedSound& s) {
  constexpr std::size_t kPoints = 700;
  constexpr double kSpan_db = 90;
  const auto part = from_onset(s, 2);
  const std::vector<double> model = fit::synthesise(s.baked, s.sound.sample_rate_hz, part.size());
  const double high = std::min(kHigh_hz, 0.49 * s.sound.sample_rate_hz);
  const auto recorded = fit::spectrum_db(part, s.sound.sample_rate_hz, kLow_hz, high, kPoints);
  const auto baked = fit::spectrum_db(model, s.sound.sample_rate_hz, kLow_hz, high, kPoints);
  const double top = *std::ranges::max_element(recorded) + 5;
  Picture picture;
  for (const double hz : {100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0, 10000.0}) {
    picture.mark_x(std::log(hz / kLow_hz) / std::log(high / kLow_hz),
                   hz < 1000 ? formatted("{:.0f} Hz", hz) : formatted("{:.0f} k", hz / 1000));
  }
  for (int db = 0; db < kSpan_db; db += 20) picture.mark_y(1 - (db + 5) / kSpan_db, formatted("{}", -db));
  for (const auto& [levels, style] :
       {std::pair(&recorded, formatted("stroke=\"{}\" stroke-width=\"1\"", kRecorded)),
        std::pair(&baked, formatted("stroke=\"{}\" stroke-width=\"1\" stroke-opacity=\"0.8\"", kBaked))}) {
    std::vector<std::array<double, 2>> points;
    for (std::size_t i = 0; i < kPoints; ++i) {
      points.push_back({static_cast<double>(i) / kPoints, 1 - (top - (*levels)[i]) / kSpan_db});
    }
    picture.line(points, style);
  }
  return picture.svg();
}

constexpr std::array<const char*, 4> kOctaveColours = {"#56B4E9", "#009E73", "#E69F00", "#CC79A7"};

// Levels of every other octave over time. The recording's noise is added to what is baked, as in the distance.
std::string decays(const ComparedSound& s) {
  constexpr double kSpan_db = 70, kLabel_db = 5;
  constexpr std::size_t kFirst = 2, kStep = 6, kOctave = 3;  // bands
  const double rate = s.sound.sample_rate_hz;
  const auto part = from_onset(s, kMaxDecay_s);
  const auto recorded = fit::band_powers(part, rate, 0);
  const auto baked = fit::band_powers(fit::synthesise(s.baked, rate, part.size()), rate, 0);
  const auto noise = fit::band_noise(s.sound.samples, rate, static_cast<std::size_t>(s.found.onset_s * rate));
  const double length = std::max(fit::kCell_s * static_cast<double>(recorded.cells), fit::kCell_s);
  const double loudest = recorded.values.empty() ? 0 : fit::power_db(*std::ranges::max_element(recorded.values));
  Picture picture;
  const double step = length > 0.6 ? 0.2 : 0.05;
  for (double t = 0; t < length; t += step) picture.mark_x(t / length, formatted("{:.2f} s", t));
  for (int db = 0; db < kSpan_db; db += 20) picture.mark_y(1 - (db + 5) / kSpan_db, formatted("{}", -db));
  for (std::size_t octave = 0; octave < kOctaveColours.size(); ++octave) {
    const std::size_t first = kFirst + octave * kStep;
    if (first + kOctave > recorded.bands()) break;
    const std::string colour = formatted("stroke=\"{}\"", kOctaveColours[octave]);
    for (const auto& [powers, is_baked] : {std::pair(&recorded, false), std::pair(&baked, true)}) {
      std::vector<std::array<double, 2>> points;
      for (std::size_t c = 0; c < powers->cells; ++c) {
        double sum = 0;
        for (std::size_t b = first; b < first + kOctave; ++b) sum += powers->power(b, c) + (is_baked ? noise[b] : 0);
        const double level = 1 - (loudest + 5 - fit::power_db(sum)) / kSpan_db;
        points.push_back({fit::kCell_s * (static_cast<double>(c) + 0.5) / length, level});
      }
      picture.line(points, colour + (is_baked ? " stroke-width=\"1.8\" stroke-dasharray=\"5 3\"" : ""));
    }
    const double hz = recorded.centre_hz[first + 1];
    picture.label(1 - kLabel_db * static_cast<double>(octave) / kSpan_db,
                  hz < 950 ? formatted("{:.0f} Hz", hz) : formatted("{:.1f} kHz", hz / 1000), kOctaveColours[octave]);
  }
  return picture.svg();
}

std::string rows(const Comparison& c) {
  std::string text =
      "<table><tr><th>mode</th><th>recorded [Hz]</th><th>baked [Hz]</th><th>off [cents]</th><th>T60 recorded [s]</th>"
      "<th>T60 baked [s]</th></tr>\n";
  const double tuning = std::exp2(c.calibration.tuning_cents / 1200);
  for (const fit::Match& match : c.calibration.matches) {
    const fit::Mode& mode = c.heard[match.recorded];
    const double decay = fit::fitted_loss(c.calibration, c.bank, match.baked, mode.frequency_hz).total_per_s();
    text +=
        formatted("<tr><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:+.1f}</td><td>{:.3g}</td><td>{:.3g}</td></tr>\n",
                  match.baked, mode.frequency_hz, tuning * c.bank.frequency_hz[match.baked], match.off_cents,
                  modal::t60_s(mode.decay_per_s), modal::t60_s(decay));
  }
  return text + "</table>\n";
}

}  // namespace

double Comparison::stiffness() const { return std::exp2(calibration.tuning_cents / 600); }

double Comparison::mean_cents() const {
  double sum = 0;
  for (const fit::Match& match : calibration.matches) sum += std::abs(match.off_cents);
  return sum / static_cast<double>(std::max<std::size_t>(calibration.matches.size(), 1));
}

double Comparison::worst_cents() const {
  double worst = 0;
  for (const fit::Match& match : calibration.matches) worst = std::max(worst, std::abs(match.off_cents));
  return worst;
}

double Comparison::decay_error() const {
  double sum = 0;
  for (const fit::Match& match : calibration.matches) {
    if (!match.used) continue;
    const fit::Mode& mode = heard[match.recorded];
    const double decay = fit::fitted_loss(calibration, bank, match.baked, mode.frequency_hz).total_per_s();
    sum += std::abs(std::log(mode.decay_per_s / decay));
  }
  return std::expm1(sum / static_cast<double>(std::max<std::size_t>(calibration.used(), 1)));
}

double Comparison::matched_part() const {
  const auto energy = [](const fit::Mode& mode) { return mode.amplitude * mode.amplitude / mode.decay_per_s; };
  const auto is_matched = [&](const fit::Mode& mode) {
    return std::ranges::any_of(calibration.matches, [&](const fit::Match& match) {
      const double cents = 1200 * std::log2(mode.frequency_hz / heard[match.recorded].frequency_hz);
      return std::abs(cents) < fit::kCompanion_cents;
    });
  };
  double all = 0, matched = 0;
  for (const fit::Mode& mode : heard) {
    all += energy(mode);
    matched += is_matched(mode) ? energy(mode) : 0;
  }
  return all > 0 ? matched / all : 0;
}

namespace {

const char* judged(const Comparison& c) {
  struct Mark {
    double cents, part;
    const char* word;
  };
  constexpr std::array<Mark, 2> kMarks = {{{5, 0.9, "good"}, {15, 0.6, "fair"}}};
  for (const Mark& mark : kMarks) {
    if (c.mean_cents() <= mark.cents && c.matched_part() >= mark.part) return mark.word;
  }
  return "poor";
}

// True when what was fitted is hardly a matter of one material's samples.
bool is_far_from_material(const Comparison& c) {
  constexpr double kMaxStiffness = 1.25, kMaxNu = 0.15;
  return std::abs(std::log(c.stiffness())) > std::log(kMaxStiffness) ||
         std::abs(c.poisson_ratio - c.given_poisson_ratio) > kMaxNu;
}

}  // namespace

std::string verdict(const Comparison& c) {
  const std::size_t matches = c.calibration.matches.size(), aside = matches - c.calibration.used();
  std::string text =
      formatted(
          "verdict      {}: matching modes have {:.0f} % of the recorded energy, and are {:.1f} cents off on average\n",
          judged(c), 100 * c.matched_part(), c.mean_cents()) +
      formatted("{}: {} of the {} recorded modes match one of the bank's {}\n", c.name, matches, c.heard.size(),
                c.bank.mode_count()) +
      formatted("frequencies  {:.1f} cents off on average, {:.1f} at most, after E/rho and nu\n", c.mean_cents(),
                c.worst_cents()) +
      formatted("E/rho        {:.4f} times that of {}\n", c.stiffness(), c.material) +
      (c.nu_told ? formatted("nu           {:.3f}; the material says {:.3f}\n", c.poisson_ratio, c.given_poisson_ratio)
                 : formatted("nu           {:.3f} as the material says: the recordings do not determine it\n",
                             c.poisson_ratio)) +
      formatted("loss factor  {}; decays {:.0f} % off on average\n", c.calibration.text(), 100 * c.decay_error());
  if (aside > 0) {
    text +=
        formatted("             {} of the {} decay differently, as in a room or a hand, and are left out of this fit\n",
                  aside, matches);
  }
  if (is_far_from_material(c)) {
    text += formatted(
        "note         E/rho and nu are far from those of {}: a wall thicker or thinner than drawn has that effect, "
        "too\n",
        c.material);
  }
  for (const ComparedSound& s : c.sounds) text += formatted("distance     {:.1f} dB: {}\n", s.distance_db, s.name);
  return text;
}

std::string compare_page(const Comparison& c) {
  std::string text =
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" + escaped(c.name) +
      "</title>\n<style>body{font:15px sans-serif;max-width:800px;margin:2em auto}svg text{font:11px sans-serif}"
      "table{border-collapse:collapse}td,th{padding:2px 10px;text-align:right}tr:nth-child(even){background:#f4f4f4}"
      "pre{background:#f4f4f4;padding:8px}</style></head><body>\n<h1>" +
      escaped(c.name) + "</h1>\n<pre>" + escaped(verdict(c)) + "</pre>\n<p>" +
      formatted("<b style=\"color:{}\">recorded</b>, ", kRecorded) +
      formatted("<b style=\"color:{}\">baked</b>: ", kBaked) +
      "the bank's modes that match, in the fitted E/rho, nu and damping, as loud as in the recording.</p>\n";
  for (const ComparedSound& s : c.sounds) {
    text += formatted(
        "<h2>{}</h2>\n<p>Distance {:.1f} dB, in thirds of an octave by 10 ms. Spectrum [dB]:</p>\n{}<p>Decay of every "
        "other octave [dB]; dashed: baked, beside the recording's noise:</p>\n{}",
        escaped(s.name), s.distance_db, spectra(s), decays(s));
  }
  return text + "<h2>Modes</h2>\n" + rows(c) + "</body></html>\n";
}

}  // namespace ringdown::cli
