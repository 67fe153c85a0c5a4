// Files of pixels.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PIXEL_OUTPUT_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PIXEL_OUTPUT_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tool/curve/curve_file.h"
#include "latvox/plane_types.h"

namespace latvox::client {

// Returns the extensions that EncodePixels supports, with the dot.
const std::vector<std::string>& PixelExtensions();

// Returns the bytes of a file for the extension of the path:
//   .csv   header i,j,x,y; lattice coordinates, world position with 17 significant digits; in lexicographic order
//   .png   picture, see client/tool/output/pixel_picture.h
// Errors: INVALID_ARGUMENT (extension), INTERNAL (libpng).
absl::StatusOr<std::string> EncodePixels(const std::string& path, const Drawing& drawing,
                                         const Pixelization& pixelization);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PIXEL_OUTPUT_H_
