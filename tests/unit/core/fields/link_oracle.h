// Links and their fields, from the oracle's crossings and rational shares.
#ifndef LATVOX_TESTS_UNIT_CORE_FIELDS_LINK_ORACLE_H_
#define LATVOX_TESTS_UNIT_CORE_FIELDS_LINK_ORACLE_H_

#include <gmpxx.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "tests/oracle/oracle.h"

namespace latvox {

struct ExpectedLink {
  mpq_class share;
  size_t triangle;
  uint32_t crossings;
};

// By the step to the link's other end.
using ExpectedLinks = std::map<oracle::Int3, ExpectedLink>;

class LinkOracle {
 public:
  //   directions   one of each pair of neighbors
  //   box          if given, links of other voxels may lack
  LinkOracle(const oracle::Mesh& mesh, const std::vector<oracle::Int3>& directions,
             const std::optional<oracle::Box>& box)
      : mesh_(mesh) {
    for (const oracle::Int3& q : directions) {
      for (const oracle::Crossing& crossing : oracle::Crossings(mesh, q, box)) {
        Add(crossing.near_end, crossing.far_end, crossing.triangle);
        Add(crossing.far_end, crossing.near_end, crossing.triangle);
      }
    }
    if (box) std::erase_if(links_, [&](const auto& of_voxel) { return !box->Contains(of_voxel.first); });
  }

  const std::map<oracle::Int3, ExpectedLinks>& links() const { return links_; }

  const ExpectedLinks& At(const oracle::Int3& z) const {
    static const ExpectedLinks none;
    const auto found = links_.find(z);
    return found == links_.end() ? none : found->second;
  }

 private:
  void Add(const oracle::Int3& z, const oracle::Int3& end, size_t triangle) {
    const oracle::Int3 q{end[0] - z[0], end[1] - z[1], end[2] - z[2]};
    const mpq_class share = ShareOf(mesh_[triangle], z, q);
    const auto [at, is_new] = links_[z].try_emplace(q, ExpectedLink{share, triangle, 1});
    if (is_new) return;
    ExpectedLink& link = at->second;
    ++link.crossings;
    if (std::tie(share, triangle) < std::tie(link.share, link.triangle)) {
      link.share = share;
      link.triangle = triangle;
    }
  }

  // n . (A - z) / n . q.
  static mpq_class ShareOf(const oracle::Triangle& triangle, const oracle::Int3& z, const oracle::Int3& q) {
    std::array<std::array<mpz_class, 3>, 2> edges;
    for (size_t n = 0; n < 2; ++n) {
      for (size_t m = 0; m < 3; ++m) edges[n][m] = triangle[n + 1][m] - triangle[0][m];
    }
    mpz_class above = 0, below = 0;
    for (size_t m = 0; m < 3; ++m) {
      const size_t a = (m + 1) % 3, b = (m + 2) % 3;
      const mpz_class normal = edges[0][a] * edges[1][b] - edges[0][b] * edges[1][a];
      above += normal * (triangle[0][m] - oracle::kUnitsPerVoxel * z[m]);
      below += normal * oracle::kUnitsPerVoxel * q[m];
    }
    mpq_class share(above, below);
    share.canonicalize();
    return share;
  }

  const oracle::Mesh& mesh_;
  std::map<oracle::Int3, ExpectedLinks> links_;
};

// Whether the value is the float that stands for a share: the nearest one, of two the even one, and for 0 the smallest
// positive normal one.
inline bool StandsFor(float value, const mpq_class& share) {
  if (share == 0) return value == std::numeric_limits<float>::min();
  const mpq_class exact(static_cast<double>(value)), error = abs(exact - share);
  int exponent = 0;
  const bool is_even = std::fmod(std::ldexp(std::frexp(value, &exponent), 24), 2.0F) == 0;
  for (const float other : {std::nextafter(value, -1.0F), std::nextafter(value, 2.0F)}) {
    const mpq_class error_of_other = abs(mpq_class(static_cast<double>(other)) - share);
    if (error_of_other < error || (error_of_other == error && !is_even)) return false;
  }
  return true;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_FIELDS_LINK_ORACLE_H_
