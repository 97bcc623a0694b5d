#include "engine/mesh/files/inp_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <map>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

namespace ringdown::mesh {
namespace {

constexpr std::size_t kMaxType = 20;  // in a sentence
constexpr std::string_view kBlank = " \t\r\f\v";
constexpr std::string_view kOnlyTetrahedra = "only tetrahedra are understood (C3D4, C3D10), so mesh it with those";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// The text in capitals, without blanks and quotes: the form in which keywords and their parameters are compared.
std::string squeezed(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c != '"' && kBlank.find(c) == kBlank.npos)
      out += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return out;
}

// The fields of a line, separated by commas outside quotes. A comma at the end opens no field.
std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  std::size_t start = 0;
  bool quoted = false;
  for (std::size_t at = 0; at < line.size(); ++at) {
    if (line[at] == '"') quoted = !quoted;
    if (line[at] != ',' || quoted) continue;
    fields.push_back(trimmed(line.substr(start, at - start)));
    start = at + 1;
  }
  if (const std::string_view last = trimmed(line.substr(start)); !last.empty()) fields.push_back(last);
  return fields;
}

bool read_number(std::string_view word, std::int64_t& number) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  return error == std::errc() && end == word.data() + word.size() && number > 0;
}

// Fortran's exponents begin with D.
bool read_coordinate(std::string_view word, double& number) {
  if (word.starts_with('+')) word.remove_prefix(1);
  std::string plain(word);
  std::replace_if(
      plain.begin(), plain.end(), [](char c) { return c == 'd' || c == 'D'; }, 'e');
  const auto [end, error] = std::from_chars(plain.data(), plain.data() + plain.size(), number);
  return error == std::errc() && end == plain.data() + plain.size() && std::isfinite(number);
}

struct Keyword {
  std::string name;
  std::map<std::string, std::string> parameters;
  int line = 0;

  [[nodiscard]] std::string parameter(const std::string& parameter) const {
    const auto found = parameters.find(parameter);
    return found == parameters.end() ? "" : found->second;
  }
};

// The lines that are neither empty nor comments, one at a time.
class Deck {
 public:
  Deck(std::string_view text, std::string name) : text_(text), name_(std::move(name)) { advance(); }

  void advance() {
    do {
      if (at_ >= text_.size()) {
        line_ = {};
        return;
      }
      const std::size_t end = std::min(text_.find('\n', at_), text_.size());
      line_ = trimmed(text_.substr(at_, end - at_));
      at_ = end + 1;
      ++number_;
    } while (line_.empty() || line_.starts_with("**"));
  }

  [[nodiscard]] bool done() const { return line_.empty(); }
  [[nodiscard]] bool at_keyword() const { return line_.starts_with('*'); }
  [[nodiscard]] bool at_data() const { return !done() && !at_keyword(); }
  [[nodiscard]] std::string_view line() const { return line_; }
  [[nodiscard]] int number() const { return number_; }

  // The keyword at this line, and on past it. It goes on after a comma where a parameter follows.
  Keyword take_keyword() {
    Keyword keyword{"", {}, number_};
    std::string whole(line_.substr(1));
    advance();
    while (whole.ends_with(',') && at_data() && std::isalpha(static_cast<unsigned char>(line_.front()))) {
      whole += line_;
      advance();
    }
    for (const std::string_view field : fields_of(whole)) {
      if (keyword.name.empty()) {
        keyword.name = squeezed(field);
      } else {
        const std::size_t equals = std::min(field.find('='), field.size());
        keyword.parameters.emplace(squeezed(field.substr(0, equals)),
                                   squeezed(field.substr(std::min(equals + 1, field.size()))));
      }
    }
    return keyword;
  }

  [[nodiscard]] tl::unexpected<Error> wrong(int line, const std::string& what) const {
    return fail(ErrorKind::bad_input, "{}, line {}: {}", name_, line, what);
  }
  [[nodiscard]] tl::unexpected<Error> wrong(const std::string& what) const {
    return fail(ErrorKind::bad_input, name_ + ": " + what);
  }

 private:
  std::string_view text_, line_;
  std::string name_;
  std::size_t at_ = 0;
  int number_ = 0;
};

// 4 of C3D4H, 10 of C3D10M; 0 of what is no tetrahedron.
int tetrahedron_nodes(std::string_view type) {
  if (type.starts_with("DC3D")) type.remove_prefix(1);
  if (!type.starts_with("C3D")) return 0;
  int nodes = 0;
  std::from_chars(type.data() + 3, type.data() + type.size(), nodes);
  return nodes == 4 || nodes == 10 ? nodes : 0;
}

