// This file measures a machine's speed: ./run build --times compiles it beside the player and states build
// times in units of it, so that a quarter more is a quarter more on any machine. It never changes: a change would move
// every figure in seconds.tsv. It parses standard headers and instantiates and optimises templates, as the project
// does.
#include <algorithm>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <regex>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

namespace {

template <int kNumber>
struct Kind {
  std::string name = std::to_string(kNumber);
  std::vector<double> values;
};

template <int kNumber>
double work(std::map<std::string, Kind<kNumber>>& kinds, const std::function<double(double)>& apply) {
  double sum = 0;
  for (auto& [name, kind] : kinds) {
    std::ranges::sort(kind.values, std::greater{});
    for (const double value : kind.values) sum += apply(value * kNumber);
    std::unordered_map<std::string, double> seen;
    seen[kind.name + name] = sum;
    for (const auto& [key, value] : seen) kind.values.push_back(value + static_cast<double>(key.size()));
  }
  return sum;
}

template <int... kNumbers>
double all(std::integer_sequence<int, kNumbers...>) {
  double sum = 0;
  const auto one = [&]<int kNumber>(std::integral_constant<int, kNumber>) {
    std::map<std::string, Kind<kNumber>> kinds;
    kinds["a"].values = {1, 2, 3};
    sum += work<kNumber>(kinds, [&](double x) { return x + sum; });
  };
  (one(std::integral_constant<int, kNumbers>()), ...);
  return sum;
}

}  // namespace

int main(int argc, char** argv) {
  const std::regex words("([a-z]+)=([0-9.]+)");
  std::variant<double, std::string> result = all(std::make_integer_sequence<int, 24>());
  for (const std::string text : std::vector<std::string>(argv, argv + argc)) {
    std::smatch match;
    if (std::regex_match(text, match, words)) result = match[2].str();
  }
  std::visit([](const auto& value) { std::cout << value << "\n"; }, result);
}
