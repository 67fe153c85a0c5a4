#include "tests/oracle/meshes.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <utility>

#include "tests/oracle/shapes.h"

namespace latvox::oracle {
namespace {

constexpr int64_t kHalf = kUnitsPerVoxel / 2;

std::string ToString(const Int3& v) {
  return std::to_string(v[0]) + "," + std::to_string(v[1]) + "," + std::to_string(v[2]);
}

class Builder {
 public:
  Builder(uint64_t seed, const std::vector<Int3>& directions) : random_(seed), directions_(directions) {}

  std::vector<NamedMesh> Build() {
    Shells();
    EdgesAlongDirections();
    HalfwayPlanes();
    Slivers();
    Duplicates();
    Degenerate();
    OpenSheets();
    CloseLeaves();
    Huge();
    Tiny();
    NonManifold();
    Soups();
    Walls();
    return std::move(meshes_);
  }

 private:
  void Add(const std::string& name, const Mesh& mesh, bool closed, const std::optional<Box>& box = std::nullopt) {
    meshes_.push_back({name, mesh, closed, box});
  }

  void Shells() {
    const std::pair<std::string, Mesh> shapes[] = {
        {"tetrahedron", UnitTetrahedron()}, {"cube", UnitCube()}, {"octahedron", Octahedron(1)}};
    const std::pair<std::string, Int3> places[] = {{"on_lattice", {0, 0, 0}},
                                                   {"half", {kHalf, kHalf, kHalf}},
                                                   {"mixed", {-kUnitsPerVoxel, kHalf, 37}},
                                                   {"off", {-301, 77, 19}}};
    for (const auto& [shape_name, shape] : shapes) {
      for (const auto& [place_name, at] : places) {
        const std::string suffix = shape_name + "_" + place_name;
        const Mesh outer = Placed(shape, 3 * kUnitsPerVoxel, at);
        Add("shell/" + suffix, outer, true);
        Add("shell/inside_out_" + suffix, Reversed(outer), true);
        Mesh nested = outer;
        Append(nested, Reversed(Placed(shape, 2 * kUnitsPerVoxel, at)));
        Append(nested, Placed(shape, kHalf, at));
        Add("shell/nested_" + suffix, nested, true);
      }
      Add("shell/below_a_voxel_" + shape_name, Placed(shape, 90, {kHalf, 11, -5}), true);
      Add("shell/around_a_voxel_" + shape_name, Placed(shape, 40, {-12, -9, -7}), true);
    }
    Mesh touching = Placed(UnitCube(), kUnitsPerVoxel, {0, 0, 0});
    Append(touching, Placed(UnitCube(), kUnitsPerVoxel, {2 * kUnitsPerVoxel, 0, 0}));
    Add("shell/cubes_sharing_a_face", touching, true);
    Append(touching, Placed(UnitCube(), kUnitsPerVoxel, {0, 2 * kUnitsPerVoxel, 2 * kUnitsPerVoxel}));
    Add("shell/cubes_sharing_an_edge", touching, true);
    Mesh overlapping = Placed(UnitCube(), 2 * kUnitsPerVoxel, {0, 0, 0});
    Append(overlapping, Placed(UnitCube(), 2 * kUnitsPerVoxel, {kHalf, kUnitsPerVoxel, 100}));
    Add("shell/overlapping_cubes", overlapping, true);
    TJunction();
    for (int64_t step : {1, 64, 128, 256}) {
      for (int variant = 0; variant < 2; ++variant) {
        const Mesh mesh = Crumpled(variant == 0 ? 1 : 2, 4 * kUnitsPerVoxel, step, random_);
        Add("shell/crumpled_step" + std::to_string(step) + "_" + std::to_string(variant), mesh, true);
      }
    }
  }

  // Closed as a point set only: one side of an edge has a vertex where the other has none.
  void TJunction() {
    const Int3 a{-512, 0, 0}, b{512, 256, 512}, c{0, 768, -256}, d{0, -300, -700};
    const Int3 middle{0, 128, 256};
    Mesh mesh = Tetrahedron(a, b, c, d);
    Triangle split = mesh[0];  // a, c, b
    mesh.erase(mesh.begin());
    mesh.push_back({split[0], split[1], middle});
    mesh.push_back({middle, split[1], split[2]});
    Add("shell/t_junction", mesh, true);
  }

