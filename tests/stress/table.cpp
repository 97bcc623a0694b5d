#include "tests/stress/table.h"

#include <cmath>
#include <cstdio>

namespace ringdown::test {
namespace {

std::string percent(double share) {
  if (std::isnan(share)) return "";
  char text[32];
  std::snprintf(text, sizeof text, share != 0 && share < 1e-5 ? "%.0e" : "%.3g", 100 * share);
  return text;
}

std::string markdown(const TableLine& line) {
  const bool solved = line.unknowns > 0;
  char seconds[32] = "";
  if (!std::isnan(line.seconds)) std::snprintf(seconds, sizeof seconds, "%.1f", line.seconds);
  std::string row = "| " + line.name + " | " + line.hard + " | ";
  row += solved ? std::to_string(line.unknowns) + " | " + std::to_string(line.found) + " / " +
                      std::to_string(line.there) + " | "
                : " | | ";
  return row + percent(line.error) + " | " + percent(line.limit) + " | " + percent(line.estimate) + " | " + seconds +
         " | " + line.outcome + " |";
}

}  // namespace

void enter(const TableLine& line) {
  enter_line(
      "| case | what is hard | unknowns | modes found / there | worst error % | allowed % | the bank's estimate % | "
      "seconds | outcome |\n|---|---|--:|--:|--:|--:|--:|--:|---|",
      markdown(line));
}

}  // namespace ringdown::test
