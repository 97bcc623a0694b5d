#include "engine/mesh/files/inp_file.h"

#include "engine/base/file_format.h"
#include "engine/mesh/files/tet_file.h"
#include "tests/fem/sample_meshes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <sstream>

namespace ringdown {
namespace {

using mesh::read_inp;
using mesh::TetMesh;

constexpr const char* kNodes = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n";
constexpr const char* kElement = "*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n";

TetMesh corner() {
  TetMesh mesh;
  mesh.nodes.resize(4, 3);
  mesh.nodes << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  mesh.elements.resize(1, 4);
  mesh.elements << 0, 1, 2, 3;
  return mesh;
}

void expect_same(const Result<TetMesh>& read, const TetMesh& mesh) {
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->nodes, mesh.nodes);
  EXPECT_EQ(read->elements, mesh.elements);
}

void expect_corner(const std::string& deck) {
  SCOPED_TRACE(deck);
  expect_same(read_inp(deck, "x.inp"), corner());
}

struct Wrong {
  std::string deck, sentence;
};

void expect_refused(const std::vector<Wrong>& wrongs) {
  for (const auto& [deck, sentence] : wrongs) {
    const auto read = read_inp(deck, "x.inp");
    ASSERT_FALSE(read) << deck;
    EXPECT_NE(read.error().message.find(sentence), std::string::npos)
        << read.error().message << "\nshould say " << sentence;
    EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
  }
}

// Numbered from 11 in steps of 7, the last first; elements over several lines of so many numbers.
std::string deck_of(const TetMesh& mesh, const std::string& type, int numbers_in_line) {
  std::ostringstream text;
  text.precision(17);
  const auto number = [](std::int64_t node) { return 11 + 7 * node; };
  text << "*ELEMENT, TYPE=" << type << ", ELSET=Body\n";
  for (int e = 0; e < mesh.elements.rows(); ++e) {
    text << 900 - 3 * e;
    for (int c = 0; c < mesh.elements.cols(); ++c) {
      text << "," << ((c + 1) % numbers_in_line == 0 ? "\n  " : " ") << number(mesh.elements(e, c));
    }
    text << "\n";
  }
  text << "*NODE, NSET=All\n";
  for (auto n = static_cast<int>(mesh.nodes.rows()) - 1; n >= 0; --n) {
    text << number(n) << ", " << mesh.nodes(n, 0) << ", " << mesh.nodes(n, 1) << ", " << mesh.nodes(n, 2) << "\n";
  }
  return text.str();
}

// Whether two meshes have the same positions in the same elements, in whatever order their nodes come.
void expect_same_places(const Result<TetMesh>& read, const TetMesh& mesh) {
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->nodes.rows(), mesh.nodes.rows());
  ASSERT_EQ(read->elements.rows(), mesh.elements.rows());
  ASSERT_EQ(read->elements.cols(), mesh.elements.cols());
  for (int e = 0; e < mesh.elements.rows(); ++e) EXPECT_EQ(nodes_of(*read, e), nodes_of(mesh, e)) << e;
}

TEST(InpFile, NumbersMayHaveGapsAndElementsGoOverLines) {
  const TetMesh box = test::box_mesh({2, 1, 1}, {0.3, 0.1, 0.2}), quadratic = mesh::to_order(box, 2);
  for (const int in_line : {1, 4, 7, 16}) {
    expect_same_places(read_inp(deck_of(box, "C3D4", in_line), "x.inp"), box);
    expect_same_places(read_inp(deck_of(quadratic, "C3D10", in_line), "x.inp"), quadratic);
  }
}

TEST(InpFile, EveryKindOfTetrahedronIsATetrahedron) {
  const TetMesh quadratic = mesh::to_order(corner(), 2);
  for (const char* type : {"C3D4", "c3d4h", "C3D4T", "DC3D4"})
    expect_same_places(read_inp(deck_of(corner(), type, 9), ""), corner());
  for (const char* type : {"C3D10", "C3D10M", "c3d10mh", "C3D10I", "C3D10T", "C3D10HS", "DC3D10"}) {
    expect_same_places(read_inp(deck_of(quadratic, type, 9), ""), quadratic);
  }
}

