#include "client/tool/cli/request_words.h"

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

}  // namespace latvox::client
