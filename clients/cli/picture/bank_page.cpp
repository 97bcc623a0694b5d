#include "clients/cli/picture/bank_page.h"

#include "clients/cli/picture/bank_picture.h"
#include "clients/cli/picture/view_data.h"
#include "engine/base/note.h"
#include "engine/modal/damping.h"
#include "engine/modal/material_scale.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ringdown::cli {
namespace {

constexpr const char* kStyle = R"css(
body { font: 15px/1.45 system-ui, sans-serif; color: #21262f; background: #fff; max-width: 1120px; margin: 1.5em auto;
  padding: 0 1em; }
figure { margin: 0; } figure svg { width: 100%; height: auto; }
h1 { font-size: 1.4em; margin: 0 0 .4em; } h2 { font-size: 1.1em; margin: 1.6em 0 .4em; }
#view canvas { width: 100%; max-width: 720px; border: 1px solid #e2e5ea; border-radius: 6px; cursor: pointer;
  touch-action: none; display: block; }
#view label { margin-right: 1.5em; white-space: nowrap; }
.hint { color: #5c6470; font-size: .9em; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { text-align: right; padding: .15em .8em; border-bottom: 1px solid #eceef1; }
th { position: sticky; top: 0; background: #fff; } tbody tr { cursor: pointer; } tbody tr:hover { background: #f2f6fa; }
tr.chosen { background: #dcebf7; }
)css";

constexpr const char* kView = R"html(<div id="view">
<canvas width="900" height="600"></canvas>
<p><label>hard <input type="range" id="soft" min="0" max="100" value="23"> soft mallet</label>
<label><input type="checkbox" id="turn" checked> turn</label>
<label><input type="checkbox" id="move"> vibrate</label> <span id="struck"></span></p>
<p id="view-title"></p>
<p class="hint">Click or touch the object to strike it there. Drag to turn, wheel to zoom; arrow keys or a row of the
table choose the mode whose shape is shown.</p>
</div>
)html";

constexpr const char* kLinearOnly =
    "<p class=\"hint\">This page plays soft blows. A hard blow bends this object so far that its pitch moves, which "
    "ringdown render plays.</p>\n";

// Bytes of the character that begins with `lead`, 0 when none does.
std::size_t utf8_length(unsigned char lead) {
  return lead < 0x80                   ? 1
         : lead >= 0xC2 && lead < 0xE0 ? 2
         : lead >= 0xE0 && lead < 0xF0 ? 3
         : lead >= 0xF0 && lead < 0xF5 ? 4
                                       : 0;
}

std::string table_of(const modal::Bank& bank, const Answer& answer) {
  double loudest = 1e-300;
  for (const double a : answer.amplitude) loudest = std::max(loudest, std::abs(a));
  std::string rows =
      "<table><thead><tr><th>mode</th><th>frequency Hz</th><th>note</th><th>T60 s</th><th>decay 1/s</th><th>level at "
      "the point dB</th><th>error %</th></tr></thead>\n<tbody>\n";
  for (std::size_t m = 0; m < bank.mode_count(); ++m) {
    const double decay = bank.decay_per_s[m];
    const std::string error = bank.frequency_error.empty() ? "" : formatted("{:.2g}", 100 * bank.frequency_error[m]);
    rows += formatted(
        "<tr><td>{}</td><td>{:.3f}</td><td>{}</td><td>{}</td><td>{:.4g}</td><td>{:.1f}</td><td>{}</td></tr>\n", m,
        bank.frequency_hz[m], note_name(bank.frequency_hz[m]),
        decay > 0 ? formatted("{:.4g}", modal::t60_s(decay)) : "-", decay,
        20 * std::log10(std::abs(answer.amplitude[m]) / loudest + 1e-15), error);
  }
  return rows + "</tbody></table>\n";
}

std::string facts_of(const modal::Bank& bank) {
  std::string text;
  if (const auto& m = bank.material) {
    text += formatted("{}: E = {:.4g} Pa, nu = {:.3g}, rho = {:.5g} kg/m³, {}. ", escaped(m->name),
                      m->youngs_modulus_pa, m->poisson_ratio, m->density_kg_m3, modal::describe_damping(*m));
  }
  text += formatted("{} sample points, {} triangles. ", bank.point_count(), bank.triangles.size());
  if (!bank.provenance.generator.empty()) text += "Made by " + escaped(bank.provenance.generator) + ".";
  return "<p class=\"hint\">" + text + "</p>\n";
}

}  // namespace

std::string clean_text(std::string_view text) {
  std::string clean;
  for (std::size_t n = 0; n < text.size();) {
    const auto lead = static_cast<unsigned char>(text[n]);
    std::size_t count = utf8_length(lead);
    for (std::size_t k = 1; k < count; ++k) {
      if (n + k >= text.size() || (static_cast<unsigned char>(text[n + k]) & 0xC0) != 0x80) count = 0;
    }
    if (count == 0) {
      clean += "\xEF\xBF\xBD";
      ++n;
    } else if (lead < 0x20 || lead == 0x7F) {
      clean += ' ';
      ++n;
    } else {
      clean += text.substr(n, count);
      n += count;
    }
  }
  return clean;
}

std::string escaped(std::string_view text) {
  std::string safe;
  for (const char c : clean_text(text)) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string bank_page(const modal::Bank& bank, const Answer& answer) {
  const std::string picture = draw_answer(bank, answer);
  if (picture.empty()) return "";
  const std::string name = escaped(bank.name.empty() ? "bank" : bank.name);
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n" +
         std::string("<meta name=\"viewport\" content=\"width=device-width\">\n<title>") + name + "</title>\n<style>" +
         kStyle + "</style>\n</head>\n<body>\n<h1>" + name + "</h1>\n" + kView + (bank.nonlinear ? kLinearOnly : "") +
         "<h2>A blow</h2>\n<figure role=\"img\" aria-label=\"" + name + "\">\n" + picture.substr(picture.find("<svg")) +
         "</figure>\n<h2>Modes</h2>\n" + facts_of(bank) + table_of(bank, answer) +
         "<script type=\"application/json\" id=\"view-data\">" + view_data(bank) + "</script>\n<script>" +
         kDirectionScript + kSoundScript + "</script>\n<script>" + kViewScript + "</script>\n</body>\n</html>\n";
}

}  // namespace ringdown::cli