TEST(InpFile, KeywordsMayBeInAnyCaseWithBlanksAndComments) {
  expect_corner(std::string(kNodes) + kElement);
  expect_corner(std::string(kElement) + kNodes);
  expect_corner(
      "*Heading\r\n a body, 5 parts *NODE\r\n** a comment\r\n\r\n* nOde , NSET = \"all, of them\"\r\n 1,0.,0.,0.\r\n"
      "** another, 7, 7\r\n2 ,\t1.0 , +0.0E+00,\r\n\r\n 3,,1D0\r\n4,0,0,1.d+00,0.5,0.5,0.5\r\n"
      "*Element,\r\nelset=Body,\r\ntype = c3d4 \r\n  1, 1,2,\r\n** between\r\n 3,4\r\n*Node Output\r\nU, 1e9\r\n");
}

TEST(InpFile, AMissingCoordinateOfANodeIsZero) {
  expect_corner(std::string("*NODE\n1,0\n2,1\n3,0,1\n4,,,1\n") + kElement);
}

TEST(InpFile, SeveralBlocksOfElementsOfOneOrderAreOneBody) {
  const auto read = read_inp(
      std::string(kNodes) + kElement + "*NODE\n9, 1, 1, 1\n3, 0, 1, 0\n*ELEMENT, TYPE=C3D4H\n7, 4, 3, 2, 9\n", "x.inp");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->nodes.rows(), 5);
  EXPECT_EQ(read->elements.rows(), 2);
}

TEST(InpFile, ShellsBeamsAndSpringsArePassedOver) {
  for (const char* type : {"S3", "S4R", "STRI65", "CPS3", "CPE6", "B31", "T3D2", "M3D3", "R3D4", "SPRINGA", "DASHPOTA",
                           "MASS", "CONN3D2", "SFM3D3"}) {
    expect_corner(std::string(kNodes) + "*ELEMENT, TYPE=" + type + "\n77, 1, 2, 3\n" + kElement);
  }
}

TEST(InpFile, SolidsOtherThanTetrahedraAreRefusedByName) {
  for (const std::string type : {"C3D8", "C3D8R", "C3D20R", "C3D6", "C3D15", "C3D5", "C3D40", "C3D", "SC8R", "AC3D4",
                                 "COH3D6", "CCL12", "F3D4", "U1"}) {
    expect_refused({{std::string(kNodes) + "*ELEMENT, TYPE=" + type + "\n1, 1, 2, 3, 4\n",
                     "x.inp, line 6: elements are of type " + type + "; only tetrahedra are understood"}});
  }
}

constexpr const char* kDeck = R"(** written by a preprocessor, in mm
*HEADING
Model: plate     Date: today
*NODE, NSET=Nall
      1,  0.000000000000e+00,  0.000000000000e+00,  0.000000000000e+00
      2,  1.000000000000e+00,  0.000000000000e+00,  0.000000000000e+00
      3,  0.000000000000e+00,  1.000000000000e+00,  0.000000000000e+00
      4,  0.000000000000e+00,  0.000000000000e+00,  1.000000000000e+00
*ELEMENT, TYPE=S3, ELSET=Skin
1, 1, 2, 3
*ELEMENT, TYPE=C3D4, ELSET=Eall
2, 1, 2, 3, 4
*NSET, NSET=Nfix, GENERATE
1, 3, 1
*ELSET, ELSET=Other
1, 2
*SURFACE, NAME=Top, TYPE=ELEMENT
2, S1
*MATERIAL, NAME=Steel
*ELASTIC
210000., 0.3
*DENSITY
7.8e-9
*SOLID SECTION, ELSET=Eall, MATERIAL=Steel
*SHELL SECTION, ELSET=Skin, MATERIAL=Steel
0.5
*INITIAL CONDITIONS, TYPE=TEMPERATURE
Nall, 20.
*BOUNDARY
Nfix, 1, 3
*STEP
*INCLUDE, INPUT=loads.inp
*FREQUENCY
10
*NODE FILE
U
*EL FILE
S
*NODE PRINT, NSET=Nall
U
*END STEP
)";

