// The core, the SDK and the protocol have the same tables of named lattices.
#include <gtest/gtest.h>

#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/lattice/named.h"
#include "latvox/plane_types.h"
#include "latvox/types.h"
#include "latvox/v1/voxelizer.pb.h"

namespace latvox {
namespace {

TEST(NamedLattices, AreTheSameInCoreAndClientAndFollowTheProtocol) {
  ASSERT_EQ(client::kNamedLattices.size(), kNamedLattices.size());
  ASSERT_EQ(v1::NamedLattice_ARRAYSIZE, static_cast<int>(kNamedLattices.size()) + 1);
  for (size_t n = 0; n < kNamedLattices.size(); ++n) {
    const NamedBasis<3>& core = kNamedLattices[n];
    const client::NamedBasis& row = client::kNamedLattices[n];
    EXPECT_EQ(static_cast<size_t>(row.lattice), n);
    EXPECT_EQ(row.name, core.name);
    EXPECT_EQ((Mat3d{row.basis.a, row.basis.b, row.basis.c}), core.basis) << core.name;
    EXPECT_EQ(v1::NamedLattice_Name(static_cast<v1::NamedLattice>(n + 1)),
              absl::StrCat("NAMED_LATTICE_", absl::AsciiStrToUpper(row.name)));
  }
}

TEST(NamedPlaneLattices, AreTheSameInCoreAndClientAndFollowTheProtocol) {
  ASSERT_EQ(client::kNamedPlaneLattices.size(), kNamedPlaneLattices.size());
  ASSERT_EQ(v1::NamedPlaneLattice_ARRAYSIZE, static_cast<int>(kNamedPlaneLattices.size()) + 1);
  for (size_t n = 0; n < kNamedPlaneLattices.size(); ++n) {
    const NamedBasis<2>& core = kNamedPlaneLattices[n];
    const client::NamedPlaneBasis& row = client::kNamedPlaneLattices[n];
    EXPECT_EQ(static_cast<size_t>(row.lattice), n);
    EXPECT_EQ(row.name, core.name);
    EXPECT_EQ(v1::NamedPlaneLattice_Name(static_cast<v1::NamedPlaneLattice>(n + 1)),
              absl::StrCat("NAMED_PLANE_LATTICE_", absl::AsciiStrToUpper(row.name)));
  }
}

}  // namespace
}  // namespace latvox
