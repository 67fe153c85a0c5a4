// Words of options with enumerations as values.
#ifndef LATVOX_CLIENT_TOOL_CLI_REQUEST_WORDS_H_
#define LATVOX_CLIENT_TOOL_CLI_REQUEST_WORDS_H_

#include <string>

#include "client/tool/cli/common_options.h"
#include "latvox/types.h"

namespace latvox::client {

// How the mesh goes to the server: as plain arrays, or as a Draco stream. See PrepareUpload.
enum class UploadForm { kAuto, kRaw, kDraco };

// The first name is the default.
const Names<NamedLattice>& LatticeNames();
const Names<Algorithm>& AlgorithmNames();
const Names<InteriorRule>& RuleNames();
const Names<LinkSide>& SideNames();
const Names<VoxelSet>& SetNames();         // sets that need no further option have their value here
const Names<Placement>& PlacementNames();  // the default depends on the set
const Names<UploadForm>& UploadNames();
const Names<BrickEncoding>& EncodingNames();

// Returns the word of --set that means the set.
std::string NameOfSet(const VoxelSet& set);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_REQUEST_WORDS_H_