  void EdgesAlongDirections() {
    for (const Int3& q : directions_) {
      const Int3 start = Int3{-1, 0, -1} * kUnitsPerVoxel;
      const Int3 end = start + q * (3 * kUnitsPerVoxel);
      const Int3 apex = random_.Point(4 * kUnitsPerVoxel, kUnitsPerVoxel);
      const Int3 loose = random_.Point(4 * kUnitsPerVoxel);
      Add("edge_along/lattice_points_" + ToString(q), {{start, end, apex}, {end, start, loose}}, false);
      const Int3 half = q * kHalf;
      Add("edge_along/ends_half_way_" + ToString(q),
          {{start + half, end + half, loose}, {end + half, start + half, apex}}, false);
      Add("edge_along/tetrahedron_" + ToString(q),
          Tetrahedron(start, end, apex, random_.Point(4 * kUnitsPerVoxel, kHalf)), true);
      // A ruled strip whose every rung runs along q.
      Mesh strip;
      Int3 from = start;
      for (int i = 0; i < 4; ++i) {
        const Int3 next = from + random_.Point(2 * kUnitsPerVoxel, i % 2 == 0 ? kUnitsPerVoxel : kHalf);
        Append(strip, Quad(from, from + q * (2 * kUnitsPerVoxel), next + q * (2 * kUnitsPerVoxel), next));
        from = next;
      }
      Add("edge_along/strip_" + ToString(q), strip, false);
    }
  }

  void HalfwayPlanes() {
    const Int3 normals[] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 0},   {1, -1, 0},  {0, 1, -1}, {1, 0, 1},
                            {1, 1, 1},  {1, 1, -1}, {1, -1, 1}, {-1, 1, 1},  {2, 1, 0},   {1, -2, 0}, {1, 2, 2},
                            {1, 1, -2}, {3, 1, -1}, {1, 2, 3},  {-2, 1, -3}, {-1, -1, -1}};
    for (const Int3& n : normals) {
      for (int64_t offset : {int64_t{0}, kHalf, kUnitsPerVoxel + kHalf, -kHalf, kUnitsPerVoxel / 4}) {
        const std::string name = "plane/" + ToString(n) + "_at_" + std::to_string(offset);
        const Mesh quad = PlaneQuad(n, offset, 2 * kUnitsPerVoxel + (offset == kHalf ? kHalf : 0));
        Add(name, quad, false);
        if (offset == kHalf) Add(name + "_reversed", Reversed(quad), false);
      }
    }
  }

  void Slivers() {
    Mesh loose, lattice, along;
    for (int i = 0; i < 12; ++i) {
      const Int3 a = random_.Point(5 * kUnitsPerVoxel);
      const Int3 b = random_.Point(5 * kUnitsPerVoxel);
      loose.push_back({a, b, b + random_.Point(1)});
      const Int3 c = random_.Point(4 * kUnitsPerVoxel, kUnitsPerVoxel);
      const Int3 d = random_.Point(4 * kUnitsPerVoxel, kUnitsPerVoxel);
      lattice.push_back({c, d, d + random_.Point(1)});
    }
    for (const Int3& q : directions_) {
      const Int3 a = random_.Point(2 * kUnitsPerVoxel, kUnitsPerVoxel) - q * kUnitsPerVoxel;
      const Int3 b = a + q * (2 * kUnitsPerVoxel);
      const Int3 off = random_.Point(1);
      along.push_back({a + off, b + off, b - off});
      along.push_back({a, b, a + q * kUnitsPerVoxel + off});
    }
    Add("sliver/loose", loose, false);
    Add("sliver/lattice", lattice, false);
    Add("sliver/along_directions", along, false);
    Add("sliver/flat_tetrahedron", Tetrahedron({-700, -650, 3}, {800, -512, 3}, {0, 900, 3}, {17, 5, 4}), true);
    Add("sliver/needle", Tetrahedron({-1024, 0, 0}, {1024, 1, 0}, {1024, 0, 1}, {1024, -1, -1}), true);
  }

