#include "client/tool/cli/request_words.h"

#include <algorithm>
#include <variant>

namespace latvox::client {

const Names<NamedLattice>& LatticeNames() {
  static const auto* const kNames = new Names<NamedLattice>(NamesOfLattices(kNamedLattices));
  return *kNames;
}

const Names<Algorithm>& AlgorithmNames() {
  static const auto* const kNames = new Names<Algorithm>{{"exact", Algorithm::kExact},
                                                         {"brute-force", Algorithm::kBruteForce},
                                                         {"incremental", Algorithm::kIncremental},
                                                         {"optimized-incremental", Algorithm::kOptimizedIncremental}};
  return *kNames;
}

const Names<InteriorRule>& RuleNames() {
  static const auto* const kNames = new Names<InteriorRule>{{"auto", InteriorRule::kAuto},
                                                            {"parity", InteriorRule::kParity},
                                                            {"winding", InteriorRule::kWinding},
                                                            {"positive", InteriorRule::kPositive}};
  return *kNames;
}

const Names<LinkSide>& SideNames() {
  static const auto* const kNames =
      new Names<LinkSide>{{"both", LinkSide::kBoth}, {"inside", LinkSide::kInside}, {"outside", LinkSide::kOutside}};
  return *kNames;
}

const Names<VoxelSet>& SetNames() {
  static const auto* const kNames =
      new Names<VoxelSet>{{"surface", Surface{}},
                          {"supercover", Supercover{}},
                          {"solid", Solid{}},
                          {"supercover-solid", Solid{.surface = SolidSurface::kSupercover}},
                          {"interior", Solid{.surface = SolidSurface::kNone}},
                          {"band", Band{}},
                          {"links", Links{}},
                          {"enclosed", Enclosed{}},
                          {"enclosed-interior", Enclosed{.surface = SolidSurface::kNone}},
                          {"region", Connected{}}};
  return *kNames;
}

const Names<Placement>& PlacementNames() {
  static const auto* const kNames = new Names<Placement>{{"points", Placement::kPoints}, {"cells", Placement::kCells}};
  return *kNames;
}

const Names<UploadForm>& UploadNames() {
  static const auto* const kNames =
      new Names<UploadForm>{{"auto", UploadForm::kAuto}, {"raw", UploadForm::kRaw}, {"draco", UploadForm::kDraco}};
  return *kNames;
}

const Names<BrickEncoding>& EncodingNames() {
  static const auto* const kNames = new Names<BrickEncoding>{{"packed", BrickEncoding::kPacked},
                                                             {"packed-zstd", BrickEncoding::kPackedZstd},
                                                             {"masks", BrickEncoding::kMasks}};
  return *kNames;
}

std::string NameOfSet(const VoxelSet& set) {
  const auto surface_of = [](const VoxelSet& one) {
    if (const auto* const solid = std::get_if<Solid>(&one)) return solid->surface;
    const auto* const enclosed = std::get_if<Enclosed>(&one);
    return enclosed != nullptr ? enclosed->surface : SolidSurface::kSeparating;
  };
  const auto is_it = [&](const auto& known) {
    return known.second.index() == set.index() && surface_of(known.second) == surface_of(set);
  };
  return std::find_if(SetNames().begin(), SetNames().end(), is_it)->first;
}

}  // namespace latvox::client
