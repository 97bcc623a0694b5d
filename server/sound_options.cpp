#include "server/sound_options.h"

#include "engine/synth/mixer.h"
#include "packaging/manual/command_line.h"
#include "server/session/head.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <utility>

namespace ringdown::server {
namespace {

constexpr double kLimiter_db = -1;

}  // namespace

void add_sound_options(manual::App& app, synth::MixerSettings& settings) {
  const std::map<std::string, bool> contacts = {{"spectrum", false}, {"exact", true}};
  app.add_option("--floor", settings.floor_db, "Modes this many dB below full scale rest until they are struck")
      ->check(manual::between(20.0, 300.0))
      ->capture_default_str();
  app.add_flag_function("--masking",
                        [] {
                          std::fputs(
                              "--masking has no effect and will be refused by the next release: it saved no time; use "
                              "--budget instead\n",
                              stderr);
                        })
      ->hidden();
  app.add_choice("--contacts", settings.exact_contacts, contacts,
                 "How a blow acts: by its spectrum, or exactly, sample by sample while it lasts")
      ->type_name("spectrum|exact")
      ->default_str("spectrum");
  app.add_option("--full-scale", settings.full_scale_pa,
                 "Sound pressure in pascals, 1 m from an object, that is full scale")
      ->check(manual::between(1e-6, 1e6))
      ->type_name("PA")
      ->capture_default_str();
  // CLI11 checks no empty text where an option needs no value.
  settings.limiter_db = kLimiter_db;
  const auto take_limiter = [&settings](const std::string& text) {
    if (text.empty()) throw manual::WrongValue{"--limiter", "'' is not a number from -60 to 0"};
    settings.limiter_db.reset();
    if (text != "off") settings.limiter_db = std::strtod(text.c_str(), nullptr);  // checked below
  };
  const auto check_limiter = [](const std::string& text) {
    return text == "off" ? std::string() : manual::wrong_number(text, -60, 0, " from -60 to 0");
  };
  app.add_option_function<std::string>(
         "--limiter", take_limiter,
         "Keep the mix below a ceiling in dB (default: -1), with 2 ms of delay; off: the mix may exceed full scale")
      ->expected(0, 1)
      ->default_str("-1")
      ->check(manual::Check(check_limiter, "from -60 to 0, or off"))
      ->type_name("DB|off");
  app.add_option("--ambisonics", settings.ambisonic_order,
                 "Also render the sound field around the listener: AmbiX of this order, (N + 1)^2 channels")
      ->check(manual::between(0, static_cast<int>(synth::kMaxAmbisonicOrder)))
      ->type_name("N");
  app.add_flag("--travel-time", settings.travel_time,
               "Delay each event by the travel time of its sound to the listener");
  const auto take_head = [&settings](const std::string& sofa) {
    auto head = session::read_head(sofa);
    if (!head) throw manual::WrongValue{"--binaural", head.error().message};
    settings.head = *std::move(head);
  };
  app.add_option_function<std::string>(
         "--binaural", take_head,
         "Render left and right as the ears of a head, for headphones: that of a SOFA file, or an artificial head")
      ->expected(0, 1)
      ->type_name("FILE");
}

}  // namespace ringdown::server
