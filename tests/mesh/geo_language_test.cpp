#include "engine/mesh/files/geo_language.h"

#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace ringdown {
namespace {

std::string refusal(const std::string& text) {
  const test::TemporaryFolder folder;
  const auto good = mesh::check_geo(folder.write("body.geo", text));
  return good ? "" : good.error().message;
}

TEST(GeoLanguage, WordsKnowTheirLineAndWhatFollows) {
  const auto words = mesh::words_of_geo("a = 1;\n// b\n/* c\n*/ Merge( \"x.step\" );\nd");
  ASSERT_EQ(words.size(), 4u);
  EXPECT_EQ(words[0].next, '=');
  EXPECT_EQ(words[2].word, "Merge");
  EXPECT_EQ(words[2].quoted, "x.step");
  EXPECT_EQ(words[2].line, 4);
  EXPECT_EQ(words[3].line, 5);
  EXPECT_EQ(words[3].next, 0);
}

TEST(GeoLanguage, OnlyAWholeNameOutsideOfCommentsIsAssigned) {
  EXPECT_TRUE(mesh::assigns("DefineConstant[ mesh_size /* mm */ = 4 ];", "mesh_size"));
  EXPECT_FALSE(mesh::assigns("// mesh_size = 4\nmy_mesh_size = 3;", "mesh_size"));
  EXPECT_FALSE(mesh::assigns("a = mesh_size;", "mesh_size"));
  EXPECT_FALSE(mesh::assigns("mesh_size" + std::string(1'000'000, ' '), "mesh_size"));
}

TEST(GeoLanguage, StatementsHideNeitherInCommentsNorInQuotes) {
  EXPECT_EQ(refusal("// Exit;\n/* SystemCall */ Physical Volume(\"Save me\") = {1};"), "");
  EXPECT_NE(refusal("// \rExit;"), "") << "gmsh ends this comment at the carriage return";
  EXPECT_NE(refusal("Physical Volume(\"\\\"\") = 1; \" Exit; \""), "");
  EXPECT_NE(refusal("/* */Exit;"), "");
}

TEST(GeoLanguage, PrintingIsAllowedToTheLogOnly) {
  EXPECT_EQ(refusal("Printf(\"a > b %g\", (1 > 0)); b = 2 > 1;"), "");
  EXPECT_NE(refusal("Printf (\"a\", Sqrt(2)) /* c */ > \"f\";"), "");
  EXPECT_NE(refusal("Error(\"a\") >> \"f\";"), "");
}

TEST(GeoLanguage, NamesOfOptionsAndVariablesAreHarmless) {
  EXPECT_EQ(refusal("Print.Text = 1; Mesh.SaveAll = 1; Save = 3; include = 2;"), "");
  EXPECT_NE(refusal("General.SaveOptions = 1;"), "");
}

TEST(GeoLanguage, AFileIsNamedPlainlyAndLiesBesideOrBelow) {
  EXPECT_EQ(refusal("Merge \"part.step\"; Include \"sub/more.geo\"; Merge \"sub/../part.stl\";"), "");
  EXPECT_NE(refusal("Merge \"sub/../../part.step\";"), "");
  EXPECT_NE(refusal("Merge StrCat(\"/etc/\", \"passwd\");"), "");
}

}  // namespace
}  // namespace ringdown
