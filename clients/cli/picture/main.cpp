// ringdown-picture: draws a bank. A program of its own because `ringdown` links no cairo.
#include "clients/cli/picture/bank_page.h"
#include "clients/cli/picture/bank_picture.h"
#include "clients/cli/picture/directivity_picture.h"
#include "clients/cli/long_work.h"
#include "engine/base/file_format.h"
#include "engine/base/output_file.h"
#include "engine/base/folders.h"
#include "engine/base/quote.h"
#include "engine/modal/bank_file.h"
#include "packaging/manual/command_line.h"

#include <filesystem>

namespace {

using namespace ringdown;  // NOLINT: a program
using protocol::complain;
using protocol::ExitCode;

struct Arguments {
  std::string bank;
  std::filesystem::path output;
  std::vector<double> at;
  std::string directivity;
  bool small = false;
};

void add_options(manual::App& app, Arguments& arguments) {
  app.add_option("bank", arguments.bank, "The bank: a .glb file, or the name of a preset.")
      ->type_name("FILE")
      ->required();
  app.add_option("-o,--output", arguments.output,
                 "The file to write; its ending says which kind. .png and .svg: a picture of mode shapes, the spectrum "
                 "of a blow, and decays. .html: a page on which the object turns and sounds where it is clicked, with "
                 "spectrum, "
                 "decays and the table of modes. .csv: a table of --directivity.")
      ->type_name("FILE")
      ->required();
  app.add_option("--at", arguments.at,
                 "The point that is struck, in metres; default: the point with the strongest response. The nearest "
                 "sample point is taken.")
      ->type_name("X,Y,Z")
      ->delimiter(',')
      ->expected(3)
      ->check(manual::any_number());
  app.add_option("--directivity", arguments.directivity,
                 "Draws how loud it sounds in each direction: of a mode, by its number, or of a band such as 500-2000, "
                 "as the blow rings there. Needs a bank with radiation.")
      ->type_name("MODE|BAND");
  app.add_flag("--small", arguments.small, "A picture of one shape and the spectrum, 480 by 200 pixels.");
}

ExitCode draw(const Arguments& arguments, const std::string& ending, const std::stop_token& stop) {
  const auto path = preset_or_file(arguments.bank, PresetKind::bank);
  if (!path) return complain(path);
  const auto bank = modal::read_bank(*path);
  if (!bank) return complain(bank);
  std::optional<Vec3> at;
  if (!arguments.at.empty()) at = Vec3{arguments.at[0], arguments.at[1], arguments.at[2]};
  const cli::Answer answer = cli::answer_of(*bank, at);
  const auto kind = ending == ".png" ? cli::Canvas::Kind::png : cli::Canvas::Kind::svg;
  const auto directions = [&]() -> Result<std::string> {
    const auto sounding = cli::sounding_of(*bank, arguments.directivity);
    if (!sounding) return fail(sounding.error().kind, arguments.bank + ": " + sounding.error().message);
    const cli::Directivity directivity(*bank, answer, *sounding);
    return ending == ".csv" ? cli::directivity_csv(directivity)
                            : cli::draw_directivity(kind, *bank, directivity, sounding->title);
  };
  const Result<std::string> drawn = !arguments.directivity.empty() ? directions()
                                    : ending == ".html"            ? cli::bank_page(*bank, answer)
                                                        : cli::draw_bank(kind, *bank, answer, arguments.small);
  if (!drawn) return complain(drawn.error());
  const std::string& bytes = *drawn;
  if (bytes.empty()) {
    return complain({ErrorKind::no_memory, "cannot draw " + arguments.output.string() + ": there is no memory for it"});
  }
  if (stop.stop_requested()) return complain({ErrorKind::cancelled, "cancelled; nothing was written"});
  const auto written = write_output(arguments.output, std::string_view(bytes));
  return written ? ExitCode::ok : complain(written);
}

// The text of the man page in addition to the options.
const std::vector<manual::Section> kSections = {
    {"EXAMPLES",
     {{"ringdown picture bell.glb -o bell.png", "A picture of the bell's modes."},
      {"ringdown picture bell.glb -o bell.html --at 0.1,0,0.05", "A page, with the spectrum of a blow at that point."},
      {"ringdown picture bell.glb -o bell.png --directivity 500-2000", "Where its sound goes in that band."}}},
    {"SEE ALSO", {{"ringdown(1)", "The other verbs; `ringdown info` prints the modes as a table."}}},
};

ExitCode run(int argc, char** argv) {
  manual::App app("Draws a bank: its shapes, the spectrum of a blow, its decays.", "ringdown-picture");
  Arguments arguments;
  add_options(app, arguments);
  if (const auto ended = manual::parse(app, argc, argv, kSections)) return *ended;
  const std::string ending = ending_of(arguments.output);
  const bool of_directions = !arguments.directivity.empty();
  if (ending != ".png" && ending != ".svg" && ending != (of_directions ? ".csv" : ".html")) {
    return manual::complain_of_usage(app, std::string("--output must end in .png, .svg or ") +
                                              (of_directions ? ".csv" : ".html") + ", not " + quote(ending));
  }
  if (of_directions && arguments.small) return manual::complain_of_usage(app, "--small is not for --directivity");
  if (ending == ".html" && arguments.small) {
    return manual::complain_of_usage(app, "--small is for pictures, not for a page");
  }
  return cli::run_cancellable([&](const std::stop_token& stop) { return draw(arguments, ending, stop); });
}

}  // namespace

int main(int argc, char** argv) {
  return ringdown::protocol::exit_status([&] { return run(argc, argv); });
}
