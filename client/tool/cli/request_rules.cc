#include "client/tool/cli/request_rules.h"

#include "client/tool/cli/common_options.h"

namespace latvox::client {

const OptionPairs& RequestExclusions() {
  static const auto* const kPairs = new OptionPairs{{"--resolution", "--voxel-size"},
                                                    {"--without-surface", "--separability"},
                                                    {"--without-surface", "--minimal"},
                                                    {"--without-surface", "--cover"},
                                                    {"--region", "--verify"},
                                                    {"--bounds", "--verify"},
                                                    {"--shard", "--verify"},
                                                    {"--band", "--separability"},
                                                    {"--band", "--minimal"},
                                                    {"--band", "--algorithm"},
                                                    {"--band", "--fill"},
                                                    {"--band", "--cover"},
                                                    {"--band", "--verify"},
                                                    {"--attributes", "--band"}};
  return *kPairs;
}

void CheckRequestRules(const VoxelizeWords& words, const VoxelizeRequest& request) {
  const bool is_exact = request.algorithm == Algorithm::kExact, is_solid = request.solid.has_value();
  if (request.cover == Cover::kSupercover && request.minimal) {
    Refuse("--minimal excludes --cover supercover, which is not thinned");
  }
  if (request.cover == Cover::kSupercover && !is_exact)
    Refuse("--cover supercover excludes --algorithm ", words.algorithm);
  if (words.minimal == true && !is_exact) {
    Refuse("--minimal excludes --algorithm ", words.algorithm, ", which is not thinned");
  }
  if (is_solid && request.verify) Refuse("--verify: is for --fill surface");
  if (is_solid && !is_exact) Refuse("--fill: solid is for --algorithm exact");
  if (words.attributes.empty()) return;
  if (is_solid) Refuse("--attributes excludes --fill solid, whose inside no triangle is near to");
  if (!is_exact) Refuse("--attributes excludes --algorithm ", words.algorithm);
}

}  // namespace latvox::client
