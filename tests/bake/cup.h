// The smallest vessel that tests fill.
#pragma once

namespace ringdown::test {

// A cup turned about the z axis, 60 mm high, of 30 mm outer radius and 4 mm wall.
inline constexpr const char* kCup = R"(SetFactory("OpenCASCADE");
Point(1) = {0, 0, 0}; Point(2) = {30, 0, 0}; Point(3) = {30, 0, 60}; Point(4) = {26, 0, 60}; Point(5) = {26, 0, 4}; Point(6) = {0, 0, 4};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1};
Curve Loop(1) = {1, 2, 3, 4, 5, 6}; Plane Surface(1) = {1};
Extrude { {0, 0, 1}, {0, 0, 0}, 2 * Pi } { Surface{1}; }
)";

}  // namespace ringdown::test
