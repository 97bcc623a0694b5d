// A bank as one HTML file: a view of the surface that turns, vibrates and sounds where it is pressed, the spectrum of a
// blow with the decays, and a table of all modes. The file needs neither a network nor other files. [any]
#pragma once

#include "clients/cli/picture/answer.h"
#include "engine/modal/bank.h"

#include <string>
#include <string_view>

namespace ringdown::cli {

// Returns the page; empty if the picture could not be drawn.
std::string bank_page(const modal::Bank& bank, const Answer& answer);

// Returns the text with & < > " ' as entities, control characters as spaces, and bytes that are not UTF-8 as U+FFFD.
std::string escaped(std::string_view text);

// Returns the text with control characters and bad bytes replaced like escaped(), but without entities: for pictures.
std::string clean_text(std::string_view text);

// The page's scripts, in the order in which they run; each in the file of its name, such as sound_script.cpp.
extern const char* const kDirectionScript;
extern const char* const kSoundScript;
extern const char* const kViewScript;

}  // namespace ringdown::cli
