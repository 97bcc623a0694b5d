#include "tests/bench/mixer/row.h"

#include "engine/base/atomic_file.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <sstream>

namespace ringdown::bench {
namespace {

struct Field {
  const char* name;
  double Row::*value;
  const char* shown;  // with its unit
};
constexpr std::array kFields = {Field{"time_s", &Row::time_s, "at %.3g s"},
                                Field{"count", &Row::count, "%.0f of them"},
                                Field{"modes_per_core", &Row::modes_per_core, "%.0f modes per core"},
                                Field{"mean_us", &Row::mean_us, "mean %.3g us"},
                                Field{"p50_us", &Row::p50_us, "p50 %.3g us"},
                                Field{"p99_us", &Row::p99_us, "p99 %.3g us"},
                                Field{"max_us", &Row::max_us, "max %.3g us"},
                                Field{"bytes_per_mode", &Row::bytes_per_mode, "%.0f bytes per mode"},
                                Field{"ratio", &Row::ratio, "%.2f x"},
                                Field{"error_db", &Row::error_db, "%.1f dB"}};

std::string text(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, format, value);
  return buffer;
}

// A name as a field of CSV: in quotes, since it may hold commas.
std::string field(const std::string& name) {
  std::string quoted = "\"";
  for (const char c : name) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + '"';
}

}  // namespace

void show(const Row& row) {
  std::printf("%-10s %-22s", row.part.c_str(), row.who.c_str());
  if (row.modes > 0) std::printf(" %6zu modes", row.modes);
  if (row.objects > 1) std::printf(" %4zu objects", row.objects);
  if (row.block > 0) std::printf(" block %3zu", row.block);
  if (!row.ok()) std::printf("  %s", row.status.c_str());
  for (const Field& field : kFields) {
    if (!std::isnan(row.*field.value)) std::printf("  %s", text(field.shown, row.*field.value).c_str());
  }
  std::printf("\n");
  std::fflush(stdout);
}

Result<void> write_csv(const std::filesystem::path& path, const Rows& rows, const std::string& machine) {
  std::ostringstream csv;
  csv << "part,who,modes,objects,block,status";
  for (const Field& field : kFields) csv << ',' << field.name;
  csv << ",machine\n";
  for (const Row& row : rows) {
    csv << row.part << ',' << field(row.who) << ',' << row.modes << ',' << row.objects << ',' << row.block << ','
        << field(row.status);
    for (const Field& field : kFields) {
      csv << ',' << (std::isnan(row.*field.value) ? "" : text("%.6g", row.*field.value));
    }
    csv << ',' << field(machine) << '\n';
  }
  return write_file_atomically(path, csv.str());
}

}  // namespace ringdown::bench