  void Duplicates() {
    Mesh once;
    for (int i = 0; i < 4; ++i) {
      once.push_back({random_.Point(4 * kUnitsPerVoxel, kHalf), random_.Point(4 * kUnitsPerVoxel, kHalf),
                      random_.Point(4 * kUnitsPerVoxel, kHalf)});
    }
    Mesh twice = once;
    Append(twice, once);
    Add("duplicate/same", twice, true);
    Mesh opposite = once;
    Append(opposite, Reversed(once));
    Add("duplicate/reversed", opposite, true);
    Append(opposite, once);
    Add("duplicate/thrice", opposite, false);
    Mesh shell = Placed(UnitCube(), 2 * kUnitsPerVoxel, {kHalf, 0, 3});
    Append(shell, shell);
    Add("duplicate/shell", shell, true);
  }

  void Degenerate() {
    const Int3 a{-512, 256, 0}, b{256, -128, 512};
    const Int3 origin{}, diagonal{256, 256, 256}, up{0, 0, 256}, beyond{640, -320, 768};
    const Mesh none = {{a, a, a},
                       {a, b, a},
                       {a, a, b},
                       {b, a, a},
                       {a, a + a + b, a + a + b},
                       {a, b, beyond},
                       {origin, diagonal, diagonal * 2},
                       {origin, up * 3, up}};
    Add("zero_area/only", none, true);
    Mesh some = Placed(Octahedron(1), 2 * kUnitsPerVoxel, {0, 0, 0});
    Append(some, none);
    Add("zero_area/with_octahedron", some, true);
  }