// Points, lines and areas. SC6R and SC8R are shells by name, but bodies.
bool is_lower_dimensional(std::string_view type) {
  constexpr std::array<std::string_view, 44> kBeginnings = {
      "S3",   "S4",  "S6",    "S8",    "S9",    "STRI",   "SAX",     "SFM",  "DS",      "M3D",  "MAX",
      "MGAX", "CPS", "CPE",   "CAX",   "CGAX",  "R2D",    "R3D",     "RAX",  "RB",      "B2",   "B3",
      "T2D",  "T3D", "PIPE",  "ELBOW", "FRAME", "SPRING", "DASHPOT", "MASS", "ROTARYI", "CONN", "GAP",
      "ITS",  "ITT", "JOINT", "DC1D",  "DC2D",  "DCAX",   "DCOUP",   "AC1D", "AC2D",    "ACAX", "HEATCAP"};
  return std::any_of(kBeginnings.begin(), kBeginnings.end(), [type](auto begin) { return type.starts_with(begin); });
}

bool is_generator(const std::string& name) {
  constexpr std::array kGenerators = {"NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYMMETRICMODELGENERATION"};
  return std::find(kGenerators.begin(), kGenerators.end(), name) != kGenerators.end();
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& name) : deck_(text, name) {}

  Result<TetMesh> read() {
    while (!deck_.done()) {
      if (deck_.at_data()) {  // of a keyword that is passed over
        deck_.advance();
        continue;
      }
      const Keyword keyword = deck_.take_keyword();
      if (keyword.name == "STEP") break;
      if (auto read = follow(keyword); !read) return fail(read);
    }
    return assemble();
  }

 private:
  enum class Within { kModel, kPart, kAssembly, kInstance };

  Result<void> follow(const Keyword& keyword) {
    const std::string& name = keyword.name;
    if (name == "NODE") return read_nodes(keyword);
    if (name == "ELEMENT") return read_elements(keyword);
    if (name == "INCLUDE") return deck_.wrong(keyword.line, "*INCLUDE is not followed; write one file");
    if (is_generator(name)) {
      return deck_.wrong(keyword.line,
                         "*" + name + " is not followed; generate nodes and elements in the program that wrote it");
    }
    if (name == "SYSTEM") return deck_.wrong(keyword.line, "*SYSTEM is not followed; write all nodes in one frame");
    return enter(keyword);
  }

  Result<void> enter(const Keyword& keyword) {
    const std::string& name = keyword.name;
    if (name == "PART") {
      if (part_line_ > 0) return deck_.wrong(keyword.line, "this is a second *PART; write each part into its own file");
      part_line_ = keyword.line;
      part_ = keyword.parameter("NAME");
      within_ = Within::kPart;
    } else if (name == "INSTANCE") {
      return enter_instance(keyword);
    } else if (name == "ASSEMBLY" || name == "ENDINSTANCE") {
      within_ = Within::kAssembly;
    } else if (name == "ENDPART" || name == "ENDASSEMBLY") {
      within_ = Within::kModel;
    }
    return {};
  }

  Result<void> enter_instance(const Keyword& keyword) {
    if (has_instance_) {
      return deck_.wrong(keyword.line, "this is a second *INSTANCE; write a file with one part and one instance");
    }
    if (part_line_ == 0 || keyword.parameter("PART") != part_) {
      return deck_.wrong(keyword.line, "*INSTANCE should name the one *PART before it");
    }
    if (deck_.at_data()) {
      return deck_.wrong(deck_.number(), "this *INSTANCE is moved, which is not followed; write it where it lies");
    }
    has_instance_ = true;
    within_ = Within::kInstance;
    return {};
  }

  Result<void> read_nodes(const Keyword& keyword) {
    if (within_ == Within::kAssembly) return {};  // reference points, numbered on their own
    if (keyword.parameters.contains("INPUT")) {
      return deck_.wrong(keyword.line, "INPUT= is not followed; write one file");
    }
    if (const std::string system = keyword.parameter("SYSTEM"); !system.empty() && system != "R") {
      return deck_.wrong(keyword.line, "SYSTEM=" + system + " is not followed; write rectangular coordinates");
    }
    for (; deck_.at_data(); deck_.advance()) {
      if (auto read = read_node(); !read) return read;
    }
    return {};
  }

  // Beside three coordinates the line may hold the direction of a shell.
  Result<void> read_node() {
    constexpr std::size_t kMaxNumbers = 7;
    const std::vector<std::string_view> fields = fields_of(deck_.line());
    std::int64_t number = 0;
    if (fields.empty() || !read_number(fields[0], number)) {
      return deck_.wrong(deck_.number(), "a node should begin with its number, which is positive");
    }
    std::array<double, 3> place{};
    bool good = fields.size() >= 2 && fields.size() <= kMaxNumbers;
    for (std::size_t k = 1; k < std::min<std::size_t>(fields.size(), 4); ++k) {
      good = good && (fields[k].empty() || read_coordinate(fields[k], place[k - 1]));
    }
    if (!good) {
      return deck_.wrong(deck_.number(), "a node should have up to three finite coordinates, with commas between");
    }
    const auto [node, is_new] = nodes_.emplace(number, static_cast<std::int32_t>(places_.size()));
    if (is_new) {
      places_.push_back(place);
    } else if (places_[node->second] != place) {
      return deck_.wrong(deck_.number(), formatted("node {} appears a second time, at another place", number));
    }
    return {};
  }

  Result<void> read_elements(const Keyword& keyword) {
    const std::string type = keyword.parameter("TYPE").substr(0, kMaxType);
    if (type.empty()) return deck_.wrong(keyword.line, "*ELEMENT should say its TYPE");
    if (is_lower_dimensional(type)) {
      if (passed_over_.empty()) passed_over_ = type;
      return {};
    }
    const int nodes = tetrahedron_nodes(type);
    if (nodes == 0) {
      return deck_.wrong(keyword.line, formatted("elements are of type {}; {}", type, kOnlyTetrahedra));
    }
    if (within_ == Within::kAssembly) {
      return deck_.wrong(keyword.line, "solid elements should be in the part, not in the assembly");
    }
    if (keyword.parameters.contains("INPUT")) {
      return deck_.wrong(keyword.line, "INPUT= is not followed; write one file");
    }
    if (per_element_ != 0 && per_element_ != nodes) {
      return deck_.wrong(keyword.line, "tetrahedra of 4 and of 10 nodes are mixed; give all of them the same order");
    }
    per_element_ = nodes;
    while (deck_.at_data()) {
      if (auto read = read_element(); !read) return read;
    }
    return {};
  }

  Result<void> read_element() {
    const int line = deck_.number();
    const auto wanted = static_cast<std::size_t>(per_element_) + 1;
    std::vector<std::int64_t> numbers;
    for (bool on = true; on && numbers.size() < wanted && deck_.at_data(); deck_.advance()) {
      for (const std::string_view field : fields_of(deck_.line())) {
        if (!read_number(field, numbers.emplace_back())) {
          return deck_.wrong(deck_.number(), "an element should have positive whole numbers, with commas between");
        }
      }
      on = deck_.line().ends_with(',');
    }
    if (numbers.size() != wanted) {
      return deck_.wrong(
          line,
          formatted("an element should have its number and {} nodes, with a comma where it continues in the next line",
                    per_element_));
    }
    if (!elements_.insert(numbers[0]).second) {
      return deck_.wrong(line, formatted("element {} appears a second time", numbers[0]));
    }
    element_lines_.push_back(line);
    element_nodes_.insert(element_nodes_.end(), numbers.begin() + 1, numbers.end());
    return {};
  }

  // Abaqus's order of nodes is that of tet_element.h up to order 2.
  Result<TetMesh> assemble() const {
    if (part_line_ > 0 && !has_instance_) return deck_.wrong(part_line_, "this *PART has no *INSTANCE");
    if (places_.empty()) return deck_.wrong("has no *NODE; only .inp decks of Abaqus and CalculiX are supported");
    if (element_lines_.empty()) {
      return deck_.wrong(formatted("has no tetrahedra{}; {}",
                                   passed_over_.empty() ? "" : ", but elements of type " + passed_over_,
                                   kOnlyTetrahedra));
    }
    TetMesh mesh;
    mesh.nodes.resize(static_cast<Eigen::Index>(places_.size()), 3);
    for (std::size_t n = 0; n < places_.size(); ++n) {
      for (int k = 0; k < 3; ++k) mesh.nodes(static_cast<Eigen::Index>(n), k) = places_[n][k];
    }
    mesh.elements.resize(static_cast<Eigen::Index>(element_lines_.size()), per_element_);
    std::size_t next = 0;
    for (Eigen::Index e = 0; e < mesh.elements.rows(); ++e) {
      for (int c = 0; c < per_element_; ++c) {
        const std::int64_t number = element_nodes_[next++];
        const auto node = nodes_.find(number);
        if (node == nodes_.end()) {
          return deck_.wrong(element_lines_[e], formatted("there is no node {}", number));
        }
        mesh.elements(e, c) = node->second;
      }
    }
    return mesh;
  }

  Deck deck_;
  Within within_ = Within::kModel;
  std::string part_, passed_over_;
  int part_line_ = 0, per_element_ = 0;
  bool has_instance_ = false;
  std::unordered_map<std::int64_t, std::int32_t> nodes_;
  std::vector<std::array<double, 3>> places_;
  std::unordered_set<std::int64_t> elements_;
  std::vector<std::int64_t> element_nodes_;
  std::vector<int> element_lines_;  // in which they begin
};

}  // namespace

Result<TetMesh> read_inp(std::string_view text, const std::string& name) { return Reader(text, name).read(); }

}  // namespace ringdown::mesh
