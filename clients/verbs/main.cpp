// Writes what has to be text in other languages for each verb: declarations in ringdown.h, the functions behind them,
// Python's methods and stubs, and C#. All of it follows from the rows of protocol/table.cpp.
//
//   ringdown_write_verbs SOURCE_DIR           writes
//   ringdown_write_verbs SOURCE_DIR --check   compares, and names the first file that differs
//
// Files with other content keep it: only the text between the lines that contain "<verbs>" and "</verbs>" is replaced.
#include "protocol/schema.h"

#include <cctype>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace ringdown::protocol {
namespace {

enum class Kind { number, index, object, vector, rotation };

// One parameter or member: a number, or the numbers of a vector or rotation.
struct Parameter {
  Kind kind = Kind::number;
  std::string name;     // "impulse_ns"
  std::string plain;    // "impulse"
  std::string literal;  // of the default; empty: required
  std::string meaning;  // a sentence, and the range
};

struct Function {
  std::string name;      // "strike_vertex"
  std::string verb;      // the C++ type
  std::string sentence;  // what it does
  bool of_object = true;
  std::vector<Parameter> parameters;  // without the object

  // Functions with many parameters take a struct, whose members have defaults.
  [[nodiscard]] bool has_struct() const { return parameters.size() > 3; }
  [[nodiscard]] std::string args() const { return "ringdown_" + name + "_args"; }
};

std::string number(double value) {
  std::ostringstream text;
  text.precision(10);
  text << value;
  std::string digits = text.str();
  if (const std::size_t e = digits.find('e'); e != digits.npos) {  // 1e+08 and 1e-06 as 1e8 and 1e-6
    const bool negative = digits[e + 1] == '-';
    digits = digits.substr(0, e + 1) + (negative ? "-" : "") + std::to_string(std::stoi(digits.substr(e + 2)));
  }
  return digits;
}

// "strike_vertex" -> "StrikeVertex", or with `first_small` "strikeVertex".
std::string camel(std::string_view name, bool first_small = false) {
  std::string camel;
  bool up = !first_small;
  for (const char c : name) {
    if (c == '_') {
      up = true;
    } else {
      camel += up ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
      up = false;
    }
  }
  return camel;
}

Parameter parameter_of(const ArgumentSpec& spec) {
  Parameter one;
  one.name = member_name(spec);
  one.plain = std::string(spec.group.empty() ? spec.name : spec.group);
  one.meaning = std::string(spec.sentence);
  if (!spec.group.empty()) {
    one.kind = spec.group == "rotation_wxyz" ? Kind::rotation : Kind::vector;
    if (one.kind == Kind::rotation) one.plain = "turn";
    if (one.kind == Kind::rotation) one.meaning = "How it is turned, as a unit quaternion.";
    return one;
  }
  if (spec.type == ValueType::object) {
    one.kind = Kind::object;
    return one;
  }
  if (spec.type == ValueType::integer) one.kind = Kind::index;
  if (spec.type == ValueType::number || spec.type == ValueType::integer) {
    one.meaning += " " + number(spec.min) + " ... " + number(spec.max);
    if (spec.optional) {
      const auto* real = std::get_if<double>(&spec.fallback);
      one.literal = real ? number(*real) : std::to_string(std::get<std::int32_t>(spec.fallback));
      one.meaning += ", default " + one.literal;
    }
    one.meaning += ".";
  }
  return one;
}

std::vector<Function> functions() {
  std::vector<Function> all;
  for (const AddressSpec& spec : verb_addresses()) {
    Function one;
    const std::string address(spec.address);
    one.of_object = spec.arguments_in_address() > 0;
    if (one.of_object) {
      one.name = address.substr(address.rfind('/') + 1);
    } else {
      for (const char c : address.substr(1)) one.name += c == '/' ? '_' : c;
    }
    one.verb = camel(one.name);
    one.sentence = std::string(spec.sentence);
    std::string_view group;
    for (std::size_t i = spec.arguments_in_address(); i < spec.arguments.size(); ++i) {
      const ArgumentSpec& argument = spec.arguments[i];
      if (argument.group.empty() || argument.group != group) one.parameters.push_back(parameter_of(argument));
      group = argument.group;
    }
    all.push_back(std::move(one));
  }
  return all;
}

// Lines of at most 118 columns that begin with `indent`, of words.
std::string wrapped(std::string_view text, const std::string& indent) {
  std::string lines, line = indent;
  std::istringstream words{std::string(text)};
  for (std::string word; words >> word;) {
    if (line.size() + 1 + word.size() > 118 && line != indent) {
      lines += line + "\n";
      line = indent;
    }
    line += (line == indent ? "" : " ") + word;
  }
  return lines + line;
}

// "before(a, b, c)after", with the list broken into lines where it is long.
std::string listed(const std::string& before, const std::vector<std::string>& items, const std::string& after) {
  const std::string indent(before.size() - (before.rfind('\n') == before.npos ? 0 : before.rfind('\n') + 1), ' ');
  std::string text = before;
  std::size_t column = indent.size();
  for (std::size_t i = 0; i < items.size(); ++i) {
    const std::string item = items[i] + (i + 1 < items.size() ? ", " : "");
    if (column + item.size() + after.size() > 118 && column > indent.size()) {
      while (text.back() == ' ') text.pop_back();
      text += "\n" + indent;
      column = indent.size();
    }
    text += item;
    column += item.size();
  }
  return text + after;
}

std::string c_type(const Parameter& one) {
  if (one.kind == Kind::vector) return "const double " + one.name + "[3]";
  if (one.kind == Kind::rotation) return "const double " + one.name + "[4]";
  return (one.kind == Kind::number ? "double " : "uint32_t ") + one.name;
}

std::string c_member(const Parameter& one) {
  if (one.kind == Kind::vector) return "double " + one.name + "[3];";
  if (one.kind == Kind::rotation) return "double " + one.name + "[4];";
  return (one.kind == Kind::number ? "double " : "uint32_t ") + one.name + ";";
}

std::string c_signature(const Function& function, const std::string& before, const std::string& after) {
  std::vector<std::string> parameters{"ringdown_mixer* mixer", "int64_t frame"};
  if (function.of_object) parameters.emplace_back("uint32_t object");
  if (function.has_struct()) {
    parameters.push_back("const " + function.args() + "* args");
  } else {
    for (const Parameter& one : function.parameters) parameters.push_back(c_type(one));
  }
  parameters.emplace_back("ringdown_error* error");
  return listed(before + "ringdown_result ringdown_" + function.name + "(", parameters, ")" + after);
}

std::string c_header() {
  std::string text;
  for (const Function& function : functions()) {
    std::string comment = function.sentence;
    if (!function.has_struct()) {
      for (const Parameter& one : function.parameters) comment += " " + one.name + ": " + one.meaning;
    }
    std::string lines = wrapped(comment, " * ");
    text += "/*" + lines.substr(2) + " */\n";
    if (function.has_struct()) {
      text += "typedef struct " + function.args() + " {\n  size_t size; /* sizeof the struct, as _init sets it */\n";
      for (const Parameter& one : function.parameters) {
        const std::string comments = wrapped(one.meaning, "   * ");
        text += formatted("  /*{} */\n  {}\n", comments.substr(4), c_member(one));
      }
      text += "} " + function.args() + ";\n";
      text +=
          "RINGDOWN_API void " + function.args() + "_init(" + function.args() + "* args, size_t size); /* [any] */\n";
    }
    text += c_signature(function, "RINGDOWN_API ", ";") + "\n\n";
  }
  return text;
}

// The values of a parameter as numbers, of `from` ("given->").
void add_numbers(const Parameter& one, const std::string& from, std::vector<std::string>& numbers) {
  const std::size_t count = one.kind == Kind::vector ? 3 : one.kind == Kind::rotation ? 4 : 1;
  for (std::size_t i = 0; i < count; ++i) {
    std::string name = from + one.name;
    if (count > 1) name += formatted("[{}]", i);
    const bool whole = one.kind == Kind::index || one.kind == Kind::object;
    numbers.push_back(whole ? "static_cast<double>(" + name + ")" : name);
  }
}

std::string c_source() {
  std::string text =
      "// The verbs as C functions. Written by ringdown_write_verbs (clients/verbs) from the rows of "
      "protocol/table.cpp.\n"
      "// clang-format off\n#include \"clients/library/play.h\"\n\nusing namespace "
      "ringdown;\nusing namespace ringdown::library;\n\n";
  for (const Function& function : functions()) {
    std::string from;
    std::string body;
    if (function.has_struct()) {
      from = "given->";
      text += "void " + function.args() + "_init(" + function.args() + "* args, size_t size) {\n  " + function.args() +
              " ours{};\n";
      for (const Parameter& one : function.parameters) {
        if (!one.literal.empty()) text += formatted("  ours.{} = {};\n", one.name, one.literal);
      }
      text += "  fill_in(args, size, ours);\n}\n\n";
      body += "  " + function.args() + " defaults{};\n  " + function.args() +
              "_init(&defaults, sizeof defaults);\n  const auto given = taken(args, defaults);\n"
              "  if (!given) return refuse(given.error(), error);\n";
    } else {
      std::vector<std::string> pointers;
      for (const Parameter& one : function.parameters) {
        if (one.kind == Kind::vector || one.kind == Kind::rotation) {
          pointers.push_back("{\"" + one.name + "\", " + one.name + "}");
        }
      }
      if (!pointers.empty()) {
        body += listed("  if (const char* name = first_null({", pointers, "})) {") +
                "\n    return refuse(missing(name).value(), error);\n  }\n";
      }
    }
    std::vector<std::string> numbers;
    if (function.of_object) numbers.emplace_back("static_cast<double>(object)");
    for (const Parameter& one : function.parameters) add_numbers(one, from, numbers);
    body += numbers.empty() ? "  const std::span<const double> numbers;\n"
                            : listed("  const double numbers[] = {", numbers, "};") + "\n";
    body += "  return play<synth::verb::" + function.verb + ">(mixer, frame, numbers, error);\n";
    text += c_signature(function, "", " {") + "\n" + body + "}\n\n";
  }
  text.pop_back();
  return text;
}

std::string python_signature_type(const Parameter& one) {
  if (one.kind == Kind::vector || one.kind == Kind::rotation) return "Numbers";
  return one.kind == Kind::number ? "float" : "int";
}

// Python has the required parameters first. Of functions with many the others are by name only.
std::vector<Parameter> in_order(const Function& function) {
  std::vector<Parameter> ordered;
  for (const bool optional : {false, true}) {
    for (const Parameter& one : function.parameters) {
      const bool has_default = !one.literal.empty() || one.kind == Kind::rotation;
      if (has_default == optional) ordered.push_back(one);
    }
  }
  return ordered;
}

bool is_optional(const Parameter& one) { return !one.literal.empty() || one.kind == Kind::rotation; }

std::string python_default(const Parameter& one) {
  if (one.kind == Kind::rotation) return "(1, 0, 0, 0)";
  if (one.kind == Kind::number && one.literal.find_first_of(".e") == one.literal.npos) return one.literal + ".0";
  return one.literal;
}

std::string python_stubs() {
  std::string text = "    VERBS: ClassVar[Tuple[str, ...]]\n";
  for (const Function& function : functions()) {
    std::vector<std::string> parameters{"self"};
    if (function.of_object) parameters.emplace_back("object: int");
    bool star = false;
    for (const Parameter& one : in_order(function)) {
      if (is_optional(one) && function.has_struct() && !star) parameters.emplace_back("*"), star = true;
      std::string parameter = one.name + ": " + python_signature_type(one);
      if (is_optional(one)) parameter += " = " + python_default(one);
      parameters.push_back(parameter);
    }
    if (function.has_struct() && !star) parameters.emplace_back("*");
    parameters.emplace_back("frame: Optional[int] = None");
    text += listed("    def " + function.name + "(", parameters, ") -> None: ...") + "\n";
  }
  return text;
}

std::string quoted(std::string_view text) {
  std::string escaped = "\"";
  for (const char c : text) escaped += (c == '"' || c == '\\' ? std::string("\\") : "") + c;
  return escaped + "\"";
}

std::string python_source() {
  std::string text =
      "// The verbs as Python's methods. Written by ringdown_write_verbs (clients/verbs) from the rows of "
      "protocol/table.cpp,\n"
      "// and included by mixer.cpp.\nvoid add_verbs(Class& mixer) {\n";
  for (const Function& function : functions()) {
    std::vector<std::string> parameters{"Mixer& self"}, arguments{"self.handle", "at(self, frame)"}, names;
    if (function.of_object) {
      parameters.emplace_back("Object object");
      arguments.emplace_back("object");
      names.emplace_back("py::arg(\"object\")");
    }
    bool star = false;
    for (const Parameter& one : in_order(function)) {
      const char* type = one.kind == Kind::vector     ? "const Vector& "
                         : one.kind == Kind::rotation ? "const Quaternion& "
                         : one.kind == Kind::number   ? "double "
                                                      : "Number ";
      parameters.push_back(type + one.name);
      if (is_optional(one) && function.has_struct() && !star) names.emplace_back("py::kw_only()"), star = true;
      std::string name = "py::arg(\"" + one.name + "\")";
      if (one.kind == Kind::rotation) {
        name += " = Quaternion{1, 0, 0, 0}";
      } else if (is_optional(one)) {
        name += " = " + python_default(one);
      }
      names.push_back(name);
    }
    if (function.has_struct() && !star) names.emplace_back("py::kw_only()");
    parameters.emplace_back("const FrameOrNow& frame");
    names.emplace_back("py::arg(\"frame\") = py::none()");
    std::string body;
    if (function.has_struct()) {
      body = "        " + function.args() + " args;\n        " + function.args() + "_init(&args, sizeof args);\n";
      for (const Parameter& one : function.parameters) {
        if (one.kind == Kind::vector || one.kind == Kind::rotation) {
          body +=
              "        std::memcpy(args." + one.name + ", " + one.name + ".data(), sizeof args." + one.name + ");\n";
        } else {
          body += "        args." + one.name + " = " + one.name + ";\n";
        }
      }
      arguments.emplace_back("&args");
    } else {
      for (const Parameter& one : function.parameters) {
        const bool many = one.kind == Kind::vector || one.kind == Kind::rotation;
        arguments.push_back(many ? one.name + ".data()" : one.name);
      }
    }
    arguments.insert(arguments.begin(), "ringdown_" + function.name);
    std::string meaning = function.sentence;
    for (const Parameter& one : function.parameters) meaning += "\n\n" + one.name + ": " + one.meaning;
    std::string doc;
    for (std::size_t at = 0; at < meaning.size();) {
      const std::size_t end = meaning.find("\n\n", at);
      const std::string_view part = std::string_view(meaning).substr(at, end == meaning.npos ? end : end - at);
      doc += "\n      " + quoted(part);
      if (end == meaning.npos) break;
      doc.insert(doc.size() - 1, "\\n\\n");
      at = end + 2;
    }
    text += "  mixer.def(\n      \"" + function.name + "\",\n" + listed("      [](", parameters, ") {") + "\n" + body +
            listed("        call(", arguments, ");") + "\n      },\n" + listed("      ", names, ",") + doc + ");\n";
  }
  std::vector<std::string> names;
  for (const Function& function : functions()) names.push_back("\"" + function.name + "\"");
  return text + listed("  mixer.attr(\"VERBS\") = py::make_tuple(", names, ");") + "\n}\n";
}

std::string cs_type(const Parameter& one) {
  if (one.kind == Kind::vector) return "Vector";
  if (one.kind == Kind::rotation) return "Turn";
  return one.kind == Kind::number ? "double" : "uint";
}

std::string cs_methods() {
  std::string text;
  for (const Function& function : functions()) {
    std::vector<std::string> parameters, arguments{"handle_", "frame"};
    if (function.of_object) {
      parameters.emplace_back("uint body");
      arguments.emplace_back("body");
    }
    std::string body;
    if (function.has_struct()) {
      const std::string type = "Native." + camel(function.name) + "Args";
      body += "    var args = new " + type + "();\n    Native." + function.args() +
              "_init(ref args, (UIntPtr)Marshal.SizeOf(typeof(" + type + ")));\n";
      for (const Parameter& one : function.parameters) {
        body += formatted("    args.{} = {};\n", camel(one.plain), camel(one.plain, true));
      }
      arguments.emplace_back("ref args");
    } else {
      for (const Parameter& one : function.parameters) {
        const bool many = one.kind == Kind::vector || one.kind == Kind::rotation;
        arguments.push_back((many ? "ref " : "") + camel(one.plain, true));
      }
    }
    for (const bool optional : {false, true}) {
      for (const Parameter& one : function.parameters) {
        if (one.literal.empty() == optional) continue;
        parameters.push_back(cs_type(one) + " " + camel(one.plain, true) + (optional ? " = " + one.literal : ""));
      }
    }
    parameters.emplace_back("long frame = 0");
    arguments.emplace_back("eventFailure_.Room");
    text += wrapped(function.sentence, "  // ") + "\n" +
            listed("  public void " + camel(function.name) + "(", parameters, ") {") + "\n" + body +
            listed("    eventFailure_.Check(Native.ringdown_" + function.name + "(", arguments, "));") + "\n  }\n";
  }
  return text;
}

std::string cs_native() {
  std::string text;
  for (const Function& function : functions()) {
    std::vector<std::string> parameters{"IntPtr mixer", "long frame"};
    if (function.of_object) parameters.emplace_back("uint body");
    if (function.has_struct()) {
      const std::string type = camel(function.name) + "Args";
      text += "  [StructLayout(LayoutKind.Sequential)]\n  internal struct " + type + " {\n    public UIntPtr Size;\n";
      for (const Parameter& one : function.parameters) {
        text += formatted("    public {} {};\n", cs_type(one), camel(one.plain));
      }
      text += "  }\n  [DllImport(kLibrary)] internal static extern void " + function.args() + "_init(ref " + type +
              " args, UIntPtr size);\n";
      parameters.push_back("ref " + type + " args");
    } else {
      for (const Parameter& one : function.parameters) {
        const bool many = one.kind == Kind::vector || one.kind == Kind::rotation;
        parameters.push_back((many ? "ref " : "") + cs_type(one) + " " + camel(one.plain, true));
      }
    }
    parameters.emplace_back("IntPtr error");
    text +=
        listed("  [DllImport(kLibrary)] internal static extern int ringdown_" + function.name + "(", parameters, ");") +
        "\n";
  }
  return text;
}

// Replaces what stands between the lines with `<name>` and `</name>`; nothing: there are no such lines.
std::string with_section(const std::string& whole, const std::string& name, const std::string& section) {
  const std::size_t begin = whole.find("<" + name + ">"), end = whole.find("</" + name + ">");
  if (begin == whole.npos || end == whole.npos) return {};
  const std::size_t after = whole.find('\n', begin) + 1, before = whole.rfind('\n', end) + 1;
  return whole.substr(0, after) + section + whole.substr(before);
}

std::string read(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

int run(const std::string& source, bool checks) {
  const auto sectioned = [&](const std::string& path,
                             std::initializer_list<std::pair<const char*, std::string>> sections) {
    std::string text = read(source + path);
    for (const auto& [name, section] : sections) text = with_section(text, name, section);
    return std::pair(path, text);
  };
  const std::pair<std::string, std::string> files[] = {
      sectioned("/clients/library/ringdown.h", {{"verbs", c_header()}}),
      {"/clients/library/verbs.cpp", c_source()},
      {"/clients/python/source/verbs.inc", python_source()},
      sectioned("/clients/python/ringdown/_core.pyi", {{"verbs", python_stubs()}}),
      sectioned("/clients/csharp/Ringdown.cs", {{"verbs", cs_methods()}, {"verbs of the library", cs_native()}})};
  for (const auto& [path, text] : files) {
    if (text.empty()) return std::cerr << source + path << ": there are no lines <verbs> and </verbs>\n", 1;
    if (text == read(source + path)) continue;
    if (checks) {
      std::cerr << source + path << " is not what the rows of protocol/table.cpp say; run ringdown_write_verbs "
                << source << "\n";
      return 1;
    }
    std::ofstream(source + path + ".new") << text;
    if (std::rename((source + path + ".new").c_str(), (source + path).c_str()) != 0) {
      return std::cerr << source + path << ": cannot be written\n", 1;
    }
  }
  return 0;
}

}  // namespace
}  // namespace ringdown::protocol

int main(int count, char** words) {
  const bool checks = count == 3 && std::string_view(words[2]) == "--check";
  if (count != 2 && !checks) return std::cerr << "usage: ringdown_write_verbs SOURCE_DIR [--check]\n", 2;
  return ringdown::protocol::run(words[1], checks);
}
