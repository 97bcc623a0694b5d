#include "clients/cli/fit/compare_page.h"

#include "clients/cli/fit/fitted_figures.h"
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

double cents_over(double a, double b) { return 1200 * std::log2(a / b); }

std::size_t recordings_of(const Comparison& c, const fit::Mode& mode) {
  constexpr double kSame_cents = 6;
  return static_cast<std::size_t>(std::ranges::count_if(c.sounds, [&](const ComparedSound& s) {
    return std::ranges::any_of(s.found.modes, [&](const fit::Mode& other) {
      return std::abs(cents_over(other.frequency_hz, mode.frequency_hz)) < kSame_cents;
    });
  }));
}

// Two stronger heard modes whose frequencies add up to that of `mode`, or differ by it, as they do where a microphone,
// a loose part or a contact is not linear.
bool is_combination(const Comparison& c, const fit::Mode& mode) {
  constexpr double kClose_cents = 3;
  for (const fit::Mode& a : c.heard) {
    for (const fit::Mode& b : c.heard) {
      if (a.amplitude <= mode.amplitude || b.amplitude <= mode.amplitude) continue;
      for (const double f : {a.frequency_hz + b.frequency_hz, a.frequency_hz - b.frequency_hz}) {
        if (f > 0 && std::abs(cents_over(f, mode.frequency_hz)) < kClose_cents) return true;
      }
    }
  }
  return false;
}

// Why a heard mode has no match, by what its pitch, its decay and its recordings show.
struct Unmatched {
  const fit::Mode* mode;
  std::string kind, text;
};

Unmatched reason_of(const Comparison& c, const fit::Mode& mode) {
  constexpr double kHeld = 3, kFew = 0.25;
  const double tuning = std::exp2(c.calibration.tuning_cents / 1200);
  for (const fit::Match& match : c.calibration.matches) {
    const double off = cents_over(mode.frequency_hz, c.heard[match.recorded].frequency_hz);
    if (std::abs(off) >= fit::kCompanion_cents) continue;
    return {&mode, "beside a match",
            formatted("{:+.0f} cents beside match {}: the other of a pair, which the real shape splits, or the room",
                      off, match.baked)};
  }
  const auto nearest = std::ranges::min_element(
      c.bank.frequency_hz, {}, [&](double f) { return std::abs(cents_over(mode.frequency_hz, tuning * f)); });
  const auto number = static_cast<std::size_t>(nearest - c.bank.frequency_hz.begin());
  const double material = fit::fitted_loss(c.calibration, c.bank, number, mode.frequency_hz).total_per_s();
  if (mode.decay_per_s > kHeld * material) {
    return {&mode, "held",
            formatted("dies {:.1f} times as fast as the material lets it: of a hand, the table or the room",
                      mode.decay_per_s / material)};
  }
  const std::size_t heard_in = recordings_of(c, mode);
  if (static_cast<double>(heard_in) <= kFew * static_cast<double>(c.sounds.size())) {
    return {&mode, "in few recordings",
            formatted("in {} of {} recordings: not of the body, which all of them hear", heard_in, c.sounds.size())};
  }
  if (is_combination(c, mode))
    return {&mode, "a combination", "the sum or difference of two stronger modes: something is not linear"};
  const double off = cents_over(mode.frequency_hz, tuning * *nearest);
  const double error = c.bank.frequency_error.empty() ? 0 : cents_over(1 + c.bank.frequency_error[number], 1);
  return {&mode, "missing",
          formatted("the nearest baked mode is {:+.0f} cents off, and its error by the mesh {:.1f} cents: the shape",
                    off, error)};
}

std::vector<Unmatched> unmatched(const Comparison& c) {
  std::vector<Unmatched> all;
  for (std::size_t m = 0; m < c.heard.size(); ++m) {
    if (std::ranges::none_of(c.calibration.matches, [&](const fit::Match& match) { return match.recorded == m; }))
      all.push_back(reason_of(c, c.heard[m]));
  }
  return all;
}

// "9 beside a match, 6 held", in the order in which the kinds first occur.
std::string counted(const std::vector<Unmatched>& all) {
  std::vector<std::pair<std::string, int>> kinds;
  for (const Unmatched& one : all) {
    const auto known = std::ranges::find(kinds, one.kind, &std::pair<std::string, int>::first);
    if (known == kinds.end()) {
      kinds.emplace_back(one.kind, 1);
    } else {
      ++known->second;
    }
  }
  std::string text;
  for (const auto& [kind, count] : kinds) text += formatted("{}{} {}", text.empty() ? "" : ", ", count, kind);
  return text;
}

std::string unmatched_rows(const Comparison& c) {
  const double loudest = std::ranges::max(c.heard, {}, &fit::Mode::amplitude).amplitude;
  std::string text =
      "<table><tr><th>recorded [Hz]</th><th>T60 [s]</th><th>level [dB]</th><th>recordings</th>"
      "<th style=\"text-align:left\">why it has no match</th></tr>\n";
  for (const Unmatched& one : unmatched(c)) {
    text += formatted(
        "<tr><td>{:.2f}</td><td>{:.3g}</td><td>{:.0f}</td><td>{}</td><td style=\"text-align:left\">{}</td></tr>\n",
        one.mode->frequency_hz, modal::t60_s(one.mode->decay_per_s), 20 * std::log10(one.mode->amplitude / loudest),
        recordings_of(c, *one.mode), one.text);
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

// The largest error of a frequency that the bank states.
double mesh_cents(const modal::Bank& bank) {
  const auto spread = modal::error_spread(bank.frequency_error);
  return spread ? cents_over(1 + spread->largest, 1) : 0;
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
      (c.chance
           ? formatted("chance       {:.1f} matches on average of lists with shifted modes; {:.0f} % of these have as "
                       "many\n",
                       c.chance->matches, 100 * c.chance->share)
           : std::string()) +
      (c.heard.size() > matches ? formatted("unmatched    {}\n", counted(unmatched(c))) : std::string()) +
      formatted(
          "frequencies  {:.1f} cents off on average, {:.1f} at most, after the fit; the mesh errs by {:.1f} at most\n",
          c.mean_cents(), c.worst_cents(), mesh_cents(c.bank)) +
      fitted_figures(c) +
      (c.decays_known
           ? formatted("loss factor  {}; decays {:.0f} % off on average\n", c.calibration.text(), 100 * c.decay_error())
           : std::string());
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
  return text + "<h2>Modes that match</h2>\n" + rows(c) + "<h2>Modes without a match</h2>\n" + unmatched_rows(c) +
         "</body></html>\n";
}

}  // namespace ringdown::cli