TEST(InpFile, ADeckWithMaterialsAndStepsIsRead) {
  expect_corner(kDeck);
  std::string with_returns;
  for (const char* c = kDeck; *c != 0; ++c) with_returns += *c == '\n' ? std::string("\r\n") : std::string(1, *c);
  expect_corner(with_returns);
}

std::string part(const std::string& within, const std::string& instance, const std::string& after = "") {
  return "*Part, name=\"Part-1\"\n" + within + "*End Part\n*Assembly, name=Assembly\n" + instance + after +
         "*End Assembly\n*Material, name=Steel\n*Step\n*End Step\n";
}

TEST(InpFile, OnePartWithOneInstanceIsRead) {
  const std::string body = std::string(kNodes) + kElement,
                    reference = "*Node\n1, 5., 5., 5.\n*Element, type=MASS\n1, 1\n";
  const std::string instance = "*Instance, name=Part-1-1, part=PART-1\n";
  expect_corner(part(body, instance + "*End Instance\n"));
  expect_corner(part(body, instance + "*End Instance\n", reference));
  expect_corner(part("", instance + body + "*End Instance\n"));
}

TEST(InpFile, AnAssemblyOfSeveralOrMovedPartsIsRefused) {
  const std::string body = std::string(kNodes) + kElement, end = "*End Instance\n";
  const std::string instance = "*Instance, name=Part-1-1, part=Part-1\n";
  expect_refused(
      {{"*PART, NAME=A\n" + body + "*END PART\n*PART, NAME=B\n" + body, "x.inp, line 10: this is a second *PART"},
       {part(body, instance + end, instance + end), "x.inp, line 13: this is a second *INSTANCE"},
       {part(body, instance + "0., 0., 2.\n" + end), "x.inp, line 12: this *INSTANCE is moved"},
       {part(body, "*Instance, name=b, part=Other\n" + end), "line 11: *INSTANCE should name the one *PART before it"},
       {part(body, ""), "x.inp, line 1: this *PART has no *INSTANCE"},
       {part(body, instance + end, "*Node\n5,\n*Element, type=C3D4\n1, 1, 2, 3, 4\n"),
        "x.inp, line 15: solid elements should be in the part"}});
}

TEST(InpFile, NodesAndElementsThatADeckDoesNotListAreRefused) {
  expect_refused(
      {{"*HEADING\n*INCLUDE, INPUT=nodes.inp\n", "x.inp, line 2: *INCLUDE is not followed; write one file"},
       {"*NODE, INPUT=nodes.inp\n", "x.inp, line 1: INPUT= is not followed; write one file"},
       {"*ELEMENT, TYPE=C3D4, INPUT=elements.inp\n", "x.inp, line 1: INPUT= is not followed; write one file"},
       {"*NODE, SYSTEM=C\n1, 1, 90, 0\n", "x.inp, line 1: SYSTEM=C is not followed; write rectangular coordinates"},
       {"*SYSTEM\n1, 0, 0\n", "x.inp, line 1: *SYSTEM is not followed"},
       {std::string(kNodes) + "*NGEN\n1, 4, 1\n",
        "x.inp, line 6: *NGEN is not followed; generate nodes and elements in the program that wrote it"}});
  for (const char* keyword : {"NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY"}) {
    expect_refused({{std::string("*") + keyword + "\n", std::string("line 1: *") + keyword + " is not followed"}});
  }
  expect_corner(std::string("*NODE, SYSTEM=R\n") + (kNodes + 6) + kElement);
}

