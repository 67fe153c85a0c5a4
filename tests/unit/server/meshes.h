// Meshes and their Draco encodings, for the server's tests.
#ifndef LATVOX_TESTS_UNIT_SERVER_MESHES_H_
#define LATVOX_TESTS_UNIT_SERVER_MESHES_H_

#include <string>

#include "core/mesh/mesh.h"

namespace latvox {

// Values are those of Draco's header.
enum class DracoMethod { kSequential = 0, kEdgebreaker = 1 };

struct DracoEncoding {
  DracoMethod method = DracoMethod::kEdgebreaker;
  int quantization_bits = 14;  // 0: none
  int speed = 3;               // 0 smallest to 10 fastest
  int position_components = 3;
  bool as_position = true;  // else as a generic attribute
  bool metadata = false;
};

// A closed surface of 2 * rings * 2 * rings triangles about the origin, radius 1.
TriangleMesh Sphere(int rings);

// n x n squares of side 1 in the plane z = 0.
TriangleMesh FlatGrid(int n);

std::string EncodeDraco(const TriangleMesh& mesh, const DracoEncoding& encoding);
std::string EncodeDracoPointCloud(const TriangleMesh& mesh);

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_SERVER_MESHES_H_
