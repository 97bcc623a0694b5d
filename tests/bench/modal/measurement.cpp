#include "tests/bench/modal/measurement.h"

#include "engine/base/atomic_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <set>
#include <sstream>

namespace ringdown::bench {
namespace {

struct Field {
  const char* name;
  double Measurement::*value;
};
constexpr std::array kFields = {
    Field{"seconds", &Measurement::seconds},           Field{"factor_s", &Measurement::factor_s},
    Field{"iterate_s", &Measurement::iterate_s},       Field{"assemble_s", &Measurement::assemble_s},
    Field{"processor_s", &Measurement::processor_s},   Field{"peak_mib", &Measurement::peak_mib},
    Field{"error_10_percent", &Measurement::error_10}, Field{"error_50_percent", &Measurement::error_50},
    Field{"difference", &Measurement::difference},     Field{"ratio", &Measurement::ratio}};

constexpr std::array kStatusNames = {"ok", "not installed", "over limit", "failed"};

std::string number(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

bool measured_and_done(const Measurement* measurement) { return measurement && measurement->status == Status::kDone; }

}  // namespace

std::string Spec::key() const {
  return body + "_" + mesh + "_" + element + "_" + number(top_hz) + "_" + method + "_" + std::to_string(threads);
}

Spec Spec::by(const std::string& other_method, int with_threads) const {
  Spec other = *this;
  other.method = other_method;
  other.threads = with_threads;
  return other;
}

std::string to_lines(const Measurement& m) {
  std::ostringstream text;
  text << "status " << static_cast<int>(m.status) << "\ncomplaint " << m.complaint << "\nunknowns " << m.unknowns
       << "\nmodes " << m.modes << '\n';
  for (const Field& field : kFields) text << field.name << ' ' << number(m.*field.value) << '\n';
  return text.str();
}

Result<Measurement> from_lines(const std::string& text, const Spec& spec) {
  std::map<std::string, std::string> values;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t blank = line.find(' ');
    if (blank != std::string::npos) values[line.substr(0, blank)] = line.substr(blank + 1);
  }
  if (!values.contains("status") || !values.contains("ratio"))
    return fail(ErrorKind::refused, "said nothing of what it measured");
  const auto number_of = [&](const char* name) { return std::atof(values[name].c_str()); };
  Measurement m{.spec = spec};
  m.status = static_cast<Status>(std::clamp(static_cast<int>(number_of("status")), 0, 3));
  m.complaint = values["complaint"];
  m.unknowns = static_cast<long>(number_of("unknowns"));
  m.modes = static_cast<long>(number_of("modes"));
  for (const Field& field : kFields) m.*field.value = number_of(field.name);
  return m;
}

const Measurement* find(const Measurements& all, const Spec& spec) {
  const auto found = all.find(spec.key());
  return found == all.end() ? nullptr : &found->second;
}

void compare(Measurements& all, const std::filesystem::path& folder) {
  for (auto& [key, m] : all) {
    const Measurement* ours = find(all, m.spec.by("ours"));
    if (!measured_and_done(ours) || m.status == Status::kNotInstalled || m.status == Status::kFailed) continue;
    m.ratio = m.seconds / ours->seconds;
    if (m.status != Status::kDone) continue;
    const auto hz = read_frequencies(folder / (key + ".hz"));
    const Measurement* same_mass = find(all, m.spec.by("ccx-mass"));
    const Spec& other = m.spec.method == "ccx" && measured_and_done(same_mass) ? same_mass->spec : ours->spec;
    const auto other_hz = read_frequencies(folder / (other.key() + ".hz"));
    m.difference = worst_difference(hz, other_hz, other_hz.size());
  }
}

Result<void> write_csv(const std::filesystem::path& path, const std::vector<Spec>& order, const Measurements& all,
                       const std::string& machine) {
  std::ostringstream text;
  std::set<std::string> written;
  text << "part,case,mesh,element,top_hz,method,threads,status,unknowns,modes";
  for (const Field& field : kFields) text << ',' << field.name;
  text << ",machine\n";
  for (const Spec& spec : order) {
    const Measurement* m = find(all, spec);
    if (m == nullptr || !written.insert(spec.key()).second) continue;
    text << spec.part << ',' << spec.body << ',' << spec.mesh << ',' << spec.element << ',' << number(spec.top_hz)
         << ',' << spec.method << ',' << spec.threads << ',' << kStatusNames[static_cast<std::size_t>(m->status)] << ','
         << m->unknowns << ',' << m->modes;
    for (const Field& field : kFields) {
      const double value = m->*field.value;
      text << ',' << (value < 0 ? "" : number(value));
    }
    text << ',' << machine << '\n';
  }
  return write_file_atomically(path, text.str());
}

Result<void> write_frequencies(const std::filesystem::path& path, const std::vector<double>& hz) {
  std::ostringstream text;
  text.precision(15);
  for (const double f : hz) text << f << '\n';
  return write_file_atomically(path, text.str());
}

std::vector<double> read_frequencies(const std::filesystem::path& path) {
  std::vector<double> hz;
  std::ifstream file(path);
  for (double f; file >> f;) hz.push_back(f);
  return hz;
}

double worst_difference(const std::vector<double>& a, const std::vector<double>& b, std::size_t count) {
  if (a.size() < count || b.size() < count || count == 0) return -1;
  double worst = 0;
  for (std::size_t m = 0; m < count; ++m) worst = std::max(worst, std::abs(a[m] / b[m] - 1));
  return worst;
}

}  // namespace ringdown::bench
