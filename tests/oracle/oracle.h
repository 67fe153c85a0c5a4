// An exact, slow definition of a voxelization: neighbors, crossings, covers, planes. It shares no code with the core
// and none of its methods: no projection, no unimodular completion, no edge functions. Every number is an integer or a
// rational of unlimited size, and the tie-breaking shift is a polynomial in an infinitesimal. A disagreement between
// the core and this file is a defect of one of them.
//
// Frames:
//   voxel      Int3, integer lattice coordinates ijk of a lattice point
//   mesh       Int3, lattice coordinates in units of 1/256 voxel: voxel z lies at 256 z
//   direction  Int3, a primitive lattice vector q; one of each pair ±q is enough, and which one does not matter
//
// All functions are pure. A violated invariant of the theory throws std::logic_error: no input should cause it.
#ifndef LATVOX_TESTS_ORACLE_ORACLE_H_
#define LATVOX_TESTS_ORACLE_ORACLE_H_

#include <gmpxx.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <vector>

namespace latvox::oracle {

using Int3 = std::array<int64_t, 3>;
using Triangle = std::array<Int3, 3>;
using Mesh = std::vector<Triangle>;

inline constexpr int64_t kUnitsPerVoxel = 256;

// A set of voxels, both ends included.
struct Box {
  Int3 lo;
  Int3 hi;
  bool Contains(const Int3& z) const;
  Box Grown(const Int3& margin) const;
};

// ---- Neighbors -----------------------------------------------------------------------------------------------------

// Inner products of the basis vectors. Voronoi cells depend on the basis through it alone, and it is rational where the
// basis is not: the hexagonal plane's is (1, 1/2; 1/2, 1).
template <size_t D>
using Gram = std::array<std::array<mpq_class, D>, D>;

// `columns[c]` is the c-th basis vector, each double taken as the exact rational that it is. So a basis that only
// approximates a symmetric one (sqrt(3)/2 in doubles) is, exactly, an asymmetric one.
template <size_t D>
Gram<D> GramOf(const std::array<std::array<double, D>, D>& columns);

// Every lattice vector w != 0 (coefficients in the basis) whose Voronoi cell meets the origin's, with the dimension of
// the face that they share: D-1 facet, ..., 0 vertex. A vector that is not a key shares nothing. Method: it computes
// the cell's vertices, and adds bisector planes until no lattice point is nearer to any vertex than the origin. A
// face's dimension is the affine rank of the vertices on w's bisector. Any basis, reduced or not.
template <size_t D>
std::map<std::array<int64_t, D>, int> VoronoiNeighbors(const Gram<D>& gram);

// One of each pair ±w with a shared face of dimension >= k: the one whose first nonzero component is positive.
std::vector<Int3> Directions(const std::map<Int3, int>& neighbors, int k);

// ---- Crossings ------------------------------------------------------------------------------------------------------

// A segment between two lattice points, lower end (lexicographically) first.
struct Edge {
  Int3 a;
  Int3 b;
  auto operator<=>(const Edge&) const = default;
};
Edge MakeEdge(const Int3& z, const Int3& other);

// One triangle meets one lattice edge.
struct Crossing {
  Int3 near_end;    // the nearer end; exactly half way, the one that the shift makes nearer
  Int3 far_end;     // near_end + q or near_end - q
  size_t triangle;  // index in the mesh
  int orientation;  // sign of (v1-v0)x(v2-v0) . q in lattice coordinates: +1 where +q leaves an outward oriented solid
};

// Every crossing of the mesh, shifted by the infinitesimal (eps, eps^2, eps^3) in lattice coordinates, with the lattice
// edges z -> z+q. With a box, exactly those whose edge has at least one end in it. A triangle parallel to q crosses
// nothing. Two triangles on one edge are two crossings.
std::vector<Crossing> Crossings(const Mesh& mesh, const Int3& q, const std::optional<Box>& box = std::nullopt);

// The edges crossed at least once, over all directions.
std::set<Edge> CrossedEdges(const Mesh& mesh, const std::vector<Int3>& directions,
                            const std::optional<Box>& box = std::nullopt);

// The representative of the line {z + m q}: equal for two lattice points iff they lie on one line of the bundle.
Int3 LineOf(const Int3& z, const Int3& q);

// ---- Voxel sets -----------------------------------------------------------------------------------------------------

// The near ends of all crossings. If `minimal`, thinned: for each parity class (i&1)<<2 | (j&1)<<1 | (k&1), ascending,
// every member whose crossed edges all have their other end in the set leaves.
// With a box: exactly the voxels of the unrestricted result that lie in it (thinning looks beyond the box as far as a
// voxel's fate depends).
std::set<Int3> Digitize(const Mesh& mesh, const std::vector<Int3>& directions, bool minimal,
                        const std::optional<Box>& box = std::nullopt);

// How many edges have no end in the set.
size_t Tunnels(const std::set<Int3>& voxels, const std::set<Edge>& crossed);

// How many voxels could leave, each alone, without a tunnel. A voxel without a crossed edge is one of them.
size_t Redundant(const std::set<Int3>& voxels, const std::set<Edge>& crossed);

// Finds the voxels whose closed Voronoi cells meet a mesh. Method: it clips each triangle at the bisectors between a
// voxel and its neighbors. The two meet iff anything is left.
class CellClipper {
 public:
  explicit CellClipper(const Gram<3>& gram);

  // With a box, those of its voxels alone.
  std::set<Int3> Supercover(const Mesh& mesh, const std::optional<Box>& box = std::nullopt) const;

 private:
  // normal . x <= limit, x in mesh units relative to a voxel.
  template <class T>
  struct HalfSpace {
    std::array<T, 3> normal;
    T limit;
  };
  template <class T>
  static std::vector<std::array<T, 3>> Clip(const std::vector<std::array<T, 3>>& polygon, const HalfSpace<T>& at);
  template <class T>
  static bool Meets(const Triangle& triangle, const Int3& voxel, const std::vector<HalfSpace<T>>& cell);

  std::vector<HalfSpace<mpq_class>> exact_;
  // The same cell in doubles, enlarged and shrunk by far more than their rounding error. Where both agree, no exact
  // test is needed.
  std::vector<HalfSpace<double>> loose_, tight_;
  Int3 margin_;  // per axis, voxels: no cell extends farther
};

// The plane { x : normal . x = offset }, with x in mesh units (1/256 voxel), and normal a covector in lattice
// coordinates. It holds all z in the box with -t < normal . z - offset/256 <= t, t = max |normal . q| / 2. If
// necessary, (normal, offset) is negated first, so that the normal's first nonzero component is positive.
std::set<Int3> PlaneSet(Int3 normal, int64_t offset, const std::vector<Int3>& directions, const Box& box);

}  // namespace latvox::oracle

#endif  // LATVOX_TESTS_ORACLE_ORACLE_H_
