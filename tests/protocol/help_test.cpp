#include "protocol/help.h"

#include "protocol/defaults.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

namespace ringdown::protocol {
namespace {

TEST(Help, TheCommittedManualIsTheTablesText) {
  std::ifstream file(RINGDOWN_SOURCE_DIR "/docs/reference/protocol.md");
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), markdown()) << "run: ringdown protocol --markdown > docs/reference/protocol.md";
}

TEST(Help, EveryAddressAndArgumentIsInTheManual) {
  const std::string text = markdown();
  for (const auto specs : {addresses(), reply_addresses()}) {
    for (const AddressSpec& spec : specs) {
      EXPECT_NE(text.find("### `" + std::string(spec.address) + "`"), text.npos) << spec.address;
      EXPECT_FALSE(spec.sentence.empty()) << spec.address;
      for (const ArgumentSpec& argument : spec.arguments) {
        EXPECT_TRUE(argument.sentence.ends_with('.')) << spec.address << " " << argument.name;
      }
    }
  }
}

TEST(Help, AWorkedExampleIsAnOscsendCommand) {
  const auto example = [](std::string_view address) { return oscsend_command(**find_address(address)); };
  EXPECT_EQ(example("/object/bell/gain"), "oscsend osc.udp://127.0.0.1:7770 /object/bell/gain ff 0.5 0.1");
  EXPECT_EQ(example("/quit"), "oscsend osc.udp://127.0.0.1:7770 /quit");
  EXPECT_EQ(example("/sync"), "oscsend osc.udp://127.0.0.1:7770 /sync i 7");
}

TEST(Help, AnArgumentIsDescribedWithUnitRangeAndDefault) {
  const AddressSpec& strike = **find_address("/object/bell/strike");
  const std::string text = describe(strike.arguments.back());
  EXPECT_NE(text.find("from 0 to 0.1 s"), text.npos) << text;
  EXPECT_NE(text.find("0.0002 if left out"), text.npos) << text;
  EXPECT_EQ(signature(strike), "/object/{object}/strike x y z jx jy jz [contact_time]");
}

}  // namespace
}  // namespace ringdown::protocol
