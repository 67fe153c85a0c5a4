// Facts about images in space.
#ifndef LATVOX_CLIENT_TOOL_INSPECT_IMAGE_FACTS_H_
#define LATVOX_CLIENT_TOOL_INSPECT_IMAGE_FACTS_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/json/json.h"

namespace latvox::client {

// Each returns `type`, `shape` and `components` of an image that latvox writes; `basis`, the steps along i, j and k,
// and `corner`, the position of the first element; and `voxels`, as far as the elements tell: not of fractions and
// colors. Reads the whole file, for a .mhd also the .raw beside it. Errors: NOT_FOUND; INVALID_ARGUMENT: another form
// than that of latvox, damaged, cut short.
absl::StatusOr<Json> NrrdFacts(const std::string& path);
absl::StatusOr<Json> MetaImageFacts(const std::string& path);  // .mha, .mhd
absl::StatusOr<Json> NiftiFacts(const std::string& path);      // .nii, .nii.gz

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_INSPECT_IMAGE_FACTS_H_
