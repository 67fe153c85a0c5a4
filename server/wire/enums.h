// The protocol's enumerations: a table for each, from its numbers to their meanings in core.
#ifndef LATVOX_SERVER_WIRE_ENUMS_H_
#define LATVOX_SERVER_WIRE_ENUMS_H_

#include <array>
#include <cstddef>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/lattice/named.h"
#include "core/request/algorithm.h"
#include "core/request/fields.h"
#include "core/request/grid_request.h"
#include "core/request/links.h"
#include "core/request/solid.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/base/errors.h"
#include "server/wire/brick_batch.h"

namespace latvox {

template <class T, size_t N>
using EnumTable = std::array<std::pair<int, T>, N>;

// The protocol numbers named lattices like core's table, from 1.
static_assert(v1::NamedLattice_MAX == kNamedLattices.size());
inline constexpr auto kLatticeNumbers = [] {
  EnumTable<NamedLattice, kNamedLattices.size()> table{};
  for (size_t n = 0; n < table.size(); ++n) table[n] = {static_cast<int>(n) + 1, kNamedLattices[n].lattice};
  return table;
}();

inline constexpr EnumTable<Algorithm, 5> kAlgorithmNumbers{
    {{v1::ALGORITHM_UNSPECIFIED, Algorithm::kExact},
     {v1::ALGORITHM_EXACT, Algorithm::kExact},
     {v1::ALGORITHM_BRUTE_FORCE, Algorithm::kBruteForce},
     {v1::ALGORITHM_INCREMENTAL, Algorithm::kIncremental},
     {v1::ALGORITHM_OPTIMIZED_INCREMENTAL, Algorithm::kOptimizedIncremental}}};

inline constexpr EnumTable<SolidSurface, 4> kSolidSurfaceNumbers{
    {{v1::SOLID_SURFACE_UNSPECIFIED, SolidSurface::kSeparating},
     {v1::SOLID_SURFACE_SEPARATING, SolidSurface::kSeparating},
     {v1::SOLID_SURFACE_SUPERCOVER, SolidSurface::kSupercover},
     {v1::SOLID_SURFACE_NONE, SolidSurface::kNone}}};

inline constexpr EnumTable<InteriorRule, 4> kInteriorRuleNumbers{
    {{v1::INTERIOR_RULE_UNSPECIFIED, InteriorRule::kAuto},
     {v1::INTERIOR_RULE_PARITY, InteriorRule::kParity},
     {v1::INTERIOR_RULE_WINDING, InteriorRule::kWinding},
     {v1::INTERIOR_RULE_POSITIVE, InteriorRule::kPositive}}};

// Whether positions are doubles.
inline constexpr EnumTable<bool, 3> kPositionTypeNumbers{
    {{v1::POSITION_TYPE_UNSPECIFIED, false}, {v1::POSITION_TYPE_FLOAT32, false}, {v1::POSITION_TYPE_FLOAT64, true}}};

inline constexpr EnumTable<Placement, 3> kPlacementNumbers{{{v1::PLACEMENT_UNSPECIFIED, Placement::kBySet},
                                                            {v1::PLACEMENT_POINTS, Placement::kPoints},
                                                            {v1::PLACEMENT_CELLS, Placement::kCells}}};

inline constexpr EnumTable<BrickEncoding, 4> kEncodingNumbers{
    {{v1::BRICK_ENCODING_UNSPECIFIED, BrickEncoding::kMasks},
     {v1::BRICK_ENCODING_MASKS, BrickEncoding::kMasks},
     {v1::BRICK_ENCODING_PACKED, BrickEncoding::kPacked},
     {v1::BRICK_ENCODING_PACKED_ZSTD, BrickEncoding::kPackedZstd}}};

inline constexpr EnumTable<LinkSide, 4> kLinkSideNumbers{{{v1::LINK_SIDE_UNSPECIFIED, LinkSide::kBoth},
                                                          {v1::LINK_SIDE_BOTH, LinkSide::kBoth},
                                                          {v1::LINK_SIDE_INSIDE, LinkSide::kInside},
                                                          {v1::LINK_SIDE_OUTSIDE, LinkSide::kOutside}}};

inline constexpr EnumTable<Field, kFields.size()> kFieldNumbers{{{v1::FIELD_PART, Field::kPart},
                                                                 {v1::FIELD_MATERIAL, Field::kMaterial},
                                                                 {v1::FIELD_COLOR, Field::kColor},
                                                                 {v1::FIELD_DISTANCE, Field::kDistance},
                                                                 {v1::FIELD_TRIANGLE, Field::kTriangle},
                                                                 {v1::FIELD_POINT, Field::kPoint},
                                                                 {v1::FIELD_NORMAL, Field::kNormal},
                                                                 {v1::FIELD_LINKS, Field::kLinks},
                                                                 {v1::FIELD_LINK_TRIANGLES, Field::kLinkTriangles},
                                                                 {v1::FIELD_LINK_CROSSINGS, Field::kLinkCrossings},
                                                                 {v1::FIELD_FRACTION, Field::kFraction},
                                                                 {v1::FIELD_LABEL_FRACTIONS, Field::kLabelFractions}}};

// Returns the meaning of a number on the wire. Errors: INVALID_ARGUMENT with an ErrorCause if the table does not have
// it.
//   kind   "an algorithm"
template <class T, size_t N>
absl::StatusOr<T> Meaning(const EnumTable<T, N>& table, int number, absl::string_view field, absl::string_view kind) {
  for (const auto& [known, meaning] : table) {
    if (known == number) return meaning;
  }
  return BadSpec(absl::StrCat(field, " ", number, " is not ", kind), field, absl::StrCat(number),
                 absl::StrCat(table.front().first, " to ", table.back().first));
}

// Returns the number for a meaning, the last one in the table. Precondition: the table has it.
template <class T, size_t N>
constexpr int NumberOf(const EnumTable<T, N>& table, const T& meaning) {
  int number = 0;
  for (const auto& [known, other] : table) {
    if (other == meaning) number = known;
  }
  return number;
}

}  // namespace latvox

#endif  // LATVOX_SERVER_WIRE_ENUMS_H_
