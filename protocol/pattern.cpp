#include "protocol/pattern.h"

#include "protocol/names.h"
#include "protocol/schema.h"

#include <bitset>
#include <cassert>

// Matching without backtracking
//
// The matcher simulates a nondeterministic automaton (Thompson, CACM 11, 1968): it keeps the set of all positions in
// the text that the pattern, as far as it has been read, may have reached. Each sign of the pattern maps this set to
// the next one: a letter or a set moves every position on by one where the text agrees, * fills in all later positions,
// and {a,b} is the union of what its words lead to. A pattern matches if the end of the text is in the last set. The
// time is (signs of the pattern) x (length of the text), so no pattern that a client sends can make the daemon slow.
namespace ringdown::protocol {
namespace {

constexpr std::size_t kMaxMatched = 127;

// A set of positions in the text: those that the pattern may have reached.
using Places = std::bitset<kMaxMatched + 1>;

template <class Accepts>
Places step(const Places& places, std::string_view text, Accepts accepts) {
  Places next;
  for (std::size_t i = 0; i < text.size(); ++i) next[i + 1] = places[i] && accepts(text[i]);
  return next;
}

Places step_word(Places places, std::string_view text, std::string_view word) {
  for (const char wanted : word) {
    places = step(places, text, [wanted](char c) { return c == wanted; });
  }
  return places;
}

Places step_any(const Places& places, std::string_view text) {
  Places next = places;
  for (std::size_t i = 0; i < text.size(); ++i) next[i + 1] = next[i + 1] || next[i];
  return next;
}

// "abc", "a-z", "!a-z"
bool in_set(std::string_view set, char c) {
  const bool negated = set.starts_with('!');
  if (negated) set.remove_prefix(1);
  bool found = false;
  for (std::size_t i = 0; i < set.size(); ++i) {
    if (i + 2 < set.size() && set[i + 1] == '-') {
      found = found || (set[i] <= c && c <= set[i + 2]);
      i += 2;
    } else {
      found = found || set[i] == c;
    }
  }
  return found != negated;
}

Places step_words(const Places& places, std::string_view text, std::string_view words) {
  Places next;
  for (;;) {
    const std::size_t comma = words.find(',');
    next |= step_word(places, text, words.substr(0, comma));
    if (comma == words.npos) return next;
    words.remove_prefix(comma + 1);
  }
}

// Takes off the text between the pattern's first character and `close`, and returns it. Nothing when it is not closed.
std::optional<std::string_view> take_enclosed(std::string_view& pattern, char close) {
  const std::size_t end = pattern.find(close);
  if (end == pattern.npos) return std::nullopt;
  const std::string_view inside = pattern.substr(1, end - 1);
  pattern.remove_prefix(end + 1);
  return inside;
}

}  // namespace

bool matches(std::string_view pattern, std::string_view text) {
  assert(text.size() <= kMaxMatched);
  // Most names differ in their letters before the first sign or after the last one, which is quick to see.
  const std::string_view end = pattern.substr(pattern.find_last_of("?*[]{}") + 1);
  if (!text.ends_with(end)) return false;
  for (; !pattern.empty() && !is_pattern(pattern.substr(0, 1)); pattern.remove_prefix(1), text.remove_prefix(1)) {
    if (text.empty() || text.front() != pattern.front()) return false;
  }
  Places places;
  places[0] = true;
  while (!pattern.empty() && places.any()) {
    const char first = pattern.front();
    if (first == '[' || first == '{') {
      const auto inside = take_enclosed(pattern, first == '[' ? ']' : '}');
      if (!inside || inside->empty()) return false;
      places = first == '{' ? step_words(places, text, *inside)
                            : step(places, text, [&](char c) { return in_set(*inside, c); });
      continue;
    }
    pattern.remove_prefix(1);
    if (first == '*') {
      places = step_any(places, text);
    } else {
      places = step(places, text, [first](char c) { return first == '?' || c == first; });
    }
  }
  return places[text.size()];
}

Result<std::vector<std::string>> expand(std::string_view pattern, std::span<const std::string> names) {
  const std::string shown = quote(pattern);
  if (!pattern.starts_with(kObjectPrefix)) {
    return fail(ErrorKind::bad_input,
                shown + ": patterns stand for objects, as in /object/glass*/gain; write other addresses out");
  }
  const std::string_view rest = pattern.substr(kObjectPrefix.size());
  const std::string_view object = rest.substr(0, rest.find('/'));
  const std::string_view action = rest.substr(std::min(rest.size(), object.size() + 1));
  std::vector<std::string> actions, addresses;
  for (const AddressSpec& spec : protocol::addresses()) {
    if (spec.arguments_in_address() == 0) continue;
    const std::string_view known = spec.address.substr(spec.address.rfind('/') + 1);
    if (matches(action, known)) actions.emplace_back(known);
  }
  if (actions.empty())
    return fail(ErrorKind::bad_input, "{} matches no address: {} is not a verb of an object", shown, quote(action));
  for (const std::string& name : names) {
    if (name != object && !matches(object, name)) continue;
    for (const std::string& known : actions) addresses.push_back(formatted("{}{}/{}", kObjectPrefix, name, known));
  }
  if (addresses.empty()) {
    return fail(ErrorKind::bad_input, "{} matches none of the {} objects' names", shown, names.size());
  }
  return addresses;
}

}  // namespace ringdown::protocol
