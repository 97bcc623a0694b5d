#include "server/session/sound.h"

#include "engine/synth/mixer.h"
#include "packaging/manual/command_line.h"

#include <map>
#include <string>

namespace ringdown::session {

void add_sound_options(CLI::App& app, SoundOptions& options) {
  const std::map<std::string, bool> contacts = {{"spectrum", false}, {"exact", true}};
  app.add_option("--floor", options.floor_db, "Modes this many dB below full scale rest until they are struck")
      ->check(manual::between(20.0, 300.0))
      ->capture_default_str();
  app.add_flag("--masking", options.masking, "Leave out modes that louder ones hide");
  app.add_option("--contacts", options.exact_contacts,
                 "How a blow acts: by its spectrum, or exact, sample by sample as long as it lasts")
      ->transform(CLI::CheckedTransformer(contacts).description(""))
      ->type_name("spectrum|exact")
      ->default_str("spectrum");
  app.add_option("--limiter", options.limiter_db,
                 "Keep the mix below a ceiling in dB, -1 unless given; it comes 2 ms later")
      ->expected(0, 1)
      ->default_str("-1")
      ->check(manual::between(-60.0, 0.0))
      ->type_name("DB");
}

void apply(const SoundOptions& options, synth::Mixer& mixer) {
  mixer.set_floor(options.floor_db);
  mixer.set_masking(options.masking);
  mixer.set_exact_contacts(options.exact_contacts);
  mixer.limit(options.limiter_db);
}

}  // namespace ringdown::session