TEST(InpFile, AFaultOfADeckIsReportedWithItsLine) {
  const std::string nodes = kNodes, solid = nodes + "*ELEMENT, TYPE=C3D4\n";
  expect_refused(
      {{"", "x.inp: has no *NODE; only .inp decks of Abaqus and CalculiX are supported"},
       {"4 1 0 0 0\n1 0 0 0\n", "x.inp: has no *NODE"},
       {nodes, "x.inp: has no tetrahedra; only tetrahedra are understood"},
       {solid, "x.inp: has no tetrahedra"},
       {nodes + "*ELEMENT, TYPE=S3\n1, 1, 2, 3\n", "x.inp: has no tetrahedra, but elements of type S3"},
       {nodes + "*ELEMENT\n1, 1, 2, 3, 4\n", "x.inp, line 6: *ELEMENT should say its TYPE"},
       {"*NODE\n0, 0, 0, 0\n", "x.inp, line 2: a node should begin with its number"},
       {"*NODE\n1.5, 0, 0, 0\n", "x.inp, line 2: a node should begin with its number"},
       {"*NODE\n1 0 0 0\n", "x.inp, line 2: a node should begin with its number"},
       {"*NODE\n,\n", "x.inp, line 2: a node should begin with its number"},
       {"*NODE\n99999999999999999999, 0\n", "x.inp, line 2: a node should begin with its number"},
       {"*NODE\n1\n", "x.inp, line 2: a node should have up to three finite coordinates"},
       {"*NODE\n1, 0, nan, 0\n", "line 2: a node should have up to three finite coordinates"},
       {"*NODE\n1, 0, 0, inf\n", "line 2: a node should have up to three finite coordinates"},
       {"*NODE\n1, 1e999, 0, 0\n", "line 2: a node should have up to three finite coordinates"},
       {"*NODE\n1, 0 0 0\n", "line 2: a node should have up to three finite coordinates"},
       {"*NODE\n1, <x>, 0, 0\n", "line 2: a node should have up to three finite coordinates"},
       {"*NODE\n1, 0, 0, 0, 1, 2, 3, 4\n", "line 2: a node should have up to three finite coordinates"},
       {nodes + "** again\n2, 1, 0, 0.5\n", "x.inp, line 7: node 2 appears a second time, at another place"},
       {solid + "1, 1, 2, 3\n", "x.inp, line 7: an element should have its number and 4 nodes"},
       {solid + "1, 1, 2,\n3\n2, 1, 2, 3, 4\n", "x.inp, line 7: an element should have its number and 4 nodes"},
       {solid + "1, 1, 2, 3, 4, 1\n", "x.inp, line 7: an element should have its number and 4 nodes"},
       {solid + "1, 1, 2,\n*STEP\n", "x.inp, line 7: an element should have its number and 4 nodes"},
       {solid + "1, 1,\n2, x, 4\n", "x.inp, line 8: an element should have positive whole numbers"},
       {solid + "1, 1, 2, 3, -4\n", "x.inp, line 7: an element should have positive whole numbers"},
       {solid + "1, 1, 2, , 4\n", "x.inp, line 7: an element should have positive whole numbers"},
       {solid + "\n3, 1, 2, 3,\n5\n", "x.inp, line 8: there is no node 5"},
       {solid + "1, 1, 2, 3, 4\n1, 2, 1, 3, 4\n", "x.inp, line 8: element 1 appears a second time"},
       {nodes + kElement + "*ELEMENT, TYPE=C3D10\n", "x.inp, line 8: tetrahedra of 4 and of 10 nodes are mixed"}});
}

TEST(InpFile, TheEndingInpIsKnownInAnyCase) {
  const test::TemporaryFolder folder;
  expect_same(mesh::read_tet_file(folder.write("part.INP", kDeck)), corner());
  EXPECT_TRUE(is_of_kind("part.INP", FileKind::tetrahedra));
  EXPECT_FALSE(is_of_kind("part.inp.gz", FileKind::tetrahedra));
}

}  // namespace
}  // namespace ringdown
