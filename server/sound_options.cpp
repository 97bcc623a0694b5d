#include "server/sound_options.h"

#include "engine/synth/mixer.h"
#include "packaging/manual/command_line.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>

namespace ringdown::server {

void add_sound_options(CLI::App& app, synth::MixerSettings& settings) {
  const std::map<std::string, bool> contacts = {{"spectrum", false}, {"exact", true}};
  app.add_option("--floor", settings.floor_db, "Modes this many dB below full scale rest until they are struck")
      ->check(manual::between(20.0, 300.0))
      ->capture_default_str();
  app.add_flag_function(
         "--masking",
         [](std::int64_t) {
           std::fputs(
               "--masking does nothing any more and will be refused by the next release: it left sound out "
               "and saved no time; --budget leaves out what there is no time for\n",
               stderr);
         })
      ->group("");
  app.add_option("--contacts", settings.exact_contacts,
                 "How a blow acts: by its spectrum, or exact, sample by sample as long as it lasts")
      ->transform(CLI::CheckedTransformer(contacts).description(""))
      ->type_name("spectrum|exact")
      ->default_str("spectrum");
  // CLI11 checks no empty text where an option needs no value.
  const auto take_limiter = [&settings](const std::string& text) {
    if (text.empty()) throw CLI::ValidationError("--limiter", "'' is not a number from -60 to 0");
    settings.limiter_db = std::strtod(text.c_str(), nullptr);  // checked below
  };
  app.add_option_function<std::string>("--limiter", take_limiter,
                                       "Keep the mix below a ceiling in dB, -1 unless given; it comes 2 ms later")
      ->expected(0, 1)
      ->default_str("-1")
      ->check(manual::between(-60.0, 0.0))
      ->type_name("DB");
}

}  // namespace ringdown::server