  // A height field over 8 x 8 quads of one voxel, heights multiples of `step` up to `reach`, axis `up`.
  Mesh Sheet(size_t up, int64_t reach, int64_t step, int64_t base) {
    constexpr int64_t kSide = 8;
    std::vector<int64_t> height;
    for (int64_t i = 0; i < (kSide + 1) * (kSide + 1); ++i) {
      height.push_back(base + random_.Between(-reach / step, reach / step) * step);
    }
    const auto at = [&](int64_t i, int64_t j) {
      Int3 v{};
      v[up] = height[static_cast<size_t>(i * (kSide + 1) + j)];
      v[(up + 1) % 3] = (i - kSide / 2) * kUnitsPerVoxel + base;
      v[(up + 2) % 3] = (j - kSide / 2) * kUnitsPerVoxel;
      return v;
    };
    Mesh sheet;
    for (int64_t i = 0; i < kSide; ++i) {
      for (int64_t j = 0; j < kSide; ++j) {
        Append(sheet, Quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)));
      }
    }
    return sheet;
  }

  void OpenSheets() {
    for (size_t up = 0; up < 3; ++up) {
      for (int64_t step : {int64_t{1}, kHalf, kUnitsPerVoxel}) {
        Add("sheet/up" + std::to_string(up) + "_step" + std::to_string(step),
            Sheet(up, 2 * kUnitsPerVoxel, step, step == 1 ? 41 : 0), false);
      }
    }
  }

  void CloseLeaves() {
    for (int64_t gap : {int64_t{1}, int64_t{40}, kHalf, int64_t{255}}) {
      for (size_t up = 0; up < 3; ++up) {
        const Mesh leaf = Sheet(up, 100, 1, -gap / 2);
        Int3 apart{};
        apart[up] = gap;
        Mesh both = leaf;
        Append(both, Placed(Reversed(leaf), 1, apart));
        Add("leaves/gap" + std::to_string(gap) + "_up" + std::to_string(up), both, false);
      }
      const Mesh slab = Moved(UnitCube(), [&](const Int3& v) {
        return Int3{v[0] * 900, v[1] * 4 * kUnitsPerVoxel, v[2] < 0 ? int64_t{0} : gap};
      });
      Add("leaves/slab" + std::to_string(gap), slab, true);
      Add("leaves/sheared_slab" + std::to_string(gap),
          Moved(slab,
                [](const Int3& v) {
                  return Int3{v[0], v[1], v[2] + v[0] / 2 + v[1] / 4};
                }),
          true);
    }
  }

  void Huge() {
    constexpr int64_t kFar = 300 * kUnitsPerVoxel;
    const Box box{{-4, -5, -3}, {5, 4, 6}};
    Add("huge/tie_plane", PlaneQuad({1, 1, 1}, kHalf, kFar), false, box);
    Add("huge/tie_plane_skew", PlaneQuad({1, -2, 0}, kUnitsPerVoxel + kHalf, kFar), false, box);
    const Triangle on_diagonal = {Int3{-kFar, -kFar, -kFar}, Int3{kFar, kFar, kFar}, Int3{kFar, 0, -11}};
    Add("huge/edge_through_lattice", {on_diagonal}, false, box);
    Mesh soup;
    for (int i = 0; i < 12; ++i) {
      const Int3 near = random_.Point(2 * kUnitsPerVoxel, i % 3 == 0 ? kUnitsPerVoxel : 1);
      const Int3 a = random_.Point(kFar);
      const Int3 b = random_.Point(kFar);
      soup.push_back({a, b, near * 3 - a - b});  // its centroid is near
    }
    Add("huge/soup", soup, false, box);
    Add("huge/octahedron_corner", Placed(Octahedron(1), kFar, {kHalf - kFar, 0, 0}), true, box);
    Add("huge/octahedron_face", Placed(Octahedron(1), kFar, {-kFar / 3, -kFar / 3, -kFar / 3}), true, box);
    const Triangle loose_needle = {Int3{-kFar, -kFar, 3}, Int3{kFar, kFar, 4}, Int3{kFar, kFar, 5}};
    const Triangle axis_needle = {Int3{-kFar, 0, 0}, Int3{kFar, 0, 0}, Int3{0, 1, 0}};
    const Triangle other_side = {Int3{-kFar, 0, 0}, Int3{kFar, 0, 0}, Int3{0, -1, 0}};
    Add("huge/needles", {loose_needle, axis_needle}, false, box);
    Add("huge/needle_on_the_shift's_side", {other_side}, false, box);
  }

  void Tiny() {
    Add("tiny/sphere_on_lattice", Sphere(8, 3 * kUnitsPerVoxel, {0, 0, 0}), true);
    Add("tiny/sphere_off_lattice", Sphere(8, 3 * kUnitsPerVoxel, {-131, 77, 200}), true);
    Add("tiny/fine_sphere", Sphere(20, 2 * kUnitsPerVoxel + kHalf, {kHalf, kHalf, -kHalf}), true);
    Add("tiny/ball_in_a_cell", Sphere(4, 100, {kHalf, kHalf, kHalf}), true);
    Mesh dust;
    for (int i = 0; i < 400; ++i) {
      const Int3 lattice = random_.Point(kUnitsPerVoxel, kHalf);
      dust.push_back({lattice + random_.Point(3), lattice + random_.Point(3), lattice + random_.Point(3)});
    }
    Add("tiny/dust", dust, false);
  }

  void NonManifold() {
    for (int64_t blades : {3, 4, 5}) {
      for (int64_t step : {int64_t{1}, kUnitsPerVoxel}) {
        Mesh fan;
        const Int3 a = random_.Point(3 * kUnitsPerVoxel, step);
        const Int3 b = random_.Point(3 * kUnitsPerVoxel, step);
        for (int64_t i = 0; i < blades; ++i) fan.push_back({a, b, random_.Point(4 * kUnitsPerVoxel, step)});
        Add("fan/blades" + std::to_string(blades) + "_step" + std::to_string(step), fan, false);
      }
    }
    // Four blades on each edge of a common face: two tetrahedra that share it, both leaving it in.
    const Int3 p{-512, 0, 256}, q{512, -256, 0}, r{0, 768, 0};
    Mesh pair = Tetrahedron(p, q, r, {0, 100, 700});
    Append(pair, Tetrahedron(p, r, q, {0, 128, -640}));
    Add("fan/tetrahedra_with_inner_wall", pair, true);
    for (const Int3& tip : {Int3{0, 0, 0}, Int3{kHalf, 0, -kHalf}, Int3{-31, 5, 7}}) {
      Mesh bow = Tetrahedron(tip, tip + Int3{768, 0, 0}, tip + Int3{700, 512, 0}, tip + Int3{640, 128, 512});
      Append(bow, Tetrahedron(tip, tip - Int3{768, 100, 0}, tip - Int3{512, -300, 0}, tip - Int3{512, 128, 600}));
      Add("bow_tie/solid_" + ToString(tip), bow, true);
      Add("bow_tie/open_" + ToString(tip),
          {{tip, tip + Int3{512, 256, 0}, tip + Int3{512, 0, 512}},
           {tip, tip - Int3{512, 256, 0}, tip - Int3{0, 0, 512}}},
          false);
    }
  }

  void Soups() {
    for (int64_t step : {1, 32, 128, 256}) {
      for (int64_t reach : {2 * kUnitsPerVoxel, 5 * kUnitsPerVoxel}) {
        Mesh large, small;
        for (int i = 0; i < 20; ++i) {
          large.push_back({random_.Point(reach, step), random_.Point(reach, step), random_.Point(reach, step)});
          const Int3 at = random_.Point(reach, step);
          const int64_t size = std::max(step, kHalf);
          small.push_back({at, at + random_.Point(size, step), at + random_.Point(size, step)});
        }
        const std::string suffix = "_step" + std::to_string(step) + "_reach" + std::to_string(reach / kUnitsPerVoxel);
        Add("soup/large" + suffix, large, false);
        Add("soup/small" + suffix, small, false);
      }
    }
    Mesh negative;
    for (int i = 0; i < 20; ++i) {
      const Int3 corner = Int3{-9, -7, -11} * kUnitsPerVoxel;
      negative.push_back(
          {corner + random_.Point(700, 4), corner + random_.Point(700, 4), corner + random_.Point(700, 4)});
    }
    Add("soup/negative", negative, false);
  }

  // Three layers, flat or sheared, so that most voxels are doubtful. Coplanar triangles meet at ties, each layer is
  // split elsewhere, the second is reversed, and a coarse quad covers the first again.
  void Walls() {
    for (int64_t gap : {kHalf, kUnitsPerVoxel, int64_t{300}}) {
      for (size_t up = 0; up < 3; ++up) {
        Int3 across{}, along{}, apart{};
        across[(up + 1) % 3] = along[(up + 2) % 3] = 4 * kUnitsPerVoxel;
        apart[up] = -gap;
        Mesh wall = Sheet(up, 0, 1, -gap);
        Append(wall, Reversed(Sheet(up, 0, 1, 0)));
        Append(wall, Sheet(up, 0, 1, gap));
        Append(wall, Quad(apart, apart + across, apart + across + along, apart + along));
        const std::string suffix = std::to_string(gap) + "_up" + std::to_string(up);
        Add("walls/flat" + suffix, wall, false);
        const auto shear = [&](Int3 v) {
          v[up] += v[(up + 1) % 3] / 2;
          return v;
        };
        Add("walls/sheared" + suffix, Moved(wall, shear), false);
      }
    }
  }

  Random random_;
  const std::vector<Int3>& directions_;
  std::vector<NamedMesh> meshes_;
};

}  // namespace

std::vector<NamedMesh> AdversarialMeshes(uint64_t seed, const std::vector<Int3>& directions) {
  return Builder(seed, directions).Build();
}

Mesh PlaneQuad(const Int3& normal, int64_t offset, int64_t half_width) {
  for (size_t axis = 0; axis < 3; ++axis) {
    if (std::abs(normal[axis]) != 1) continue;
    Int3 center{}, u{}, v{};
    center[axis] = offset * normal[axis];
    u[(axis + 1) % 3] = half_width;
    u[axis] = -half_width * normal[(axis + 1) % 3] * normal[axis];
    v[(axis + 2) % 3] = half_width;
    v[axis] = -half_width * normal[(axis + 2) % 3] * normal[axis];
    return Quad(center - u - v, center + u - v, center + u + v, center - u + v);
  }
  throw std::logic_error("a plane's normal has a component of ±1");
}

}  // namespace latvox::oracle
