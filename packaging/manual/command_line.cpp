#include "packaging/manual/command_line.h"

#include "engine/base/version.h"
#include "packaging/manual/completion.h"
#include "protocol/defaults.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <new>
#include <string_view>

namespace ringdown::manual {
namespace {

using protocol::ExitCode;

ExitCode write_manual(CLI::App& app, std::string_view kind, const std::vector<Section>& sections) {
  const Command command = command_of(app);
  std::string text;
  if (kind == "man") text = man_page(command, sections);
  if (kind == "bash") text = bash_completion(command);
  if (kind == "zsh") text = zsh_completion(command);
  if (kind == "fish") text = fish_completion(command);
  if (text.empty()) return complain_of_usage(app, "--manual takes man, bash, zsh or fish");
  if (std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0) return ExitCode::ok;
  return protocol::complain({ErrorKind::input_output, "cannot write to the standard output"});
}

constexpr double kLargest = std::numeric_limits<double>::max();

}  // namespace

std::string wrong_number(const std::string& text, double low, double high, const std::string& demand) {
  char* end = nullptr;
  const double number = std::strtod(text.c_str(), &end);
  if (text.empty() || end != text.data() + text.size()) return "'" + text + "' is not a number" + demand;
  if (!std::isfinite(number)) return "'" + text + "' is not a finite number" + demand;
  return number < low || number > high ? "'" + text + "' is not a number" + demand : "";
}

CLI::Validator any_number() {
  return CLI::Validator([](const std::string& text) { return wrong_number(text, -kLargest, kLargest, ""); }, "");
}

CLI::Validator any_vector() {
  const auto check = [](const std::string& text) {
    const std::vector<std::string> parts = CLI::detail::split(text, ',');
    if (parts.size() != 3) return "'" + text + "' is not three numbers with commas between them, like 0.05,0,0.02";
    for (const std::string& part : parts) {
      if (const std::string wrong = wrong_number(part, -kLargest, kLargest, ""); !wrong.empty()) return wrong;
    }
    return std::string();
  };
  return CLI::Validator(check, "");
}

CLI::Validator above_zero() {
  const auto check = [](const std::string& text) {
    return wrong_number(text, std::numeric_limits<double>::denorm_min(), kLargest, " greater than 0");
  };
  return CLI::Validator(check, "greater than 0");
}

void add_common_options(CLI::App& app) {
  app.set_version_flag("--version", app.get_name() + " " + kVersion + "\nbanks " + std::to_string(kBankVersion) +
                                        ", text files " + std::to_string(kTextFileVersion) + ", protocol " +
                                        std::to_string(protocol::kProtocolVersion));
  app.footer(protocol::exit_code_help());
}

std::optional<ExitCode> parse(CLI::App& app, int argc, char** argv, const std::vector<Section>& sections) {
  if (argc == 3 && std::string_view(argv[1]) == "--manual") return write_manual(app, argv[2], sections);
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::Success& help_or_version) {
    app.exit(help_or_version);
    return ExitCode::ok;
  } catch (const CLI::ParseError& error) {
    return complain_of_usage(app, error.what());
  } catch (const std::bad_alloc&) {
    return protocol::complain({ErrorKind::no_memory, "there is not enough memory for this"});
  }
}

ExitCode complain_of_usage(const CLI::App& app, const std::string& what) {
  std::string command = app.get_name();
  for (const CLI::App* verb : app.get_subcommands()) {
    if (!verb->get_name().empty()) command += " " + verb->get_name();
  }
  return protocol::complain(what + "; " + command + " --help lists the options", ExitCode::usage);
}

}  // namespace ringdown::manual
